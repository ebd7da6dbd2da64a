// SPDX-License-Identifier: BSD-3-Clause
// Every instruction set gives the same candidates in the same order, and of each what the scalar filter says.
#include <cmath>
#include <random>
#include <set>

#include "base/vectors.h"
#include "collide/simd/wide_kernels.h"
#include "collide/stages.h"
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

const Vec3f& corner(const TriMesh& mesh, std::uint32_t triangle, int k) {
  return mesh.vertices()[mesh.triangles()[triangle].v[k]];
}

int filter(const Query& query, const PairFrame& frame, const NearFrame& near, const TrianglePair& pair) {
  Vec3f a[3], b[3];
  for (int k = 0; k < 3; ++k) {
    a[k] = otgSub(corner(query.a->mesh(), pair.a, k), near.centerA);
    b[k] = otgSub(corner(query.b->mesh(), pair.b, k), near.centerB);
  }
  const FilterError<float> error = nearFilterError(frame.nearError, a, b, near.t);
  Transformf toA = frame.trianglesInA;
  toA.t = near.t;
  for (Vec3f& p : b) p = otgTransform(toA, p);
  return otgTrianglesFilter(error, a, b);
}

int filterInDouble(const Query& query, const PairFrame& frame, const TrianglePair& pair) {
  Vec3d a[3], b[3];
  cornersOfA(query.a->mesh(), pair.a, a);
  cornersOfB(query.b->mesh(), query.bInA, pair.b, b);
  return otgTrianglesFilter(frame.doubleError, a, b);
}

}  // namespace

TEST_CASE("instruction sets agree bit for bit") {
  const CollisionMesh torus(scenes::build(scenes::makeTorus(1.0, 0.4, 61, 29)), BuildStrategy::kSah);
  const CollisionMesh lump(scenes::build(scenes::makeLump(0.9, 4, 0.2, 7)), BuildStrategy::kSah);
  const CollisionMesh one(scenes::build(scenes::makeTetrahedron({0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1})),
                          BuildStrategy::kSah);
  const CollisionMesh box(scenes::build(scenes::makeBox({1, 1, 1}, 5)), BuildStrategy::kSah);
  std::size_t candidates = 0, certain = 0, unsure = 0, exact = 0;
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
          std::vector<TrianglePair> expected, intersecting, undecided, sureInDouble, openInDouble;
          for (const SimdLevel level : levels()) {
            CollideStats stats;
            std::vector<TrianglePair> found, sure, open;
            traverseWide(level, query, frame, found, stats);
            filterTriangles(level, query, frame, found, sure, open);
            if (level == SimdLevel::kBaseline) {
              expected = found;
              for (std::size_t k = 0; k < found.size(); ++k) {
                const TrianglePair& pair = found[k];
                const NearFrame near = nearFrame(query.bInA, corner(a->mesh(), found[k / 8 * 8].a, 0));
                const int answer = filter(query, frame, near, pair);
                if (answer == OTG_INTERSECTING) intersecting.push_back(pair);
                if (answer == OTG_UNDECIDED) undecided.push_back(pair);
              }
              sureInDouble = intersecting;
              for (const TrianglePair& pair : undecided) {
                const int answer = filterInDouble(query, frame, pair);
                if (answer == OTG_INTERSECTING) sureInDouble.push_back(pair);
                if (answer == OTG_UNDECIDED) openInDouble.push_back(pair);
              }
            }
            REQUIRE(found == expected);
            REQUIRE(sure == intersecting);
            REQUIRE(open == undecided);
            filterTrianglesInDouble(level, query, frame, sure, open);
            REQUIRE(sure == sureInDouble);
            REQUIRE(open == openInDouble);
          }
          certain += intersecting.size();
          unsure += undecided.size();
          exact += openInDouble.size();
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
  CHECK(exact > 100);
}

