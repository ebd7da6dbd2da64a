// SPDX-License-Identifier: BSD-3-Clause
// Chooses the instruction set and hands plain data to its kernels.
#include "collide/simd/wide_kernels.h"

#include <algorithm>

#include "collide/pair_limit.h"
#include "collide/simd/wide_kernels_args.h"

namespace otg {
namespace {

/// The stages compiled for one instruction set.
struct Kernels {
  void (*traverse)(WideTraversalArgs&);
  void (*filter)(TriangleFilterArgs&);
  void (*filterInDouble)(TriangleFilterArgs&);
};

Kernels kernelsOf(SimdLevel level) {
  switch (level) {
#ifdef OTG_HAVE_X86_KERNELS
    case SimdLevel::kAvx512:
      return {simd_avx512::traverseWide, simd_avx512::filterTriangles, simd_avx512::filterTrianglesInDouble};
    case SimdLevel::kAvx2:
      return {simd_avx2::traverseWide, simd_avx2::filterTriangles, simd_avx2::filterTrianglesInDouble};
#endif
    default:
      return {simd_baseline::traverseWide, simd_baseline::filterTriangles, simd_baseline::filterTrianglesInDouble};
  }
}

struct PairRoom {
  std::vector<TrianglePair>& pairs;
  std::size_t most;
};

void growPairs(PairSink& sink) {
  const auto& [pairs, most] = *static_cast<const PairRoom*>(sink.owner);
  if (sink.capacity >= most) throw TooManyPairs(most);
  pairs.resize(std::min(most, std::max<std::size_t>(1024, 2 * sink.capacity)));
  sink.data = pairs.data();
  sink.capacity = pairs.size();
}

BoxOf rootOf(const WideTree& tree, const BoxScale<float>& scale) {
  return scaledBox(scale, tree.rootCenter, tree.rootExtent);
}

}  // namespace

bool leavesOutThin(const Query& query) {
  return query.options.middle.traversal == Traversal::kWide && query.a->boxScale() == nullptr &&
         query.b->boxScale() == nullptr && (query.a->hasThinTriangles() || query.b->hasThinTriangles());
}

SimdLevel bestSimdLevel() {
#ifdef OTG_HAVE_X86_KERNELS
  if (__builtin_cpu_supports("avx512vl") && __builtin_cpu_supports("avx512dq") && __builtin_cpu_supports("avx512bw")) {
    return SimdLevel::kAvx512;
  }
  if (__builtin_cpu_supports("avx2")) return SimdLevel::kAvx2;
#endif
  return SimdLevel::kBaseline;
}

const char* simdName(SimdLevel level) {
  switch (level) {
    case SimdLevel::kAvx512:
      return "avx512vl";
    case SimdLevel::kAvx2:
      return "avx2";
    case SimdLevel::kBaseline:
      break;
  }
  return "baseline";
}

void traverseWide(SimdLevel level, const Query& query, const PairFrame& frame, std::vector<TrianglePair>& out,
                  CollideStats& stats) {
  const WideTree& a = query.a->wide();
  const WideTree& b = query.b->wide();
  // Every step pops one item and pushes at most eight times eight, each further down in one of the trees or both.
  constexpr std::size_t kOrdinary = 2048;
  const std::size_t most = kWideArity * kWideArity * (std::size_t{a.depth} + b.depth) + 1;
  WideItem ordinary[kOrdinary];
  std::vector<WideItem> deep(most > kOrdinary ? most : 0);
  WideItem* const stack = most > kOrdinary ? deep.data() : ordinary;
  const BoxScale<float>&scaleA = query.a->anyBoxScale(), &scaleB = query.b->anyBoxScale();
  if (query.options.countPerDepth) stats.boxTestsPerDepth.assign(std::size_t{a.depth} + b.depth, 0);
  // No more of it than a small pair needs: resizing fills it.
  constexpr std::size_t kFirstPairs = 256;
  PairRoom room{out, static_cast<std::size_t>(query.options.middle.maxPairs)};
  out.resize(std::min({out.capacity(), kFirstPairs, room.most}));
  PairSink sink{out.data(), 0, out.size(), growPairs, &room};
  const TriMesh &meshA = query.a->mesh(), &meshB = query.b->mesh();
  const ThinTest thin{meshA.vertices().data(),  meshB.vertices().data(),
                      meshA.triangles().data(), meshB.triangles().data(),
                      meshA.origin(),           meshB.origin(),
                      &frame.trianglesInA,      4 * double{frame.floatError.delta} + 2 * double{frame.boxes.eps}};
  WideTraversalArgs args{&frame.boxes,
                         a.nodes.data(),
                         b.nodes.data(),
                         rootOf(a, scaleA),
                         rootOf(b, scaleB),
                         scaleA,
                         scaleB,
                         query.a->boxScale() != nullptr || query.b->boxScale() != nullptr,
                         stack,
                         query.options.middle.descent,
                         query.options.middle.axes > 6,
                         0,
                         query.options.countPerDepth ? stats.boxTestsPerDepth.data() : nullptr,
                         &sink,
                         leavesOutThin(query) ? &thin : nullptr};
  kernelsOf(level).traverse(args);
  out.resize(sink.size);
  stats.boxTests += args.boxTests;
}

namespace {

TriangleFilterArgs filterArgs(const Query& query, const PairFrame& frame, const std::vector<TrianglePair>& candidates,
                              TrianglePair* intersecting, TrianglePair* undecided) {
  const TriMesh& a = query.a->mesh();
  const TriMesh& b = query.b->mesh();
  return {a.vertices().data(), b.vertices().data(), a.triangles().data(), b.triangles().data(),
          &query.bInA,         &frame.trianglesInA, &frame.nearError,     &frame.doubleError,
          candidates.data(),   candidates.size(),   intersecting,         undecided};
}

}  // namespace

void filterTriangles(SimdLevel level, const Query& query, const PairFrame& frame,
                     const std::vector<TrianglePair>& candidates, std::vector<TrianglePair>& intersecting,
                     std::vector<TrianglePair>& undecided) {
  intersecting.resize(candidates.size());
  undecided.resize(candidates.size());
  TriangleFilterArgs args = filterArgs(query, frame, candidates, intersecting.data(), undecided.data());
  kernelsOf(level).filter(args);
  intersecting.resize(args.intersectingCount);
  undecided.resize(args.undecidedCount);
}

void filterTrianglesInDouble(SimdLevel level, const Query& query, const PairFrame& frame,
                             std::vector<TrianglePair>& intersecting, std::vector<TrianglePair>& undecided) {
  const std::size_t before = intersecting.size();
  intersecting.resize(before + undecided.size());
  TriangleFilterArgs args = filterArgs(query, frame, undecided, intersecting.data() + before, undecided.data());
  kernelsOf(level).filterInDouble(args);
  intersecting.resize(before + args.intersectingCount);
  undecided.resize(args.undecidedCount);
}

}  // namespace otg
