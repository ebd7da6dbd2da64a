// SPDX-License-Identifier: BSD-3-Clause
// Bodies of the SIMD stages, for the instruction set that OTG_SIMD_NAMESPACE names: see wide_kernels.h.
#pragma once

#include "collide/simd/simd_real.h"
#include "collide/simd/wide_kernels_args.h"
#include "shared/tests/box_test.h"
#include "shared/tests/plane_test.h"

namespace otg::OTG_SIMD_NAMESPACE {

using SimdVec = Vec3<SimdReal>;

inline SimdVec spread(const Vec3f& v) {
  return {SimdReal(v.x), SimdReal(v.y), SimdReal(v.z)};
}

inline SimdVec loadVec(const float* x, const float* y, const float* z) {
  return {SimdReal::load(x), SimdReal::load(y), SimdReal::load(z)};
}

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
  const SimdVec center = scaledCenter(scale, loadVec(boxes.centerX, boxes.centerY, boxes.centerZ));
  const SimdVec extent = scaledExtent(scale, loadVec(boxes.extentX, boxes.extentY, boxes.extentZ), center);
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
  const SimdVec center = loadVec(boxes.centerX, boxes.centerY, boxes.centerZ);
  const SimdVec extent = loadVec(boxes.extentX, boxes.extentY, boxes.extentZ);
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

using SimdMask = SimdReal::Ints;

/// On which side of a plane three points certainly are.
struct SideMasks {
  SimdMask above[3], below[3];
  SimdMask oneSide() const { return (above[0] & above[1] & above[2]) | (below[0] & below[1] & below[2]); }
  SimdMask decided() const { return (above[0] | below[0]) & (above[1] | below[1]) & (above[2] | below[2]); }
  /// Whether point i is the one that is alone on its side, once all are decided and not on one side.
  SimdMask alone(int i) const { return (above[i] ^ above[(i + 1) % 3]) & (above[i] ^ above[(i + 2) % 3]); }
};

inline SideMasks sidesOf(const PlaneSides<SimdReal>& s) {
  SideMasks m;
  for (int i = 0; i < 3; ++i) {
    m.above[i] = s.value[i].v > s.bound[i].v;
    m.below[i] = s.value[i].v < -s.bound[i].v;
  }
  return m;
}

inline SimdVec choose(const SimdMask& m, const SimdVec& x, const SimdVec& y) {
  return {m ? x.x.v : y.x.v, m ? x.y.v : y.y.v, m ? x.z.v : y.z.v};
}

/// Corner i + k (modulo 3) of every lane's triangle, i the one that is alone.
inline SimdVec cornerFrom(const SimdMask* alone, const SimdVec* corners, int k) {
  return choose(alone[0], corners[k % 3], choose(alone[1], corners[(k + 1) % 3], corners[(k + 2) % 3]));
}

struct OrientMasks {
  SimdMask positive, negative;
};

/// otgOrientFilter.
inline OrientMasks orient(const FilterError<SimdReal>& e, const SimdVec& a, const SimdVec& b, const SimdVec& c,
                          const SimdVec& d) {
  const SimdVec u = otgSub(b, a), v = otgSub(c, a), w = otgSub(d, a);
  const SimdReal det = otgDot(otgCross(u, v), w);
  const SimdReal bound = otgDetBound(e, otgNorm1(u), otgNorm1(v), otgNorm1(w));
  return {det.v > bound.v, det.v < -bound.v};
}

/// Lane by lane what otgTrianglesFilter says of pairs that its plane tests leave.
struct FilterMasks {
  SimdMask disjoint, intersecting;
};

inline FilterMasks filterCrossing(const FilterError<SimdReal>& e, const SideMasks& sideA, const SideMasks& sideB,
                                  const SimdVec* a, const SimdVec* b) {
  const SimdMask aloneA[2] = {sideA.alone(0), sideA.alone(1)}, aloneB[2] = {sideB.alone(0), sideB.alone(1)};
  const SimdVec p1 = cornerFrom(aloneA, a, 0), p2 = cornerFrom(aloneB, b, 0);
  const SimdVec qa = cornerFrom(aloneA, a, 1), ra = cornerFrom(aloneA, a, 2);
  const SimdVec qb = cornerFrom(aloneB, b, 1), rb = cornerFrom(aloneB, b, 2);
  // Whether the corner that is alone lies above the other's plane; else the other triangle is turned over.
  const SimdMask aboveA = aloneA[0] ? sideA.above[0] : aloneA[1] ? sideA.above[1] : sideA.above[2];
  const SimdMask aboveB = aloneB[0] ? sideB.above[0] : aloneB[1] ? sideB.above[1] : sideB.above[2];
  const SimdVec q2 = choose(aboveA, qb, rb), r2 = choose(aboveA, rb, qb);
  const SimdVec q1 = choose(aboveB, qa, ra), r1 = choose(aboveB, ra, qa);
  const OrientMasks s1 = orient(e, q1, q2, p2, p1), s2 = orient(e, p1, r2, p2, r1);
  return {s1.positive | s2.positive, s1.negative & s2.negative};
}

void filterTriangles(TriangleFilterArgs& args) {
  const SimdVec centerA = spread(args.centerA), centerB = spread(args.centerB);
  Transform<SimdReal> toA;
  for (int i = 0; i < 9; ++i) toA.r[i] = args.toA->r[i];
  toA.t = spread(args.toA->t);
  const FilterError<SimdReal> error{args.error->unit, args.error->delta, args.error->tiny};
  alignas(32) float lanes[2][9][8];
  std::size_t intersecting = 0, undecided = 0;
  for (std::size_t begin = 0; begin < args.count; begin += 8) {
    const std::size_t n = args.count - begin < 8 ? args.count - begin : 8;
    if (begin + 24 <= args.count) {  // corners two blocks ahead: their indices came with the block before
      for (std::size_t k = 8; k < 16; ++k) {
        const Triangle &ta = args.trianglesA[args.candidates[begin + k].a],
                       &tb = args.trianglesB[args.candidates[begin + k].b];
        for (int v = 0; v < 3; ++v) {
          __builtin_prefetch(args.verticesA + ta.v[v]);
          __builtin_prefetch(args.verticesB + tb.v[v]);
        }
        __builtin_prefetch(args.trianglesA + args.candidates[begin + k + 8].a);
        __builtin_prefetch(args.trianglesB + args.candidates[begin + k + 8].b);
      }
    }
    for (std::size_t k = 0; k < 8; ++k) {
      const TrianglePair& c = args.candidates[begin + (k < n ? k : n - 1)];  // lanes past the end repeat the last pair
      const Triangle &ta = args.trianglesA[c.a], &tb = args.trianglesB[c.b];
      for (int v = 0; v < 3; ++v) {
        const Vec3f &pa = args.verticesA[ta.v[v]], &pb = args.verticesB[tb.v[v]];
        lanes[0][3 * v][k] = pa.x;
        lanes[0][3 * v + 1][k] = pa.y;
        lanes[0][3 * v + 2][k] = pa.z;
        lanes[1][3 * v][k] = pb.x;
        lanes[1][3 * v + 1][k] = pb.y;
        lanes[1][3 * v + 2][k] = pb.z;
      }
    }
    SimdVec a[3], b[3];
    for (int v = 0; v < 3; ++v) {
      a[v] = otgSub(loadVec(lanes[0][3 * v], lanes[0][3 * v + 1], lanes[0][3 * v + 2]), centerA);
      b[v] = otgTransform(toA, otgSub(loadVec(lanes[1][3 * v], lanes[1][3 * v + 1], lanes[1][3 * v + 2]), centerB));
    }
    unsigned keep = (1u << n) - 1;
    const SideMasks sideA = sidesOf(otgPlaneSides(error, b[0], b[1], b[2], a[0], a[1], a[2]));
    keep &= ~bitsOf(sideA.oneSide());
    if (!keep) continue;
    const SideMasks sideB = sidesOf(otgPlaneSides(error, a[0], a[1], a[2], b[0], b[1], b[2]));
    keep &= ~bitsOf(sideB.oneSide());
    if (!keep) continue;
    const unsigned decided = bitsOf(sideA.decided() & sideB.decided());
    const FilterMasks answer = filterCrossing(error, sideA, sideB, a, b);
    keep &= ~(decided & bitsOf(answer.disjoint));
    for (unsigned sure = keep & decided & bitsOf(answer.intersecting); sure; sure &= sure - 1) {
      args.intersecting[intersecting++] = args.candidates[begin + static_cast<std::size_t>(__builtin_ctz(sure))];
    }
    for (keep &= ~(decided & bitsOf(answer.intersecting)); keep; keep &= keep - 1) {
      args.undecided[undecided++] = args.candidates[begin + static_cast<std::size_t>(__builtin_ctz(keep))];
    }
  }
  args.intersectingCount = intersecting;
  args.undecidedCount = undecided;
}

}  // namespace otg::OTG_SIMD_NAMESPACE
