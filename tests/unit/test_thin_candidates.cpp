// SPDX-License-Identifier: BSD-3-Clause
// Meshes with thin triangles, such as the fans at the ends of a disc: pairs are left out whose boxes overlap, and never
// one that meets.
#include <algorithm>
#include <cmath>
#include <vector>

#include "base/vectors.h"
#include "collide/query.h"
#include "collide/simd/wide_kernels.h"
#include "scenes/generated_meshes.h"
#include "support/catch.h"
#include "support/draw.h"
#include "support/make_query.h"
#include "support/mesh_samples.h"

using namespace otg;
using namespace otg::test;

namespace {

/// Needles all over a ball, each thousands of times as long as it is wide.
scenes::MeshArrays makeNeedles(int count, std::uint32_t seed) {
  Draw draw(seed);
  scenes::MeshArrays mesh;
  for (int i = 0; i < count; ++i) {
    const Vec3d from = draw.direction(), to = draw.direction(), aside = from + draw.direction() * 1e-4;
    const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
    for (const Vec3d& p : {from, to, aside}) {
      mesh.vertices.push_back({static_cast<float>(p.x), static_cast<float>(p.y), static_cast<float>(p.z)});
    }
    mesh.triangles.push_back({{first, first + 1, first + 2}});
  }
  return mesh;
}

/// A disc about z, whose ends are fans of long triangles from one of its corners; and a block beside it, so that it is
/// no convex body.
scenes::MeshArrays makeDisc(std::uint32_t sides, double width) {
  scenes::MeshArrays disc;
  for (std::uint32_t i = 0; i < 2 * sides; ++i) {
    const double angle = 2 * 3.14159265358979 * (i % sides) / sides;
    disc.vertices.push_back({static_cast<float>(std::cos(angle)), static_cast<float>(std::sin(angle)),
                             static_cast<float>(i < sides ? 0.5 * width : -0.5 * width)});
  }
  for (std::uint32_t i = 0; i < sides; ++i) {
    const std::uint32_t next = (i + 1) % sides;
    disc.triangles.push_back({{i, sides + i, next}});
    disc.triangles.push_back({{next, sides + i, sides + next}});
    if (i == 0 || next == 0) continue;
    disc.triangles.push_back({{0, i, next}});
    disc.triangles.push_back({{sides, sides + next, sides + i}});
  }
  return scenes::merge({disc, scenes::transformed(scenes::makeBox({0.3, 0.3, 0.3}), makeMove({1.4, 0, 0}))});
}

scenes::MeshArrays scaled(scenes::MeshArrays mesh, double by, const Vec3d& off) {
  for (Vec3f& v : mesh.vertices) {
    v = {static_cast<float>(v.x * by + off.x), static_cast<float>(v.y * by + off.y),
         static_cast<float>(v.z * by + off.z)};
  }
  return mesh;
}

std::vector<TrianglePair> meeting(Query query, Traversal traversal, std::size_t* candidates = nullptr) {
  Workspace workspace;
  query.options.middle.traversal = traversal;
  findIntersectingPairs(query, workspace);
  if (candidates != nullptr) *candidates = workspace.candidates.size();
  return workspace.intersecting;
}

}  // namespace

TEST_CASE("no pair that meets is left out with thin triangles") {
  Draw draw(3);
  std::size_t pairs = 0, all = 0, left = 0;
  for (int round = 0; round < 24; ++round) {
    const double size = std::pow(10.0, draw.uniform(-4, 4));
    const Vec3d off = draw.inBox(round % 3 == 0 ? 300 * size : size);
    const auto meshOf = [&](const scenes::MeshArrays& arrays) {
      return CollisionMesh(scenes::build(scaled(arrays, size, off)), BuildStrategy::kSah);
    };
    const CollisionMesh needles = meshOf(makeNeedles(60, static_cast<std::uint32_t>(round)));
    const CollisionMesh disc = meshOf(makeDisc(200, 0.3)), ball = meshOf(scenes::makeSphere(0.8, 4));
    REQUIRE(needles.hasThinTriangles());
    REQUIRE_FALSE(ball.hasThinTriangles());
    const CollisionMesh* const meshes[] = {&needles, &disc, &ball};
    for (const CollisionMesh* a : meshes) {
      for (const CollisionMesh* b : meshes) {
        for (int i = 0; i < 6; ++i) {
          const Vec3d turn = draw.direction(), toward = draw.direction();
          const double angle = draw.uniform(-3, 3), far = size * draw.uniform(0, 1.8);
          Transformd pose = makePose(turn, angle, {0, 0, 0});
          pose.t = off - otgRotate(pose, off) + toward * far;
          const Query query = makeQuery(*a, *b, pose);
          std::size_t withBoxes = 0, found = 0;
          const std::vector<TrianglePair> expected = meeting(query, Traversal::kStandard, &withBoxes);
          REQUIRE(meeting(query, Traversal::kWide, &found) == expected);
          REQUIRE(found <= withBoxes);
          if (leavesOutThin(query)) left += withBoxes - found;
          all += withBoxes;
          pairs += expected.size();
        }
      }
    }
  }
  CHECK(pairs > 100000);
  CHECK(3 * left > all);
}