TEST_CASE("the float filter tells small triangles apart on a mesh of any size") {
  const CollisionMesh ball(scenes::build(scenes::makeLump(0.5, 3, 0, 1)), BuildStrategy::kSah);
  std::mt19937 random(5);
  std::uniform_real_distribution<double> uniform(-1, 1);
  std::size_t candidates = 0, unsure = 0, sure = 0;
  const auto hills = [](double x, double y) { return 0.05 * std::sin(3 * x) * std::cos(2 * y); };
  for (const int cells : {8, 64, 300}) {
    const CollisionMesh ground(scenes::build(scenes::makeGround(0.25 * cells, 1, cells, hills)), BuildStrategy::kSah);
    for (int i = 0; i < 40; ++i) {
      Query query;
      query.a = i % 2 == 0 ? &ball : &ground;
      query.b = i % 2 == 0 ? &ground : &ball;
      query.bInA = pose(0.15 * i, {0, 0, 0});
      const double reach = 0.1 * cells;
      const Vec3d at{reach * uniform(random), reach * uniform(random), 0.45};
      // The ball over the ground, in the frame of either.
      if (i % 2 == 0) {
        query.bInA.t = otgScale(otgRotate(query.bInA, at), -1.0);
      } else {
        query.bInA.t = at;
      }
      const PairFrame frame = makePairFrame(query);
      CollideStats stats;
      std::vector<TrianglePair> found, meeting, open;
      traverseWide(bestSimdLevel(), query, frame, found, stats);
      filterTriangles(bestSimdLevel(), query, frame, found, meeting, open);
      candidates += found.size();
      unsure += open.size();
      sure += meeting.size();
      std::set<TrianglePair> said(meeting.begin(), meeting.end());
      const std::set<TrianglePair> unsaid(open.begin(), open.end());
      for (const TrianglePair& pair : found) {
        if (!unsaid.contains(pair)) REQUIRE(decidePair(query, frame, pair, stats) == said.contains(pair));
      }
    }
  }
  CHECK(sure > 500);
  CHECK(100 * unsure < candidates);
}

TEST_CASE("what float is sure of is so within its error, too") {
  // Small triangles far from each other share a place. B's lie in the planes of A's, but for what rounds where they are
  // kept.
  constexpr std::uint32_t kCount = 4000;
  std::mt19937 random(9);
  std::uniform_real_distribution<double> uniform(-1, 1);
  const auto anywhere = [&](double reach) {
    return Vec3d{reach * uniform(random), reach * uniform(random), reach * uniform(random)};
  };
  std::size_t unsure = 0, sure = 0;
  for (const double scale : {1.0, 1e-9, 1e9}) {
    for (const double far : {0.0, 30.0, 3000.0}) {
      for (const double size : {1.0, 1e-2, 1e-4}) {
        Query query;
        query.bInA = pose(uniform(random), anywhere(far * scale));
        for (double& r : query.bInA.r) r *= 1 + 3e-4 * uniform(random);  // is used as it is
        scenes::MeshArrays soup[2];
        for (std::uint32_t i = 0; i < kCount; ++i) {
          Vec3d a[3];
          const Vec3d middle = otgAdd(anywhere(1), Vec3d{far, 0, 0});
          for (Vec3d& p : a) p = otgScale(otgAdd(middle, anywhere(size)), scale);
          for (const Vec3d& p : a) {
            soup[0].vertices.push_back({static_cast<float>(p.x), static_cast<float>(p.y), static_cast<float>(p.z)});
            const double u = 2 * uniform(random), v = 2 * uniform(random);
            const Vec3d at = a[0] + (a[1] - a[0]) * u + (a[2] - a[0]) * v;
            const Vec3d b = otgRotateBack(query.bInA, at - query.bInA.t);
            soup[1].vertices.push_back({static_cast<float>(b.x), static_cast<float>(b.y), static_cast<float>(b.z)});
          }
          for (scenes::MeshArrays& mesh : soup) mesh.triangles.push_back({3 * i, 3 * i + 1, 3 * i + 2});
        }
        const CollisionMesh a(scenes::build(soup[0]), BuildStrategy::kSah),
            b(scenes::build(soup[1]), BuildStrategy::kSah);
        query.a = &a;
        query.b = &b;
        std::vector<TrianglePair> pairs(kCount), meeting, open;
        for (std::uint32_t i = 0; i < kCount; ++i) {
          pairs[i] = {a.mesh().triangleOfCaller(i), b.mesh().triangleOfCaller(i)};
        }
        const PairFrame frame = makePairFrame(query);
        filterTriangles(bestSimdLevel(), query, frame, pairs, meeting, open);
        unsure += open.size();
        sure += kCount - open.size();
        const std::set<TrianglePair> said(meeting.begin(), meeting.end()), unsaid(open.begin(), open.end());
        CollideStats stats;
        std::size_t wrong = 0;
        for (const TrianglePair& pair : pairs) {
          if (!unsaid.contains(pair)) wrong += decidePair(query, frame, pair, stats) != said.contains(pair);
        }
        INFO("scale " << scale << ", far " << far << ", size " << size);
        CHECK(wrong == 0);
      }
    }
  }
  CHECK(sure > 1000);
  CHECK(unsure > 1000);
}
