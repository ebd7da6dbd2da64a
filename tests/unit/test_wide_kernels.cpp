// SPDX-License-Identifier: BSD-3-Clause
// Every instruction set gives the same candidates in the same order, and of each what the scalar filter says.
#include <cmath>
#include <set>

#include "collide/simd/wide_kernels.h"
#include "scenes/generated_meshes.h"
#include "shared/tests/triangle_test.h"
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

void centredCorners(const TriMesh& mesh, std::uint32_t triangle, Vec3f* out) {
  for (int k = 0; k < 3; ++k) out[k] = otgSub(mesh.vertices()[mesh.triangles()[triangle].v[k]], mesh.center());
}

int filter(const Query& query, const PairFrame& frame, const TrianglePair& pair) {
  Vec3f a[3], b[3];
  centredCorners(query.a->mesh(), pair.a, a);
  centredCorners(query.b->mesh(), pair.b, b);
  for (Vec3f& p : b) p = otgTransform(frame.trianglesInA, p);
  return otgTrianglesFilter(frame.floatError, a, b);
}

}  // namespace

TEST_CASE("instruction sets agree bit for bit") {
  const CollisionMesh torus(scenes::build(scenes::makeTorus(1.0, 0.4, 61, 29)), BuildStrategy::kSah);
  const CollisionMesh lump(scenes::build(scenes::makeLump(0.9, 4, 0.2, 7)), BuildStrategy::kSah);
  const CollisionMesh one(scenes::build(scenes::makeTetrahedron({0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1})),
                          BuildStrategy::kSah);
  const CollisionMesh box(scenes::build(scenes::makeBox({1, 1, 1}, 5)), BuildStrategy::kSah);
  std::size_t candidates = 0, certain = 0, unsure = 0;
  for (const CollisionMesh* a : {&torus, &lump, &one, &box}) {
    for (const CollisionMesh* b : {&torus, &lump, &one, &box}) {
      for (int i = 0; i < 8; ++i) {
        for (const int axes : {6, 15}) {
          Query query;
          query.a = a;
          query.b = b;
          query.bInA = pose(0.7 * i, {0.3 * i - 0.5, 0.2, 0.1 * i});
          // Faces in one plane, edges that meet: nothing that float could be sure of.
          if (i == 7) query.bInA = {{1, 0, 0, 0, 1, 0, 0, 0, 1}, {0.4, 0.2, 0}};
          query.options.middle.axes = axes;
          const PairFrame frame = makePairFrame(query);
          std::vector<TrianglePair> expected, intersecting, undecided;
          for (const SimdLevel level : levels()) {
            CollideStats stats;
            std::vector<TrianglePair> found, sure, open;
            traverseWide(level, query, frame, found, stats);
            filterTriangles(level, query, frame, found, sure, open);
            if (level == SimdLevel::kBaseline) {
              expected = found;
              for (const TrianglePair& pair : found) {
                const int answer = filter(query, frame, pair);
                if (answer == OTG_INTERSECTING) intersecting.push_back(pair);
                if (answer == OTG_UNDECIDED) undecided.push_back(pair);
              }
            }
            REQUIRE(found == expected);
            REQUIRE(sure == intersecting);
            REQUIRE(open == undecided);
          }
          certain += intersecting.size();
          unsure += undecided.size();
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
  CHECK(certain > 1000);
  CHECK(unsure > 100);
}
