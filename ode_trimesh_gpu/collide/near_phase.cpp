// SPDX-License-Identifier: BSD-3-Clause
// Near phase: which candidate pairs of triangles intersect. Float filter, then double filter, then exact arithmetic.
#include <algorithm>
#include <chrono>
#include <iterator>

#include "collide/first_copies.h"
#include "collide/pair_frame.h"
#include "collide/query.h"
#include "collide/simd/wide_kernels.h"
#include "collide/stages.h"
#include "shared/tests/triangle_exact.h"
#include "shared/tests/triangle_test.h"

namespace otg {

namespace {

/// The same decision in exact arithmetic, where double cannot decide.
bool decideExactly(const Vec3d (&a)[3], const Vec3d (&b)[3], CollideStats& stats) {
  ++stats.decidedExactly;
  // Far from its own origin a small triangle of B may have lost its area when its corners were rounded to A's frame.
  // Such a triangle meets nothing, like one that never had any: what exact arithmetic says of it depends on nothing but
  // the boxes that brought it here.
  if (otgIsWithoutArea(&b[0].x)) return false;
  return otgTrianglesMeetExact(&a[0].x, &b[0].x) != 0;
}

void corners(const Query& query, const TrianglePair& pair, Vec3d (&a)[3], Vec3d (&b)[3]) {
  cornersOfA(query.a->mesh(), pair.a, a);
  cornersOfB(query.b->mesh(), query.bInA, pair.b, b);
}

/// Decides candidates, none of them twice.
void decideCandidates(const Query& query, const std::vector<TrianglePair>& candidates, Workspace& workspace) {
  const TriMesh& a = query.a->mesh();
  const TriMesh& b = query.b->mesh();
  const PairFrame frame = makePairFrame(query);
  filterTriangles(bestSimdLevel(), query, frame, candidates, workspace.intersecting, workspace.undecided);
  workspace.stats.decidedByDouble += workspace.undecided.size();
  if (!workspace.undecided.empty()) {
    filterTrianglesInDouble(bestSimdLevel(), query, frame, workspace.intersecting, workspace.undecided);
  }
  const auto degenerate = [&](const TrianglePair& p) { return a.isDegenerate(p.a) || b.isDegenerate(p.b); };
  std::erase_if(workspace.intersecting, degenerate);
  for (const TrianglePair& pair : workspace.undecided) {
    if (degenerate(pair)) continue;
    Vec3d cornersA[3], cornersB[3];
    corners(query, pair, cornersA, cornersB);
    if (decideExactly(cornersA, cornersB, workspace.stats)) workspace.intersecting.push_back(pair);
  }
  std::sort(workspace.intersecting.begin(), workspace.intersecting.end());
}

/// Copies have the result of those that they lie on. Where these are no candidates they do not meet.
void addCopies(const FirstCopies& first, const std::vector<TrianglePair>& candidates,
               std::vector<TrianglePair>& intersecting) {
  const std::size_t decided = intersecting.size();
  for (const TrianglePair& pair : candidates) {
    if (first.has(pair)) continue;
    const auto end = intersecting.begin() + static_cast<std::ptrdiff_t>(decided);
    if (std::binary_search(intersecting.begin(), end, first.of(pair))) intersecting.push_back(pair);
  }
  std::sort(intersecting.begin(), intersecting.end());
}

}  // namespace

bool decidePair(const Query& query, const PairFrame& frame, const TrianglePair& pair, CollideStats& stats) {
  Vec3d a[3], b[3];
  corners(query, pair, a, b);
  ++stats.decidedByDouble;
  const int answer = otgTrianglesFilter(frame.doubleError, a, b);
  return answer == OTG_UNDECIDED ? decideExactly(a, b, stats) : answer == OTG_INTERSECTING;
}

void nearPhase(const Query& query, Workspace& workspace) {
  using Clock = std::chrono::steady_clock;
  const auto start = query.options.timings ? Clock::now() : Clock::time_point{};
  CollideStats& stats = workspace.stats;
  workspace.intersecting.clear();
  if (!workspace.candidates.empty()) {
    const FirstCopies first(query);
    if (first.areAll()) {
      decideCandidates(query, workspace.candidates, workspace);
    } else {
      std::vector<TrianglePair> distinct;
      std::copy_if(workspace.candidates.begin(), workspace.candidates.end(), std::back_inserter(distinct),
                   [&](const TrianglePair& p) { return first.has(p); });
      decideCandidates(query, distinct, workspace);
      addCopies(first, workspace.candidates, workspace.intersecting);
    }
  }
  stats.intersectingPairs = workspace.intersecting.size();
  if (query.options.timings) stats.nearMs = std::chrono::duration<double, std::milli>(Clock::now() - start).count();
}

}  // namespace otg
