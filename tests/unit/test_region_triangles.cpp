// SPDX-License-Identifier: BSD-3-Clause
// The triangles of a region, and what a pair of solids keeps of a deep one.
#include <cmath>

#include "base/vectors.h"
#include "bvh/collision_mesh.h"
#include "collide/pair_history.h"
#include "collide/solid/region_triangles.h"
#include "collide/stages.h"
#include "scenes/generated_meshes.h"
#include "support/catch.h"
#include "support/draw.h"
#include "support/make_query.h"

using namespace otg;
using otg::test::makePose;
using otg::test::makeQuery;

namespace {

constexpr Transformd kSame{{1, 0, 0, 0, 1, 0, 0, 0, 1}, {0, 0, 0}};

/// One region of all triangles of both meshes.
OverlapRegions wholeMeshes(const PlacedMeshes& meshes) {
  OverlapRegions all{};
  for (int m = 0; m < 2; ++m) {
    for (std::uint32_t t = 0; t < meshes.mesh(m).triangleCount(); ++t) {
      Piece piece{};
      piece.mesh = static_cast<std::uint8_t>(m);
      piece.triangle = t;
      piece.normal = meshes.normal(m, t);
      piece.offset = otgDot(piece.normal, meshes.vertex(m, meshes.mesh(m).triangles()[t].v[0]));
      all.pieces.push_back(piece);
    }
  }
  Region region{};
  region.pieceEnd = static_cast<std::uint32_t>(all.pieces.size());
  region.diagonal = 4;
  all.regions.push_back(region);
  return all;
}

}  // namespace

TEST_CASE("faces of one mesh are curved by their neighbours in that mesh alone") {
  // The ball's facets are turned a little against the faces of the box.
  const CollisionMesh ball(scenes::build(scenes::makeSphere(1, 3)), BuildStrategy::kSah);
  const CollisionMesh box(scenes::build(scenes::makeBox({2, 2, 2})), BuildStrategy::kSah);
  for (const bool ballFirst : {true, false}) {
    const Query query = ballFirst ? makeQuery(ball, box, kSame) : makeQuery(box, ball, kSame);
    const PlacedMeshes meshes(query);
    const OverlapRegions all = wholeMeshes(meshes);
    RegionTriangles triangles(all.memory);
    triangles.collect(meshes, all, all.regions[0]);
    std::size_t seen = 0;
    for (const Vec3d& d : {Vec3d{1, 0, 0}, Vec3d{0, -1, 0}, Vec3d{0, 0, 1}}) {
      const Vec3d inside = unit(d + Vec3d{0.1, 0.07, 0.04}) * 0.9;
      const int ofBox = ballFirst ? 1 : 0, ofBall = 1 - ofBox;
      for (const auto& exit : triangles.exitsOf(ofBox, inside)) {
        CHECK_FALSE(triangles.isCurved(ofBox, exit.face));
        CHECK(exit.normal == d);
        ++seen;
      }
      for (const auto& exit : triangles.exitsOf(ofBall, inside)) {
        CHECK(triangles.isCurved(ofBall, exit.face));
        ++seen;
      }
    }
    CHECK(seen == 6);
  }
}

TEST_CASE("a pair remembers the direction of a deep region, and of no other") {
  const CollisionMesh ball(scenes::build(scenes::makeSphere(1, 3)), BuildStrategy::kSah);
  for (const auto& [height, isDeep] : {std::pair{1.9, false}, {0.5, true}, {1.95, false}}) {
    SolidHistory history;
    Query query = makeQuery(ball, ball, {{1, 0, 0, 0, 1, 0, 0, 0, 1}, {0.03, 0.02, height}});
    query.options.contacts = ContactModel::kSolid;
    query.history = &history;
    Workspace workspace;
    collide(query, workspace);
    INFO("height " << height);
    REQUIRE_FALSE(workspace.reduced.empty());
    CHECK(norm(history.current.deepNormal) == Approx(isDeep ? 1 : 0).margin(1e-12));
  }
}

TEST_CASE("motion is measured at the smaller mesh, whichever is first") {
  const CollisionMesh small(scenes::build(scenes::makeBox({0.2, 0.1, 0.1})), BuildStrategy::kSah);
  const CollisionMesh large(scenes::build(scenes::makeBox({4, 4, 1})), BuildStrategy::kSah);
  const Vec3d place{1.8, 0.3, 0.6}, step{0.01, -0.02, 0.03};
  const Transformd before = makePose({0, 0, 1}, 0.2, place);
  Transformd after = makePose({0, 0.6, 0.8}, 0.4, place);
  CHECK(norm(motionSince(makeQuery(large, small, after), before)) < 1e-12);
  after.t = place + step;
  CHECK(norm(motionSince(makeQuery(large, small, after), before) + step) < 1e-12);
  // The small one turns in its place: in its frame the middle of the large one moves.
  after.t = otgRotate(after, otgRotateBack(before, place));
  CHECK(norm(after.t - place) > 0.1);
  CHECK(norm(motionSince(makeQuery(small, large, after), before)) < 1e-12);
  after.t = after.t - otgRotate(after, step);
  CHECK(norm(motionSince(makeQuery(small, large, after), before) - otgRotate(after, step)) < 1e-12);
}
