// SPDX-License-Identifier: BSD-3-Clause
// The nearest points of two triangles.
#if defined(OTG_REAL_DOUBLE) ? !defined(OTG_SHARED_TRIANGLE_DISTANCE_D) : !defined(OTG_SHARED_TRIANGLE_DISTANCE_F)
#ifdef OTG_REAL_DOUBLE
#define OTG_SHARED_TRIANGLE_DISTANCE_D
#else
#define OTG_SHARED_TRIANGLE_DISTANCE_F
#endif
#include "shared/tests/point_test.h"
//
#include "shared/math/generic_begin.h"

#ifndef __OPENCL_VERSION__
namespace otg {

template <class REAL>
struct NearestPair {
  Vec3<REAL> a, b;
  REAL distance2;
};
#define OTG_NEAREST_PAIR NearestPair<REAL>
#else
#define OTG_NEAREST_PAIR OTG_NAME(otg_nearest_pair)
typedef struct {
  OTG_VEC3 a, b;
  REAL distance2;
} OTG_NEAREST_PAIR;
#endif

OTG_GENERIC REAL OTG_NAME(otgWithinOne)(REAL x) {
  return x < 0 ? OTG_REAL(0) : x > 1 ? OTG_REAL(1) : x;
}

OTG_GENERIC OTG_NEAREST_PAIR OTG_NAME(otgPairOfPoints)(OTG_VEC3 a, OTG_VEC3 b) {
  OTG_NEAREST_PAIR pair;
  const OTG_VEC3 d = OTG_NAME(otgSub)(a, b);
  pair.a = a;
  pair.b = b;
  pair.distance2 = OTG_NAME(otgDot)(d, d);
  return pair;
}

/// Of two segments, of length zero too. Both points lie on their segments to within rounding. Source: C. Ericson,
/// Real-Time Collision Detection (2005), 5.1.9.
OTG_GENERIC OTG_NEAREST_PAIR OTG_NAME(otgNearestOnSegments)(OTG_VEC3 p1, OTG_VEC3 q1, OTG_VEC3 p2, OTG_VEC3 q2) {
  const OTG_VEC3 d1 = OTG_NAME(otgSub)(q1, p1), d2 = OTG_NAME(otgSub)(q2, p2), r = OTG_NAME(otgSub)(p1, p2);
  const REAL a = OTG_NAME(otgDot)(d1, d1), e = OTG_NAME(otgDot)(d2, d2), f = OTG_NAME(otgDot)(d2, r);
  const REAL c = OTG_NAME(otgDot)(d1, r), b = OTG_NAME(otgDot)(d1, d2);
  REAL s = 0, t = 0;
  if (a > 0 && e > 0) {
    // |d1 x d2|^2, which a e - b b would lose to cancellation for nearly parallel segments.
    const OTG_VEC3 x = OTG_NAME(otgCross)(d1, d2);
    const REAL denominator = OTG_NAME(otgDot)(x, x);
    if (denominator > 0) s = OTG_NAME(otgWithinOne)((b * f - c * e) / denominator);
    t = (b * s + f) / e;
    if (t < 0) {
      t = 0;
      s = OTG_NAME(otgWithinOne)(-c / a);
    } else if (t > 1) {
      t = 1;
      s = OTG_NAME(otgWithinOne)((b - c) / a);
    }
  } else if (a > 0) {
    s = OTG_NAME(otgWithinOne)(-c / a);
  } else if (e > 0) {
    t = OTG_NAME(otgWithinOne)(f / e);
  }
  return OTG_NAME(otgPairOfPoints)(OTG_NAME(otgAdd)(p1, OTG_NAME(otgScale)(d1, s)),
                                   OTG_NAME(otgAdd)(p2, OTG_NAME(otgScale)(d2, t)));
}

/// What the distance of a point from a triangle may be too small by, relative to how far the triangle's corners are
/// from the point: see otgPointOnTriangle.
#define OTG_ON_TRIANGLE 1e-10

/// The nearest point of a triangle, which lies on it whatever its shape. The foot on the plane (otgNearestOnTriangle)
/// is worthless where rounding decides how the plane of a sliver lies; then a mean of the corners is taken, which may
/// be farther away than need be: the sliver's edges are nearer then.
OTG_GENERIC OTG_VEC3 OTG_NAME(otgPointOnTriangle)(OTG_VEC3 a, OTG_VEC3 b, OTG_VEC3 c, OTG_VEC3 p) {
  OTG_VEC3 on;
  if (OTG_NAME(otgNearestOnTriangle)(a, b, c, p, &on) == OTG_PART_FACE) {
    const OTG_VEC3 pa = OTG_NAME(otgSub)(a, p), pb = OTG_NAME(otgSub)(b, p), pc = OTG_NAME(otgSub)(c, p);
    const OTG_VEC3 n = OTG_NAME(otgCross)(OTG_NAME(otgSub)(b, a), OTG_NAME(otgSub)(c, a));
    const REAL u = OTG_MAX(OTG_NAME(otgDot)(n, OTG_NAME(otgCross)(pb, pc)), OTG_REAL(0));
    const REAL v = OTG_MAX(OTG_NAME(otgDot)(n, OTG_NAME(otgCross)(pc, pa)), OTG_REAL(0));
    const REAL w = OTG_MAX(OTG_NAME(otgDot)(n, OTG_NAME(otgCross)(pa, pb)), OTG_REAL(0));
    const REAL sum = u + v + w;
    const OTG_VEC3 mean = sum > 0
                              ? OTG_NAME(otgAdd)(p, OTG_NAME(otgAdd)(OTG_NAME(otgScale)(pa, u / sum),
                                                                     OTG_NAME(otgAdd)(OTG_NAME(otgScale)(pb, v / sum),
                                                                                      OTG_NAME(otgScale)(pc, w / sum))))
                              : a;
    const REAL far = OTG_MAX(OTG_MAX(OTG_NAME(otgDot)(pa, pa), OTG_NAME(otgDot)(pb, pb)), OTG_NAME(otgDot)(pc, pc));
    const OTG_VEC3 off = OTG_NAME(otgSub)(on, mean);
    if (!(OTG_NAME(otgDot)(off, off) <= OTG_REAL(OTG_ON_TRIANGLE * OTG_ON_TRIANGLE) * far)) on = mean;
  }
  return on;
}

/// Of two triangles that have no point in common: a corner and a triangle, or two edges. Both points lie on their
/// triangles (OTG_ON_TRIANGLE), so that the distance is never too small: no search that passes over what is farther
/// away depends on its order.
OTG_GENERIC OTG_NEAREST_PAIR OTG_NAME(otgNearestOnTriangles)(OTG_VEC3 a0, OTG_VEC3 a1, OTG_VEC3 a2, OTG_VEC3 b0,
                                                             OTG_VEC3 b1, OTG_VEC3 b2) {
  OTG_NEAREST_PAIR best, found;
  OTG_VEC3 p = a0, q = a1, r = a2, x = b0, y = b1, z = b2;
  best.a = a0;
  best.b = b0;
  best.distance2 = OTG_REAL(INFINITY);
  // Either triangle is turned, so that there are no arrays.
  for (int i = 0; i < 3; ++i) {
    OTG_VEC3 swap;
    for (int j = 0; j < 3; ++j) {
      found = OTG_NAME(otgNearestOnSegments)(p, q, x, y);
      if (found.distance2 < best.distance2) best = found;
      swap = x;
      x = y;
      y = z;
      z = swap;
    }
    found = OTG_NAME(otgPairOfPoints)(p, OTG_NAME(otgPointOnTriangle)(b0, b1, b2, p));
    if (found.distance2 < best.distance2) best = found;
    swap = p;
    p = q;
    q = r;
    r = swap;
  }
  for (int j = 0; j < 3; ++j) {
    const OTG_VEC3 swap = x;
    found = OTG_NAME(otgPairOfPoints)(OTG_NAME(otgPointOnTriangle)(a0, a1, a2, x), x);
    if (found.distance2 < best.distance2) best = found;
    x = y;
    y = z;
    z = swap;
  }
  return best;
}

#undef OTG_NEAREST_PAIR
#ifndef __OPENCL_VERSION__
}  // namespace otg
#endif
#include "shared/math/generic_end.h"
#endif
