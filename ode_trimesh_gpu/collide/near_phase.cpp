// SPDX-License-Identifier: BSD-3-Clause
// Near phase: which candidate pairs of triangles intersect. Float filter, then double filter, then exact arithmetic.
#include <algorithm>
#include <chrono>

#include "collide/pair_frame.h"
#include "collide/query.h"
#include "collide/stages.h"
#include "collide/wide_kernels.h"
#include "shared/triangle_exact.h"
#include "shared/triangle_test.h"

namespace otg {
namespace {

void centredCornersOfA(const TriMesh& mesh, std::uint32_t triangle, Vec3f out[3]) {
  for (int k = 0; k < 3; ++k) out[k] = otgSub(mesh.vertices()[mesh.triangles()[triangle].v[k]], mesh.center());
}

void centredCornersOfB(const TriMesh& mesh, const Transformf& toA, std::uint32_t triangle, Vec3f out[3]) {
  centredCornersOfA(mesh, triangle, out);
  for (int k = 0; k < 3; ++k) out[k] = otgTransform(toA, out[k]);
}

}  // namespace

bool decidePair(const Query& query, const PairFrame& frame, const TrianglePair& pair, CollideStats& stats) {
  Vec3d a[3], b[3];
  cornersOfA(query.a->mesh(), pair.a, a);
  cornersOfB(query.b->mesh(), query.bInA, pair.b, b);
  ++stats.decidedByDouble;
  const int answer = otgTrianglesFilter(frame.doubleError, a, b);
  if (answer != OTG_UNDECIDED) return answer == OTG_INTERSECTING;
  ++stats.decidedExactly;
  // Far from its own origin a small triangle of B may have lost its area when its corners were rounded to A's frame.
  // Such a triangle meets nothing, like one that never had any: what exact arithmetic says of it depends on nothing but
  // the boxes that brought it here.
  if (otgIsWithoutArea(&b[0].x)) return false;
  return otgTrianglesMeetExact(&a[0].x, &b[0].x) != 0;
}

void nearPhase(const Query& query, Workspace& workspace) {
  using Clock = std::chrono::steady_clock;
  const auto start = query.options.timings ? Clock::now() : Clock::time_point{};
  CollideStats& stats = workspace.stats;
  workspace.intersecting.clear();
  if (!workspace.candidates.empty()) {
    const TriMesh& a = query.a->mesh();
    const TriMesh& b = query.b->mesh();
    const PairFrame frame = makePairFrame(query);
    filterByPlanes(bestSimdLevel(), query, frame, workspace.candidates, workspace.crossing);
    for (const TrianglePair& pair : workspace.crossing) {
      if (a.isDegenerate(pair.a) || b.isDegenerate(pair.b)) continue;
      Vec3f ta[3], tb[3];
      centredCornersOfA(a, pair.a, ta);
      centredCornersOfB(b, frame.trianglesInA, pair.b, tb);
      const int answer = otgTrianglesFilter(frame.floatError, ta, tb);
      if (answer == OTG_DISJOINT) continue;
      if (answer == OTG_UNDECIDED && !decidePair(query, frame, pair, stats)) continue;
      workspace.intersecting.push_back(pair);
    }
    std::sort(workspace.intersecting.begin(), workspace.intersecting.end());
  }
  stats.intersectingPairs = workspace.intersecting.size();
  if (query.options.timings) stats.nearMs = std::chrono::duration<double, std::milli>(Clock::now() - start).count();
}

}  // namespace otg
