// SPDX-License-Identifier: BSD-3-Clause
// Convex bodies that touch edge to edge.
#include <cmath>

#include "base/vectors.h"
#include "bvh/collision_mesh.h"
#include "collide/stages.h"
#include "scenes/generated_meshes.h"
#include "support/catch.h"
#include "support/make_query.h"

using namespace otg;
using otg::test::makeQuery;

namespace {

/// With its edge down, along x.
scenes::MeshArrays wedge(float half) {
  scenes::MeshArrays mesh;
  for (const float x : {-half, half}) {
    mesh.vertices.push_back({x, 0, 0});
    mesh.vertices.push_back({x, -0.25f, 1});
    mesh.vertices.push_back({x, 0.25f, 1});
  }
  mesh.triangles = {{{0, 1, 2}}, {{3, 5, 4}}, {{0, 4, 1}}, {{0, 3, 4}},
                    {{0, 5, 3}}, {{0, 2, 5}}, {{1, 5, 2}}, {{1, 4, 5}}};
  return mesh;
}

}  // namespace

TEST_CASE("Edges that cross at a tiny angle touch at the ends of the stretch that they share") {
  // Two wedges, edge over edge. One is shorter and lies along the other's middle.
  const CollisionMesh upper(scenes::build(wedge(0.5f)), BuildStrategy::kSah);
  const CollisionMesh lower(scenes::build(wedge(0.25f)), BuildStrategy::kSah);
  constexpr double kAngle = 5e-4, kDeep = 2e-5;
  for (const double sign : {-1.0, 1.0}) {
    // The lower one is upside down, its own inverse but for the place.
    const double c = std::cos(kAngle), s = sign * std::sin(kAngle);
    const Transformd pose{{c, s, 0, s, -c, 0, 0, 0, -1}, {0.1, 0, kDeep}};
    Transformd back = pose;
    back.t = otgScale(otgRotateBack(pose, pose.t), -1.0);
    for (const bool swap : {false, true}) {
      Query query = swap ? makeQuery(lower, upper, back) : makeQuery(upper, lower, pose);
      query.options.contacts = ContactModel::kSolid;
      query.options.solid.convexPath = true;
      Workspace workspace;
      collide(query, workspace);
      const std::vector<Contact>& contacts = workspace.reduced;
      REQUIRE(contacts.size() == 2);
      CHECK(contacts[0].depth == Approx(kDeep).epsilon(1e-6));
      CHECK(contacts[1].depth == Approx(kDeep).epsilon(1e-6));
      CHECK(norm(contacts[0].position - contacts[1].position) == Approx(0.5).epsilon(1e-3));
    }
  }
}
