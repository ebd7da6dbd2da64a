// SPDX-License-Identifier: BSD-3-Clause
// Convex shapes on smooth surfaces: whether their contacts take them out and no farther, against exact intersection of
// triangles; and where the method declines.
#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <string>
#include <vector>

#include "base/vectors.h"
#include "collide/shortest_translation.h"
#include "collide/solid/look_ahead.h"
#include "collide/stages.h"
#include "collide/surface/smooth_contacts.h"
#include "primitives/convex_shape.h"
#include "queries/closest_point.h"
#include "scenes/concave_meshes.h"
#include "scenes/generated_meshes.h"
#include "shared/contacts/solid_model.h"
#include "support/catch.h"
#include "support/draw.h"
#include "support/hills.h"
#include "support/make_query.h"

using namespace otg;
using namespace otg::test;

namespace {

struct Ground {
  std::string name;
  scenes::MeshArrays mesh;
};

std::vector<Ground> grounds() {
  return {{"hills", hills(24, 0.3)},
          {"flat hills", hills(16, 0.05)},
          {"lump", scenes::makeLump(2, 4, 0.2, 7)},
          {"ball", scenes::makeSphere(2, 3)},
          {"torus", scenes::makeTorus(2, 0.8, 48, 24)}};
}

/// A shape, and a mesh for the judge: of a cylinder one with many sides in it.
struct Mover {
  std::shared_ptr<const ConvexShape> shape;
  std::shared_ptr<const CollisionMesh> judged;
};

std::shared_ptr<const CollisionMesh> manySided(double radius, double half) {
  std::vector<Vec3d> points;
  for (int k = 0; k < 200; ++k) {
    const double angle = 2 * M_PI * k / 200;
    for (const double z : {-half, half}) points.push_back({radius * std::cos(angle), radius * std::sin(angle), z});
  }
  return polyhedronShape(points)->mesh;
}

std::vector<Mover> movers(Draw& draw) {
  std::vector<Mover> all;
  const auto flat = [&](const std::shared_ptr<const ConvexShape>& shape) { all.push_back({shape, shape->mesh}); };
  flat(boxShape({0.25, 0.25, 0.25}));
  flat(boxShape({0.5, 0.25, 0.0625}));
  flat(boxShape({0.5, 0.5, 0.002}));
  for (const int count : {4, 24}) {
    std::vector<Vec3d> points;
    for (int k = 0; k < count; ++k) points.push_back(draw.direction() * 0.3);
    flat(polyhedronShape(points));
  }
  for (const auto& [radius, half] : {std::pair{0.25, 0.25}, {0.4, 0.05}, {0.1, 0.4}, {0.5, 0.01}}) {
    all.push_back({cylinderShape(radius, half), manySided(radius, half)});
  }
  return all;
}

Query queryOf(const CollisionMesh& mesh, const CollisionMesh& other, const Transformd& pose) {
  Query query = makeQuery(mesh, other, pose);
  query.options.contacts = ContactModel::kSolid;
  query.options.solid.convexPath = true;
  return query;
}

bool areMeeting(const CollisionMesh& mesh, const Mover& mover, Transformd pose, const Vec3d& move) {
  static Workspace workspace;
  pose.t = pose.t + move;
  findIntersectingPairs(queryOf(mesh, *mover.judged, pose), workspace);
  return !workspace.intersecting.empty();
}

/// Above a random triangle, overlapped by up to 30 % of its radius along the triangle's normal.
Transformd drawPose(Draw& draw, const CollisionMesh& mesh, const Mover& mover) {
  const TriMesh& triangles = mesh.mesh();
  for (;;) {
    const std::uint32_t t = draw.below(static_cast<std::uint32_t>(triangles.triangleCount()));
    const Vec3f& corner = triangles.vertices()[triangles.triangles()[t].v[0]];
    const Vec3d normal = mesh.adjacency().normal[t], on{corner.x, corner.y, corner.z};
    if (std::max({std::fabs(on.x), std::fabs(on.y)}) > 3.2) continue;  // by a sheet's rim
    const Vec3d axis = draw.direction();
    const double angle = draw.below(2) == 0 ? draw.uniform(-3, 3) : draw.uniform(-0.1, 0.1);
    Transformd pose = makePose(axis, angle, on);
    const double radius = norm({mover.shape->mesh->mesh().boundsMax().x, mover.shape->mesh->mesh().boundsMax().y,
                                mover.shape->mesh->mesh().boundsMax().z});
    double in = 0, out = 2.5 * radius;
    if (areMeeting(mesh, mover, pose, normal * out) || !areMeeting(mesh, mover, pose, {0, 0, 0})) continue;
    for (int i = 0; i < 30; ++i) {
      const double middle = 0.5 * (in + out);
      (areMeeting(mesh, mover, pose, normal * middle) ? in : out) = middle;
    }
    pose.t = pose.t + normal * (in - radius * std::pow(10.0, draw.uniform(-4, -0.5)));
    return pose;
  }
}

bool collideSmooth(const Query& query, const ConvexShape& shape, Workspace& workspace) {
  NearSurface near(query, shape, isCornered(query.a), std::numeric_limits<double>::infinity());
  workspace.clear();
  return near.collect() && addSmoothContacts(near, workspace) == SurfaceAnswer::kTouching;
}

}  // namespace

