// SPDX-License-Identifier: BSD-3-Clause
// Do two triangles, as closed sets, have a point in common? Moeller's test: both triangles against the other's plane,
// then the overlap of their intervals on the line in which the planes meet; the coplanar case in two dimensions.
//
// Two forms: a filter in REAL that returns yes, no or "undecided", and the exact decision in double expansions. The
// interval comparison uses two orientation signs instead of interval ends (no division, so it can be filtered and be
// made exact). Sources: T. Moeller, "A Fast Triangle-Triangle Intersection Test", JGT 2(2), 1997; P. Guigue and O.
// Devillers, "Fast and Robust Triangle-Triangle Overlap Test Using Orientation Predicates", JGT 8(1), 2003.
#if defined(OTG_REAL_DOUBLE) ? !defined(OTG_SHARED_TRIANGLE_TEST_D) : !defined(OTG_SHARED_TRIANGLE_TEST_F)
#ifdef OTG_REAL_DOUBLE
#define OTG_SHARED_TRIANGLE_TEST_D
#else
#define OTG_SHARED_TRIANGLE_TEST_F
#endif
#include "shared/tests/plane_test.h"
//
#include "shared/math/generic_begin.h"

#ifndef OTG_TRIANGLE_TEST_ANSWERS
#define OTG_TRIANGLE_TEST_ANSWERS
#ifdef __OPENCL_VERSION__
enum { OTG_DISJOINT = 0, OTG_INTERSECTING = 1, OTG_UNDECIDED = 2 };
#else
namespace otg {
enum FilterAnswer : int { OTG_DISJOINT = 0, OTG_INTERSECTING = 1, OTG_UNDECIDED = 2 };
}
#endif
#endif

#ifndef __OPENCL_VERSION__
namespace otg {
#define OTG_PLANE_SIDES PlaneSides<REAL>
#define OTG_FILTER_ERROR FilterError<REAL>
#else
#define OTG_PLANE_SIDES OTG_NAME(otg_plane_sides)
#define OTG_FILTER_ERROR OTG_NAME(otg_filter_error)
#endif

/// Sign of det[b - a, c - a, d - a]: 1, -1, or 0 when the value is within its error bound.
OTG_GENERIC int OTG_NAME(otgOrientFilter)(OTG_FILTER_ERROR e, OTG_VEC3 a, OTG_VEC3 b, OTG_VEC3 c, OTG_VEC3 d) {
  OTG_VEC3 u = OTG_NAME(otgSub)(b, a), v = OTG_NAME(otgSub)(c, a), w = OTG_NAME(otgSub)(d, a);
  REAL det = OTG_NAME(otgDot)(OTG_NAME(otgCross)(u, v), w);
  REAL bound = OTG_NAME(otgDetBound)(e, OTG_NAME(otgNorm1)(u), OTG_NAME(otgNorm1)(v), OTG_NAME(otgNorm1)(w));
  return (det > bound) - (det < -bound);
}

/// Bits 0 to 2: point i certainly on the positive side; bits 3 to 5: certainly on the negative side.
OTG_GENERIC int OTG_NAME(otgSideMask)(OTG_PLANE_SIDES s) {
  return (s.value[0] > s.bound[0]) | (s.value[1] > s.bound[1]) << 1 | (s.value[2] > s.bound[2]) << 2 |
         (s.value[0] < -s.bound[0]) << 3 | (s.value[1] < -s.bound[1]) << 4 | (s.value[2] < -s.bound[2]) << 5;
}

/// The filter. `a` and `b` are the three corners of each triangle in one frame.
OTG_GENERIC int OTG_NAME(otgTrianglesFilter)(OTG_FILTER_ERROR e, const OTG_VEC3* a, const OTG_VEC3* b) {
  int sideA, sideB, ia, ib, pa, pb, s1, s2;
  OTG_VEC3 p1, q1, r1, p2, q2, r2;
  sideA = OTG_NAME(otgSideMask)(OTG_NAME(otgPlaneSides)(e, b[0], b[1], b[2], a[0], a[1], a[2]));
  if (sideA == 7 || sideA == 56) return OTG_DISJOINT;
  sideB = OTG_NAME(otgSideMask)(OTG_NAME(otgPlaneSides)(e, a[0], a[1], a[2], b[0], b[1], b[2]));
  if (sideB == 7 || sideB == 56) return OTG_DISJOINT;
  pa = sideA & 7;
  pb = sideB & 7;
  if ((pa | sideA >> 3) != 7 || (pb | sideB >> 3) != 7) return OTG_UNDECIDED;
  // Both cross the other's plane properly. Rotate each so that its first corner is alone on its side. Order the other
  // two so that this corner sees the other triangle from the positive side.
  ia = (pa == 1 || pa == 6) ? 0 : (pa == 2 || pa == 5) ? 1 : 2;
  ib = (pb == 1 || pb == 6) ? 0 : (pb == 2 || pb == 5) ? 1 : 2;
  // No places that are only known when it runs: they would keep the corners out of a device's registers.
  p1 = ia == 0 ? a[0] : ia == 1 ? a[1] : a[2];
  q1 = ia == 0 ? a[1] : ia == 1 ? a[2] : a[0];
  r1 = ia == 0 ? a[2] : ia == 1 ? a[0] : a[1];
  p2 = ib == 0 ? b[0] : ib == 1 ? b[1] : b[2];
  q2 = ib == 0 ? b[1] : ib == 1 ? b[2] : b[0];
  r2 = ib == 0 ? b[2] : ib == 1 ? b[0] : b[1];
  if (!(pa >> ia & 1)) {  // p1 below B's plane: turn B over
    OTG_VEC3 swap = q2;
    q2 = r2;
    r2 = swap;
  }
  if (!(pb >> ib & 1)) {
    OTG_VEC3 swap = q1;
    q1 = r1;
    r1 = swap;
  }
  s1 = OTG_NAME(otgOrientFilter)(e, q1, q2, p2, p1);
  if (s1 > 0) return OTG_DISJOINT;
  s2 = OTG_NAME(otgOrientFilter)(e, p1, r2, p2, r1);
  if (s2 > 0) return OTG_DISJOINT;
  return (s1 < 0 && s2 < 0) ? OTG_INTERSECTING : OTG_UNDECIDED;
}

#undef OTG_PLANE_SIDES
#undef OTG_FILTER_ERROR
#ifndef __OPENCL_VERSION__
}  // namespace otg
#endif
#include "shared/math/generic_end.h"
#endif
