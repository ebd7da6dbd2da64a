// SPDX-License-Identifier: BSD-3-Clause
// The near phase's filters for eight pairs of triangles, in float and in double: see wide_kernels.h. Lane by lane they
// are otgTrianglesFilter.
#pragma once

#include "collide/simd/simd_real.h"
#include "collide/simd/wide_kernels_args.h"

namespace otg::OTG_SIMD_NAMESPACE {

using SimdVec = Vec3<SimdReal>;
using SimdVecD = Vec3<SimdDouble>;

[[gnu::always_inline]] inline SimdVec spread(const Vec3f& v) {
  return {SimdReal(v.x), SimdReal(v.y), SimdReal(v.z)};
}

template <class Real, class T>
[[gnu::always_inline]] inline Vec3<Real> loadVec(const T* x, const T* y, const T* z) {
  return {Real::load(x), Real::load(y), Real::load(z)};
}

/// On which side of a plane three points certainly are.
template <class Mask>
struct SideMasks {
  Mask above[3], below[3];
  [[gnu::always_inline]] Mask oneSide() const {
    return (above[0] & above[1] & above[2]) | (below[0] & below[1] & below[2]);
  }
  [[gnu::always_inline]] Mask decided() const {
    return (above[0] | below[0]) & (above[1] | below[1]) & (above[2] | below[2]);
  }
  /// Whether point i is the one that is alone on its side, once all are decided and not on one side.
  [[gnu::always_inline]] Mask alone(int i) const {
    return (above[i] ^ above[(i + 1) % 3]) & (above[i] ^ above[(i + 2) % 3]);
  }
};

template <class Real>
[[gnu::always_inline]] inline SideMasks<typename Real::Ints> sidesOf(const PlaneSides<Real>& s) {
  SideMasks<typename Real::Ints> m;
  for (int i = 0; i < 3; ++i) {
    m.above[i] = s.value[i].v > s.bound[i].v;
    m.below[i] = s.value[i].v < -s.bound[i].v;
  }
  return m;
}

template <class Real>
[[gnu::always_inline]] inline Vec3<Real> choose(const typename Real::Ints& m, const Vec3<Real>& x,
                                                const Vec3<Real>& y) {
  return {m ? x.x.v : y.x.v, m ? x.y.v : y.y.v, m ? x.z.v : y.z.v};
}

/// Corner i + k (modulo 3) of every lane's triangle, i the one that is alone.
template <class Real>
[[gnu::always_inline]] inline Vec3<Real> cornerFrom(const typename Real::Ints* alone, const Vec3<Real>* corners,
                                                    int k) {
  return choose<Real>(alone[0], corners[k % 3], choose<Real>(alone[1], corners[(k + 1) % 3], corners[(k + 2) % 3]));
}

template <class Mask>
struct OrientMasks {
  Mask positive, negative;
};

/// otgOrientFilter.
template <class Real>
[[gnu::always_inline]] inline OrientMasks<typename Real::Ints> orient(const FilterError<Real>& e, const Vec3<Real>& a,
                                                                      const Vec3<Real>& b, const Vec3<Real>& c,
                                                                      const Vec3<Real>& d) {
  const Vec3<Real> u = otgSub(b, a), v = otgSub(c, a), w = otgSub(d, a);
  const Real det = otgDot(otgCross(u, v), w);
  const Real bound = otgDetBound(e, otgNorm1(u), otgNorm1(v), otgNorm1(w));
  return {det.v > bound.v, det.v < -bound.v};
}

/// What otgTrianglesFilter says of pairs that its plane tests leave.
template <class Real>
[[gnu::always_inline]] inline OrientMasks<typename Real::Ints> filterCrossing(
    const FilterError<Real>& e, const SideMasks<typename Real::Ints>& sideA,
    const SideMasks<typename Real::Ints>& sideB, const Vec3<Real>* a, const Vec3<Real>* b) {
  using Vec = Vec3<Real>;
  using Mask = typename Real::Ints;
  const Mask aloneA[2] = {sideA.alone(0), sideA.alone(1)}, aloneB[2] = {sideB.alone(0), sideB.alone(1)};
  const Vec p1 = cornerFrom<Real>(aloneA, a, 0), p2 = cornerFrom<Real>(aloneB, b, 0);
  const Vec qa = cornerFrom<Real>(aloneA, a, 1), ra = cornerFrom<Real>(aloneA, a, 2);
  const Vec qb = cornerFrom<Real>(aloneB, b, 1), rb = cornerFrom<Real>(aloneB, b, 2);
  // Whether the corner that is alone lies above the other's plane; else the other triangle is turned over.
  const Mask aboveA = aloneA[0] ? sideA.above[0] : aloneA[1] ? sideA.above[1] : sideA.above[2];
  const Mask aboveB = aloneB[0] ? sideB.above[0] : aloneB[1] ? sideB.above[1] : sideB.above[2];
  const Vec q2 = choose<Real>(aboveA, qb, rb), r2 = choose<Real>(aboveA, rb, qb);
  const Vec q1 = choose<Real>(aboveB, qa, ra), r1 = choose<Real>(aboveB, ra, qa);
  const auto s1 = orient(e, q1, q2, p2, p1), s2 = orient(e, p1, r2, p2, r1);
  return {s1.positive | s2.positive, s1.negative & s2.negative};
}

/// Lanes that certainly intersect, and those that are undecided.
struct FilterBits {
  unsigned intersecting, undecided;
};

/// `lanes`: those to look at.
template <class Real>
[[gnu::always_inline]] inline FilterBits filterEight(const FilterError<Real>& error, const Vec3<Real>* a,
                                                     const Vec3<Real>* b, unsigned lanes) {
  const auto sideA = sidesOf<Real>(otgPlaneSides(error, b[0], b[1], b[2], a[0], a[1], a[2]));
  lanes &= ~bitsOf(sideA.oneSide());
  if (!lanes) return {0, 0};
  const auto sideB = sidesOf<Real>(otgPlaneSides(error, a[0], a[1], a[2], b[0], b[1], b[2]));
  lanes &= ~bitsOf(sideB.oneSide());
  if (!lanes) return {0, 0};
  const unsigned decided = lanes & bitsOf(sideA.decided() & sideB.decided());
  if (!decided) return {0, lanes};
  const auto answer = filterCrossing<Real>(error, sideA, sideB, a, b);
  const unsigned apart = decided & bitsOf(answer.positive), meeting = decided & ~apart & bitsOf(answer.negative);
  return {meeting, lanes & ~apart & ~meeting};
}

/// Eight points, a coordinate in each vector. By way of registers: a load that spans many small stores has to wait
/// until these are in the cache.
template <class Real>
[[gnu::always_inline]] inline Vec3<Real> loadPoints(const Vec3f* const* p) {
  using T = typename Real::T;
  using Values = typename Real::Values;
  const auto coordinate = [&](float Vec3f::*x) {
    return Real(Values{static_cast<T>(p[0]->*x), static_cast<T>(p[1]->*x), static_cast<T>(p[2]->*x),
                       static_cast<T>(p[3]->*x), static_cast<T>(p[4]->*x), static_cast<T>(p[5]->*x),
                       static_cast<T>(p[6]->*x), static_cast<T>(p[7]->*x)});
  };
  return {coordinate(&Vec3f::x), coordinate(&Vec3f::y), coordinate(&Vec3f::z)};
}

/// Corners of eight pairs; lanes past the end repeat the last pair.
struct EightPairs {
  const Vec3f *a[3][8], *b[3][8];