TEST_CASE("contacts on smooth surfaces take a shape out and no farther") {
  Draw draw(11);
  Workspace workspace;
  int all = 0, found = 0, alone = 0;
  for (const Ground& ground : grounds()) {
    const auto mesh = meshOf(ground.mesh);
    for (const Mover& mover : movers(draw)) {
      const bool isRound = mover.shape->isCurved();
      for (int i = 0; i < 40; ++i) {
        const Transformd pose = drawPose(draw, *mesh, mover);
        ++all;
        if (!collideSmooth(queryOf(*mesh, *mover.shape->mesh, pose), *mover.shape, workspace)) continue;
        ++found;
        INFO(ground.name << ", shape " << static_cast<int>(mover.shape->kind) << ", member " << i);
        REQUIRE_FALSE(workspace.contacts.empty());
        ShortestTranslation way;
        double deepest = 0;
        std::uint32_t regions = 0;
        for (const Contact& c : workspace.contacts) {
          REQUIRE(way.add(c.normal * -1.0, c.depth));
          deepest = std::max(deepest, c.depth);
          regions = std::max(regions, c.region + 1);
          // One end is on the mesh, the other on the shape. A place that is as deep to a step stands for the deepest.
          const Vec3d half = c.normal * (0.5 * c.depth);
          const double slack = 1e-6 + OTG_SOLID_RANK_STEP * c.depth;
          CHECK(closestPoint(*mesh, c.position - half).distance < slack);
          const Vec3d local = otgRotateBack(pose, c.position + half - pose.t);
          CHECK(mover.shape->isNearSegment(local, local, slack));
          CHECK_FALSE(mover.shape->isNearSegment(local, local, -slack));
        }
        const double rounding = 3e-7;  // of meshes
        CHECK_FALSE(areMeeting(*mesh, mover, pose, way.value() * (1 + 1e-5 + rounding / norm(way.value()))));
        if (regions > 1) continue;
        ++alone;
        const double less = (isRound ? 0.03 : 1e-3) * deepest + (isRound ? 1e-4 : 1e-7);
        if (less < deepest) CHECK(areMeeting(*mesh, mover, pose, way.value() * (1 - less / deepest)));
      }
    }
  }
  CHECK(found > 0.7 * all);
  CHECK(alone > 0.5 * all);
}

TEST_CASE("rims, sharp edges, thin walls and walls ahead are left to the stages for any solids") {
  Workspace workspace;
  const auto box = boxShape({0.25, 0.25, 0.25});
  const auto asks = [&](const CollisionMesh& mesh, const Vec3d& at) {
    return collideSmooth(queryOf(mesh, *box->mesh, makeMove(at)), *box, workspace);
  };
  const auto ridge = [](double height) {  // of the middle
    return meshOf(scenes::makeProfile({{-2, -1}, {2, -1}, {2, 0}, {0, height}, {-2, 0}}, 4));
  };
  CHECK(asks(*ridge(0.5), {0, 0, 0.745}));
  CHECK_FALSE(asks(*ridge(0.5), {0, 0, 0.8}));      // apart
  CHECK_FALSE(asks(*ridge(0.5), {0, 0, 0.4}));      // the middle is below
  CHECK_FALSE(asks(*ridge(0.5), {0, 1.9, 0.745}));  // over the end
  CHECK_FALSE(asks(*ridge(3), {0, 0, 3.2}));        // too steep
  const auto sheet = meshOf(hills(16, 0.05));
  CHECK(asks(*sheet, {0.1, 0.1, 0.29}));
  CHECK_FALSE(asks(*sheet, {4, 0.1, 0.27}));  // over the rim
  // The way out of the slope leads into the wall, which leans over it.
  const std::vector<scenes::ProfilePoint> leaning{{0, 0}, {4, 0}, {4, 0.2}, {2.5, 0.5}, {1, 0.5}, {1.5, 1.5}, {0, 1.5}};
  const auto wedge = meshOf(scenes::makeProfile(leaning, 4));
  CHECK(asks(*wedge, {2.5, 0, 0.745}));
  CHECK_FALSE(asks(*wedge, {1.5 - 0.0005, 0, 0.745}));
}

TEST_CASE("a shape on a smooth surface has the same contacts whatever the tree and the numbers of triangles") {
  Draw draw(3);
  Workspace workspace, other;
  const scenes::MeshArrays arrays = hills(24, 0.3);
  scenes::MeshArrays turned = arrays;
  std::reverse(turned.triangles.begin(), turned.triangles.end());
  const auto mesh = meshOf(arrays), again = meshOf(turned);
  const CollisionMesh wide(scenes::build(arrays), BuildStrategy::kMeanSplit);
  int found = 0;
  for (const Mover& mover : movers(draw)) {
    for (int i = 0; i < 40; ++i) {
      const Transformd pose = drawPose(draw, *mesh, mover);
      if (!collideSmooth(queryOf(*mesh, *mover.shape->mesh, pose), *mover.shape, workspace)) continue;
      ++found;
      for (const CollisionMesh* const one : {again.get(), &wide}) {
        REQUIRE(collideSmooth(queryOf(*one, *mover.shape->mesh, pose), *mover.shape, other));
        REQUIRE(other.contacts.size() == workspace.contacts.size());
        for (const Contact& c : workspace.contacts) {
          const bool isThere = std::any_of(other.contacts.begin(), other.contacts.end(), [&](const Contact& x) {
            return norm(x.position - c.position) < 1e-9 && std::fabs(x.depth - c.depth) < 1e-12;
          });
          CHECK(isThere);
        }
      }
    }
  }
  CHECK(found > 150);
}
