// SPDX-License-Identifier: BSD-3-Clause
// Bodies of the SIMD stages, for the instruction set that OTG_SIMD_NAMESPACE names: see wide_kernels.h.
#pragma once

#include "collide/simd/triangle_filter_impl.h"
#include "collide/simd/wide_kernels_args.h"
#include "shared/tests/box_test.h"

namespace otg::OTG_SIMD_NAMESPACE {

[[gnu::always_inline]] inline WideSide sideOf(const WideBoxes& boxes, std::int32_t child, int k) {
  const Vec3f e{boxes.extentX[k], boxes.extentY[k], boxes.extentZ[k]};
  return {{boxes.centerX[k], boxes.centerY[k], boxes.centerZ[k]}, e, child, e.x * e.y + e.y * e.z + e.z * e.x};
}

inline BoxScale<SimdReal> spread(const BoxScale<float>& s) {
  return {spread(s.factor), spread(s.shift), spread(s.growth), spread(s.pad), SimdReal(s.slope)};
}

[[gnu::always_inline]] inline void store(float* to, const SimdReal& x) {
  std::memcpy(to, &x.v, sizeof x.v);
}

/// Eight boxes at once through the scale.
[[gnu::always_inline]] inline void scaleBoxes(const BoxScale<SimdReal>& scale, const WideBoxes& boxes, WideBoxes& out) {
  const SimdVec center = scaledCenter(scale, loadVec<SimdReal>(boxes.centerX, boxes.centerY, boxes.centerZ));
  const SimdVec extent = scaledExtent(scale, loadVec<SimdReal>(boxes.extentX, boxes.extentY, boxes.extentZ), center);
  store(out.centerX, center.x);
  store(out.centerY, center.y);
  store(out.centerZ, center.z);
  store(out.extentX, extent.x);
  store(out.extentY, extent.y);
  store(out.extentZ, extent.z);
}

/// Lanes of a node with `count` children (a node of A if kOpenA, else of B) whose boxes overlap the other side's box.
template <bool kOpenA>
[[gnu::always_inline]] inline unsigned overlapBits(const BoxFrame<SimdReal>& simd, const BoxFrame<float>& frame,
                                                   const WideBoxes& boxes, std::int32_t count, const WideSide& other,
                                                   bool edges) {
  const SimdVec center = loadVec<SimdReal>(boxes.centerX, boxes.centerY, boxes.centerZ);
  const SimdVec extent = loadVec<SimdReal>(boxes.extentX, boxes.extentY, boxes.extentZ);
  const unsigned used = (1u << count) - 1;
  SimdVec d, extentA, extentB;
  if constexpr (kOpenA) {
    d = otgSub(spread(otgBoxCenterInA(frame, other.center)), center);
    extentA = extent;
    extentB = spread(other.extent);
    unsigned apart = greaterBits(otgBoxGapA(d, extentA, spread(otgBoxExtentInA(frame, other.extent))), simd.eps);
    if ((apart & used) == used) return 0;
  } else {
    d = otgSub(otgBoxCenterInA(simd, center), spread(other.center));
    extentA = spread(other.extent);
    extentB = extent;
    unsigned apart = greaterBits(otgBoxGapA(d, extentA, otgBoxExtentInA(simd, extentB)), simd.eps);
    if ((apart & used) == used) return 0;
  }
  const SimdVec inA = kOpenA ? spread(otgBoxExtentInA(frame, other.extent)) : otgBoxExtentInA(simd, extentB);
  unsigned apart = greaterBits(otgMax(otgBoxGapA(d, extentA, inA), otgBoxGapB(simd, d, extentA, extentB)), simd.eps);
  if (edges && (apart & used) != used) apart |= greaterBits(otgBoxGapEdges(simd, d, extentA, extentB), simd.eps);
  return used & ~apart;
}

/// kScaled: boxes are taken through the scales.
template <bool kScaled>
inline void traverseBoxes(WideTraversalArgs& args) {
  const BoxFrame<float>& frame = *args.frame;
  BoxFrame<SimdReal> simd;
  for (int i = 0; i < 9; ++i) {
    simd.r[i] = frame.r[i];
    simd.absR[i] = frame.absR[i];
  }
  simd.t = spread(frame.t);
  simd.eps = frame.eps;
  [[maybe_unused]] BoxScale<SimdReal> scaleA, scaleB;
  [[maybe_unused]] WideBoxes scaled;
  if constexpr (kScaled) {
    scaleA = spread(args.scaleA);
    scaleB = spread(args.scaleB);
  }
  PairSink& out = *args.out;
  std::uint64_t boxTests = 0;
  // The last of the pairs that a step finds goes on at once, without the way through the stack's memory.
  WideItem item = args.stack[0];
  std::size_t top = 0;
  for (;;) {
    bool openA = item.a.ref >= 0;
    if (openA && item.b.ref >= 0) {
      // "Both at once" has no meaning for one box against eight; it goes by size like the default.
      if (args.rule == DescentRule::kAlternating) {
        openA = item.depth % 2 == 0;
      } else if (args.rule != DescentRule::kFirstTreeFirst) {
        openA = item.a.size >= item.b.size;
      }
    }
    const WideNode& node = openA ? args.nodesA[item.a.ref] : args.nodesB[item.b.ref];
    if constexpr (kScaled) scaleBoxes(openA ? scaleA : scaleB, node, scaled);
    const WideBoxes& boxes = kScaled ? scaled : static_cast<const WideBoxes&>(node);
    unsigned bits = openA ? overlapBits<true>(simd, frame, boxes, node.count, item.b, args.edges)
                          : overlapBits<false>(simd, frame, boxes, node.count, item.a, args.edges);
    boxTests += static_cast<std::uint64_t>(node.count);
    if (args.testsPerDepth) args.testsPerDepth[item.depth] += static_cast<std::uint64_t>(node.count);
    const std::int32_t other = openA ? item.b.ref : item.a.ref;
    int last = -1;
    for (; bits; bits &= bits - 1) {
      const int k = __builtin_ctz(bits);
      const std::int32_t child = node.child[k];
      if (child < 0 && other < 0) {
        if (out.size == out.capacity) out.grow(out);
        TrianglePair& pair = out.data[out.size++];
        pair.a = static_cast<std::uint32_t>(openA ? ~child : ~other);
        pair.b = static_cast<std::uint32_t>(openA ? ~other : ~child);
        continue;
      }
      if (child >= 0) __builtin_prefetch(openA ? args.nodesA + child : args.nodesB + child);
      if (last >= 0) {
        WideItem& next = args.stack[top++];
        next.a = openA ? sideOf(boxes, node.child[last], last) : item.a;
        next.b = openA ? item.b : sideOf(boxes, node.child[last], last);
        next.depth = item.depth + 1;
      }
      last = k;
    }
    if (last >= 0) {
      (openA ? item.a : item.b) = sideOf(boxes, node.child[last], last);
      ++item.depth;
    } else if (top > 0) {
      item = args.stack[--top];
    } else {
      break;
    }
  }
  args.boxTests = boxTests;
}

void traverseWide(WideTraversalArgs& args) {
  if (args.scaled) {
    traverseBoxes<true>(args);
  } else {
    traverseBoxes<false>(args);
  }
}

}  // namespace otg::OTG_SIMD_NAMESPACE