TEST_CASE("a fine mesh beside the end of a disc has few pairs to decide") {
  const CollisionMesh disc(scenes::build(makeDisc(200, 0.3)), BuildStrategy::kSah);
  const CollisionMesh ball(scenes::build(scenes::makeSphere(0.5, 6)), BuildStrategy::kSah);
  REQUIRE(disc.hasThinTriangles());
  for (const bool isFirst : {true, false}) {
    // Beside the rim, across the plane of an end.
    const Transformd pose = makeMove({isFirst ? 1.0 : -1.0, isFirst ? 1.0 : -1.0, 0});
    const Query query = isFirst ? makeQuery(disc, ball, pose) : makeQuery(ball, disc, pose);
    std::size_t withBoxes = 0, found = 0;
    CHECK(meeting(query, Traversal::kStandard, &withBoxes) == meeting(query, Traversal::kWide, &found));
    INFO(withBoxes << " and " << found);
    CHECK(withBoxes > 1000);
    CHECK(8 * found < withBoxes);
  }
}

TEST_CASE("instruction sets leave the same pairs out") {
  Draw draw(8);
  const CollisionMesh disc(scenes::build(makeDisc(200, 0.3)), BuildStrategy::kSah);
  const CollisionMesh ball(scenes::build(scenes::makeSphere(0.8, 4)), BuildStrategy::kSah);
  for (int i = 0; i < 50; ++i) {
    const Vec3d turn = draw.direction(), way = draw.direction();
    const double angle = draw.uniform(-3, 3), far = draw.uniform(0.2, 1.6);
    const Query query = makeQuery(disc, ball, makePose(turn, angle, way * far));
    const PairFrame frame = makePairFrame(query);
    std::vector<TrianglePair> expected, found;
    CollideStats stats;
    traverseWide(SimdLevel::kBaseline, query, frame, expected, stats);
    for (const SimdLevel level : {SimdLevel::kAvx2, SimdLevel::kAvx512}) {
      if (level > bestSimdLevel()) continue;
      traverseWide(level, query, frame, found, stats);
      CHECK(found == expected);
    }
  }
}

TEST_CASE("thin triangles that are not touched yet are met ahead") {
  // A block that leans over the end of a disc, all of it turned so that boxes are thick; a ball under the block.
  Draw draw(4);
  const Transformd turn = makePose(unit({1, 2, 3}), 1, {0, 0, 0});
  const scenes::MeshArrays block =
      scenes::transformed(scenes::makeBox({0.4, 0.4, 1}), makePose({0, 1, 0}, -0.5, {0.5, 0, 0.9}));
  const CollisionMesh ground(scenes::build(scenes::transformed(scenes::merge({makeDisc(200, 0.3), block}), turn)),
                             BuildStrategy::kSah);
  const CollisionMesh ball(scenes::build(scenes::makeSphere(0.2, 4)), BuildStrategy::kSah);
  REQUIRE(ground.hasThinTriangles());
  Workspace thin, boxes;
  std::uint64_t ahead = 0;
  for (int i = 0; i < 80; ++i) {
    const double x = draw.uniform(-0.4, 1.0), y = draw.uniform(-0.1, 0.1), gap = draw.uniform(0, 0.01);
    Query query = makeQuery(ground, ball, turn);
    query.bInA.t = otgRotate(turn, Vec3d{x, y, 0.15 + 0.2 + gap});
    query.options.contacts = ContactModel::kSolid;
    collide(query, thin);
    query.options.middle.traversal = Traversal::kStandard;
    collide(query, boxes);
    ahead += boxes.stats.contactsAhead;
    CHECK(thin.stats.contactsAhead == boxes.stats.contactsAhead);
    CHECK(thin.reduced.size() == boxes.reduced.size());
  }
  INFO(ahead);
  CHECK(ahead > 10);
}

TEST_CASE("surfaces ahead of thin triangles are found as those of others") {
  Draw draw(21);
  const CollisionMesh disc(scenes::build(makeDisc(150, 0.4)), BuildStrategy::kSah);
  REQUIRE(disc.hasThinTriangles());
  Workspace thin, boxes;
  std::uint64_t ahead = 0;
  for (int i = 0; i < 300; ++i) {
    const Vec3d turn = draw.direction(), way = draw.direction();
    const double angle = draw.uniform(-3, 3), far = draw.uniform(0.5, 1.9);
    Query query = makeQuery(disc, disc, makePose(turn, angle, way * far));
    query.options.contacts = ContactModel::kSolid;
    collide(query, thin);
    query.options.middle.traversal = Traversal::kStandard;
    collide(query, boxes);
    ahead += boxes.stats.contactsAhead;
    REQUIRE(thin.reduced.size() == boxes.reduced.size());
    for (std::size_t k = 0; k < thin.reduced.size(); ++k) {
      CHECK(thin.reduced[k].position == boxes.reduced[k].position);
      CHECK(thin.reduced[k].normal == boxes.reduced[k].normal);
      CHECK(thin.reduced[k].depth == boxes.reduced[k].depth);
    }
  }
  CHECK(ahead > 0);
}
