// SPDX-License-Identifier: BSD-3-Clause
// On which side of a triangle's plane three points lie, with a bound on the error: the first step of Moeller's
// triangle-triangle test, as a filter. A value whose magnitude exceeds its bound has the sign that exact arithmetic
// gives.
//
// Bound: let the rows of the determinant be differences of points, each known to within `delta` per coordinate. Let l
// be the 1-norms of the computed rows, enlarged by 6 delta. Evaluating the determinant costs at most 8 u l1 l2 l3.
// Shewchuk 1997 has (7 + 56 u) u times the permanent, which the product of 1-norms majorises; moving its rows by 2
// delta costs at most 2 delta (l2 l3 + l1 l3 + l1 l2) by multilinearity. Both are rounded up here to absorb the
// rounding of the bound itself.
#if defined(OTG_REAL_DOUBLE) ? !defined(OTG_SHARED_PLANE_TEST_D) : !defined(OTG_SHARED_PLANE_TEST_F)
#ifdef OTG_REAL_DOUBLE
#define OTG_SHARED_PLANE_TEST_D
#else
#define OTG_SHARED_PLANE_TEST_F
#endif
#include "shared/math/vec3.h"
//
#include "shared/math/generic_begin.h"

#ifndef __OPENCL_VERSION__
namespace otg {
/// Three determinants and the bounds of their errors.
template <class REAL>
struct PlaneSides {
  REAL value[3];
  REAL bound[3];
};
#define OTG_PLANE_SIDES PlaneSides<REAL>

/// How exact the numbers of a filter are.
template <class REAL>
struct FilterError {
  REAL unit;   ///< ten times the unit roundoff of REAL
  REAL delta;  ///< 2.1 times the largest error of any coordinate that goes in
  REAL tiny;   ///< more than anything that underflow can add
};
#define OTG_FILTER_ERROR FilterError<REAL>
#else
#define OTG_PLANE_SIDES OTG_NAME(otg_plane_sides)
#define OTG_FILTER_ERROR OTG_NAME(otg_filter_error)
typedef struct {
  REAL value[3];
  REAL bound[3];
} OTG_PLANE_SIDES;
typedef struct {
  REAL unit, delta, tiny;
} OTG_FILTER_ERROR;
#endif

OTG_GENERIC REAL OTG_NAME(otgNorm1)(OTG_VEC3 v) {
  return OTG_ABS(v.x) + OTG_ABS(v.y) + OTG_ABS(v.z);
}

/// Bound for a determinant with rows of the 1-norms l1, l2, l3.
OTG_GENERIC REAL OTG_NAME(otgDetBound)(OTG_FILTER_ERROR e, REAL l1, REAL l2, REAL l3) {
  REAL m1 = l1 + e.delta * 3.0f, m2 = l2 + e.delta * 3.0f, m3 = l3 + e.delta * 3.0f;
  return e.unit * (m1 * m2 * m3) + e.delta * (m2 * m3 + m1 * m3 + m1 * m2) + e.tiny;
}

/// value[i] > 0: point i is on the side to which the normal (p1 - p0) x (p2 - p0) points; the value is six times the
/// signed volume of the tetrahedron.
OTG_GENERIC OTG_PLANE_SIDES OTG_NAME(otgPlaneSides)(OTG_FILTER_ERROR e, OTG_VEC3 p0, OTG_VEC3 p1, OTG_VEC3 p2,
                                                    OTG_VEC3 q0, OTG_VEC3 q1, OTG_VEC3 q2) {
  OTG_PLANE_SIDES s;
  OTG_VEC3 u = OTG_NAME(otgSub)(p1, p0), v = OTG_NAME(otgSub)(p2, p0);
  OTG_VEC3 n = OTG_NAME(otgCross)(u, v);
  OTG_VEC3 w0 = OTG_NAME(otgSub)(q0, p0), w1 = OTG_NAME(otgSub)(q1, p0), w2 = OTG_NAME(otgSub)(q2, p0);
  REAL lu = OTG_NAME(otgNorm1)(u), lv = OTG_NAME(otgNorm1)(v);
  s.value[0] = OTG_NAME(otgDot)(n, w0);
  s.value[1] = OTG_NAME(otgDot)(n, w1);
  s.value[2] = OTG_NAME(otgDot)(n, w2);
  s.bound[0] = OTG_NAME(otgDetBound)(e, lu, lv, OTG_NAME(otgNorm1)(w0));
  s.bound[1] = OTG_NAME(otgDetBound)(e, lu, lv, OTG_NAME(otgNorm1)(w1));
  s.bound[2] = OTG_NAME(otgDetBound)(e, lu, lv, OTG_NAME(otgNorm1)(w2));
  return s;
}

#undef OTG_PLANE_SIDES
#undef OTG_FILTER_ERROR
#ifndef __OPENCL_VERSION__
}  // namespace otg
#endif
#include "shared/math/generic_end.h"
#endif
