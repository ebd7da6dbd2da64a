// SPDX-License-Identifier: BSD-3-Clause
// Every instruction set gives the same candidates in the same order, and the same survivors of the plane test.
#include <cmath>
#include <set>

#include "collide/wide_kernels.h"
#include "scenes/generated_meshes.h"
#include "support/catch.h"

using namespace otg;

namespace {

Transformd pose(double angle, Vec3d t) {
  const double c = std::cos(angle), s = std::sin(angle);
  return {{c, -s, 0, s * 0.6, c * 0.6, -0.8, s * 0.8, c * 0.8, 0.6}, t};
}

std::vector<SimdLevel> levels() {
  std::vector<SimdLevel> out{SimdLevel::kBaseline};
  if (bestSimdLevel() >= SimdLevel::kAvx2) out.push_back(SimdLevel::kAvx2);
  if (bestSimdLevel() >= SimdLevel::kAvx512) out.push_back(SimdLevel::kAvx512);
  return out;
}

}  // namespace

TEST_CASE("instruction sets agree bit for bit") {
  const CollisionMesh torus(scenes::build(scenes::makeTorus(1.0, 0.4, 61, 29)), BuildStrategy::kSah);
  const CollisionMesh lump(scenes::build(scenes::makeLump(0.9, 4, 0.2, 7)), BuildStrategy::kSah);
  const CollisionMesh one(scenes::build(scenes::makeTetrahedron({0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1})),
                          BuildStrategy::kSah);
  std::size_t candidates = 0;
  for (const CollisionMesh* a : {&torus, &lump, &one}) {
    for (const CollisionMesh* b : {&torus, &lump, &one}) {
      for (int i = 0; i < 8; ++i) {
        for (const int axes : {6, 15}) {
          Query query;
          query.a = a;
          query.b = b;
          query.bInA = pose(0.7 * i, {0.3 * i - 0.5, 0.2, 0.1 * i});
          query.options.middle.axes = axes;
          const PairFrame frame = makePairFrame(query);
          std::vector<TrianglePair> expected, kept;
          for (const SimdLevel level : levels()) {
            CollideStats stats;
            std::vector<TrianglePair> found, crossing;
            traverseWide(level, query, frame, found, stats);
            filterByPlanes(level, query, frame, found, crossing);
            if (level == SimdLevel::kBaseline) {
              expected = found;
              kept = crossing;
            }
            REQUIRE(found == expected);
            REQUIRE(crossing == kept);
          }
          candidates += expected.size();
          // The standard traversal finds the same candidates.
          Workspace workspace;
          query.options.middle.traversal = Traversal::kStandard;
          middlePhase(query, workspace);
          REQUIRE(std::set(workspace.candidates.begin(), workspace.candidates.end()) ==
                  std::set(expected.begin(), expected.end()));
        }
      }
    }
  }
  CHECK(candidates > 10000);
}
