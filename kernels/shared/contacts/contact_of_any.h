// SPDX-License-Identifier: BSD-3-Clause
// The contact of any two triangles, whether they meet or not, without a branch: as published for GPUs. That they do not
// meet is seen from the result: a triangle lies beyond the other's plane, or the two intervals on the line in which the
// planes meet are apart. Where the result says that they meet, the contact is otgPairwiseContact's, bit by bit.
//
// The bounds. `unit` is 32 units of roundoff u. A distance to a plane is known to within 8 u M / m + 10 u times that to
// its first corner (M: product of the largest parts of two edges; m: largest part of their cross product); `unit` (1 +
// M / m) is twice that. Let E bound both distances of a side that crosses the plane, and d be their difference. If both
// are larger than 2 E, the place of the crossing on the side is known to within 2 E / |d|. 4 E / |d| + `unit` of the
// side's length and `unit` of the coordinates cover that and all rounding twice.
#if defined(OTG_REAL_DOUBLE) ? !defined(OTG_SHARED_CONTACT_OF_ANY_D) : !defined(OTG_SHARED_CONTACT_OF_ANY_F)
#ifdef OTG_REAL_DOUBLE
#define OTG_SHARED_CONTACT_OF_ANY_D
#else
#define OTG_SHARED_CONTACT_OF_ANY_F
#endif
#include "shared/contacts/pairwise_contact.h"
#include "shared/tests/triangle_test.h"
//
#include "shared/math/generic_begin.h"