  [[gnu::always_inline]] EightPairs(const TriangleFilterArgs& args, const TrianglePair* pairs, std::size_t count) {
    for (std::size_t k = 0; k < 8; ++k) {
      const TrianglePair& pair = pairs[k < count ? k : count - 1];
      const Triangle &ta = args.trianglesA[pair.a], &tb = args.trianglesB[pair.b];
      for (int v = 0; v < 3; ++v) {
        a[v][k] = args.verticesA + ta.v[v];
        b[v][k] = args.verticesB + tb.v[v];
      }
    }
  }
};

/// `count` pairs, to where they belong. What is undecided may take the place of pairs that were read.
[[gnu::always_inline]] inline void put(const FilterBits& found, const TrianglePair* pairs, std::size_t count,
                                       TriangleFilterArgs& args) {
  // Without a branch that nobody could predict: what does not count is overwritten.
  for (std::size_t k = 0; k < count; ++k) {
    args.intersecting[args.intersectingCount] = pairs[k];
    args.intersectingCount += found.intersecting >> k & 1;
  }
  for (unsigned bits = found.undecided; bits; bits &= bits - 1) {
    args.undecided[args.undecidedCount++] = pairs[__builtin_ctz(bits)];
  }
}

void filterTriangles(TriangleFilterArgs& args) {
  Transform<SimdReal> toA;
  for (int i = 0; i < 9; ++i) toA.r[i] = args.turn->r[i];
  constexpr std::size_t kStaysInCaches = 2048;  // what fewer candidates read
  for (std::size_t begin = 0; begin < args.count; begin += 8) {
    const std::size_t n = args.count - begin < 8 ? args.count - begin : 8;
    const TrianglePair* pairs = args.candidates + begin;
    if (args.count >= kStaysInCaches && begin + 24 <= args.count) {
      // Corners two blocks ahead: their indices came with the block before.
      for (std::size_t k = 8; k < 16; ++k) {
        const Triangle &ta = args.trianglesA[pairs[k].a], &tb = args.trianglesB[pairs[k].b];
        for (int v = 0; v < 3; ++v) {
          __builtin_prefetch(args.verticesA + ta.v[v]);
          __builtin_prefetch(args.verticesB + tb.v[v]);
        }
        __builtin_prefetch(args.trianglesA + pairs[k + 8].a);
        __builtin_prefetch(args.trianglesB + pairs[k + 8].b);
      }
    }
    const EightPairs lanes(args, pairs, n);
    // Candidates that follow each other lie near each other: they share a place.
    const NearFrame near = nearFrame(*args.bInA, *lanes.a[0][0]);
    const SimdVec centerA = spread(near.centerA), centerB = spread(near.centerB);
    toA.t = spread(near.t);
    SimdVec a[3], b[3];
    for (int v = 0; v < 3; ++v) {
      a[v] = otgSub(loadPoints<SimdReal>(lanes.a[v]), centerA);
      b[v] = otgSub(loadPoints<SimdReal>(lanes.b[v]), centerB);
    }
    const FilterError<SimdReal> error = nearFilterError(*args.error, a, b, toA.t);
    for (SimdVec& corner : b) corner = otgTransform(toA, corner);
    put(filterEight(error, a, b, (1u << n) - 1), pairs, n, args);
  }
}

void filterTrianglesInDouble(TriangleFilterArgs& args) {
  Transform<SimdDouble> toA;
  for (int i = 0; i < 9; ++i) toA.r[i] = args.bInA->r[i];
  toA.t = {SimdDouble(args.bInA->t.x), SimdDouble(args.bInA->t.y), SimdDouble(args.bInA->t.z)};
  const FilterError<double>& e = *args.doubleError;
  const FilterError<SimdDouble> error{SimdDouble(e.unit), SimdDouble(e.delta), SimdDouble(e.tiny)};
  for (std::size_t begin = 0; begin < args.count; begin += 8) {
    const std::size_t n = args.count - begin < 8 ? args.count - begin : 8;
    const TrianglePair* pairs = args.candidates + begin;
    const EightPairs lanes(args, pairs, n);
    SimdVecD a[3], b[3];
    for (int v = 0; v < 3; ++v) {
      a[v] = loadPoints<SimdDouble>(lanes.a[v]);
      b[v] = otgTransform(toA, loadPoints<SimdDouble>(lanes.b[v]));
    }
    put(filterEight(error, a, b, (1u << n) - 1), pairs, n, args);
  }
}

}  // namespace otg::OTG_SIMD_NAMESPACE