#ifndef __OPENCL_VERSION__
namespace otg {
/// A triangle's plane. `error`, times the 1-norm of a point's way from the first corner: of the point's distance.
/// Infinite where rounding may turn the normal.
template <class REAL>
struct AnyPlane {
  Vec3<REAL> normal;
  REAL error;
};
/// Where a triangle meets a plane, as an interval on a line: its ends and their points, and the error of the ends.
template <class REAL>
struct AnyInterval {
  REAL low, high, error;
  Vec3<REAL> atLow, atHigh;
};
/// `answer`: OTG_DISJOINT, OTG_INTERSECTING, with the contact, or OTG_UNDECIDED.
template <class REAL>
struct AnyContact {
  PairContact<REAL> contact;
  int answer;
};
#define OTG_ANY_PLANE AnyPlane<REAL>
#define OTG_ANY_INTERVAL AnyInterval<REAL>
#define OTG_ANY_CONTACT AnyContact<REAL>
#else
#define OTG_ANY_PLANE OTG_NAME(otg_any_plane)
#define OTG_ANY_INTERVAL OTG_NAME(otg_any_interval)
#define OTG_ANY_CONTACT OTG_NAME(otg_any_contact)
typedef struct {
  OTG_VEC3 normal;
  REAL error;
} OTG_ANY_PLANE;
typedef struct {
  REAL low, high, error;
  OTG_VEC3 atLow, atHigh;
} OTG_ANY_INTERVAL;
typedef struct {
  OTG_NAME(otg_pair_contact) contact;
  int answer;
} OTG_ANY_CONTACT;
#endif

OTG_GENERIC OTG_VEC3 OTG_NAME(otgPick)(int first, OTG_VEC3 a, OTG_VEC3 b) {
  return OTG_NAME(otgVec)(first ? a.x : b.x, first ? a.y : b.y, first ? a.z : b.z);
}

OTG_GENERIC OTG_ANY_PLANE OTG_NAME(otgAnyPlane)(const OTG_VEC3* p, REAL unit, REAL tiny) {
  const OTG_VEC3 e = OTG_NAME(otgSub)(p[1], p[0]), f = OTG_NAME(otgSub)(p[2], p[0]), n = OTG_NAME(otgCross)(e, f);
  const REAL le = OTG_NAME(otgLargestPart)(e), lf = OTG_NAME(otgLargestPart)(f), m = OTG_NAME(otgLargestPart)(n);
  const OTG_VEC3 scaled = OTG_NAME(otgVec)(n.x / m, n.y / m, n.z / m);
  const REAL length = OTG_SQRT(OTG_NAME(otgDot)(scaled, scaled));
  // Needles, of which otgCornerCross takes more digits, and what underflow may have touched.
  const int good = (m > OTG_REAL(1e-6) * le * lf) & (m > tiny);
  OTG_ANY_PLANE plane;
  plane.normal = OTG_NAME(otgVec)(scaled.x / length, scaled.y / length, scaled.z / length);
  plane.error = good ? unit * (OTG_REAL(1) + le * lf / m) : OTG_REAL(INFINITY);
  return plane;
}

/// Signed distances of a triangle's corners from the plane of another one whose first corner is `origin`; the bound of
/// their errors.
OTG_GENERIC REAL OTG_NAME(otgAnyDistances)(OTG_ANY_PLANE plane, OTG_VEC3 origin, const OTG_VEC3* p, REAL tiny,
                                           REAL* s) {
  const OTG_VEC3 u = OTG_NAME(otgSub)(p[0], origin), v = OTG_NAME(otgSub)(p[1], origin);
  const OTG_VEC3 w = OTG_NAME(otgSub)(p[2], origin);
  const REAL reach = OTG_MAX(OTG_MAX(OTG_NAME(otgNorm1)(u), OTG_NAME(otgNorm1)(v)), OTG_NAME(otgNorm1)(w));
  s[0] = OTG_NAME(otgDot)(plane.normal, u);
  s[1] = OTG_NAME(otgDot)(plane.normal, v);
  s[2] = OTG_NAME(otgDot)(plane.normal, w);
  return plane.error * reach + tiny;
}

/// 1: all on one side for certain. 2: each on one of the two, by more than twice the error.
OTG_GENERIC int OTG_NAME(otgAnySides)(const REAL* s, REAL error) {
  const REAL two = error + error;
  const int above = (s[0] > error) & (s[1] > error) & (s[2] > error);
  const int below = (s[0] < -error) & (s[1] < -error) & (s[2] < -error);
  const REAL far0 = OTG_ABS(s[0]), far1 = OTG_ABS(s[1]), far2 = OTG_ABS(s[2]);
  const int clear = (far0 > two) & (far1 > two) & (far2 > two);
  return (above | below) | clear << 1;
}

/// The side from p to q, with distances sp and sq, if it crosses the plane.
OTG_GENERIC OTG_ANY_INTERVAL OTG_NAME(otgAnyCross)(OTG_ANY_INTERVAL i, OTG_VEC3 p, OTG_VEC3 q, REAL sp, REAL sq,
                                                   OTG_VEC3 line, REAL unit, REAL error) {
  const int have = ((sp > 0) & (sq < 0)) | ((sp < 0) & (sq > 0));
  const OTG_VEC3 side = OTG_NAME(otgSub)(q, p);
  const OTG_VEC3 x = OTG_NAME(otgAdd)(p, OTG_NAME(otgScale)(side, sp / (sp - sq)));
  const REAL c = OTG_NAME(otgDot)(x, line);
  const REAL off = OTG_NAME(otgNorm1)(side) * (OTG_REAL(4) * error / OTG_ABS(sp - sq) + unit) +
                   unit * (OTG_NAME(otgNorm1)(x) + OTG_NAME(otgNorm1)(p));
  const int lower = have & (c < i.low), higher = have & (c > i.high);
  const int worse = have & !(off <= i.error);  // one that is no number stays
  i.low = lower ? c : i.low;
  i.atLow = OTG_NAME(otgPick)(lower, x, i.atLow);
  i.high = higher ? c : i.high;
  i.atHigh = OTG_NAME(otgPick)(higher, x, i.atHigh);
  i.error = worse ? off : i.error;
  return i;
}

OTG_GENERIC OTG_ANY_INTERVAL OTG_NAME(otgAnyInterval)(const OTG_VEC3* p, const REAL* s, OTG_VEC3 line, REAL unit,
                                                      REAL error) {
  OTG_ANY_INTERVAL i;
  i.low = OTG_REAL(INFINITY);
  i.high = -OTG_REAL(INFINITY);
  i.error = 0;
  i.atLow = i.atHigh = p[0];
  i = OTG_NAME(otgAnyCross)(i, p[0], p[1], s[0], s[1], line, unit, error);
  i = OTG_NAME(otgAnyCross)(i, p[1], p[2], s[1], s[2], line, unit, error);
  return OTG_NAME(otgAnyCross)(i, p[2], p[0], s[2], s[0], line, unit, error);
}

/// Corners in one frame. `unit`: 32 units of roundoff; `tiny`: far more than underflow can add.
OTG_GENERIC OTG_ANY_CONTACT OTG_NAME(otgContactOfAny)(const OTG_VEC3* a, const OTG_VEC3* b, REAL unit, REAL tiny) {
  const OTG_ANY_PLANE ofA = OTG_NAME(otgAnyPlane)(a, unit, tiny), ofB = OTG_NAME(otgAnyPlane)(b, unit, tiny);
  const OTG_VEC3 na = ofA.normal, nb = ofB.normal, across = OTG_NAME(otgCross)(na, nb);
  REAL sa[3], sb[3];
  const REAL errorA = OTG_NAME(otgAnyDistances)(ofB, b[0], a, tiny, sa);
  const REAL errorB = OTG_NAME(otgAnyDistances)(ofA, a[0], b, tiny, sb);
  const REAL moveA = -OTG_MIN(OTG_MIN(sa[0], sa[1]), sa[2]), moveB = -OTG_MIN(OTG_MIN(sb[0], sb[1]), sb[2]);
  const REAL sine = OTG_SQRT(OTG_NAME(otgDot)(across, across));
  const OTG_VEC3 line = OTG_NAME(otgVec)(across.x / sine, across.y / sine, across.z / sine);
  const OTG_ANY_INTERVAL ia = OTG_NAME(otgAnyInterval)(a, sa, line, unit, errorA);
  const OTG_ANY_INTERVAL ib = OTG_NAME(otgAnyInterval)(b, sb, line, unit, errorB);
  const REAL apart = OTG_MIN(ia.high - ib.low, ib.high - ia.low), bound = ia.error + ib.error;
  const int sidesA = OTG_NAME(otgAnySides)(sa, errorA), sidesB = OTG_NAME(otgAnySides)(sb, errorB);
  const int sure = (sidesA & sidesB) >> 1 & (sine >= OTG_REAL(1e-6)), byB = moveA <= moveB;
  const int disjoint = ((sidesA | sidesB) & 1) | (sure & (apart < -bound)), meet = sure & (apart > bound);
  OTG_ANY_CONTACT any;
  any.answer = disjoint ? OTG_DISJOINT : meet ? OTG_INTERSECTING : OTG_UNDECIDED;
  any.contact.normal = OTG_NAME(otgPick)(byB, nb, OTG_NAME(otgVec)(-na.x, -na.y, -na.z));
  any.contact.depth = byB ? OTG_MAX(moveA, OTG_REAL(0)) : OTG_MAX(moveB, OTG_REAL(0));
  any.contact.kind = apart < any.contact.depth ? OTG_CONTACT_NONE : byB ? OTG_CONTACT_FACE_B : OTG_CONTACT_FACE_A;
  any.contact.position =
      OTG_NAME(otgScale)(OTG_NAME(otgAdd)(OTG_NAME(otgPick)(ia.low > ib.low, ia.atLow, ib.atLow),
                                          OTG_NAME(otgPick)(ia.high < ib.high, ia.atHigh, ib.atHigh)),
                         OTG_REAL(0.5));
  return any;
}

#undef OTG_ANY_PLANE
#undef OTG_ANY_INTERVAL
#undef OTG_ANY_CONTACT
#ifndef __OPENCL_VERSION__
}  // namespace otg
#endif
#include "shared/math/generic_end.h"
#endif
