// SPDX-License-Identifier: BSD-3-Clause
// A point against boxes and triangles: nearest points, and whether rays from it meet them.
//
// What a search through a tree finds must not depend on the tree, or on the order in which it is gone through: boxes
// are taken for nearer than they are by more than the rounding of their test. A triangle counts by its own box as well,
// since its nearest point or crossing is worthless where it is a sliver. Every tree's boxes hold that box.
#if defined(OTG_REAL_DOUBLE) ? !defined(OTG_SHARED_POINT_TEST_D) : !defined(OTG_SHARED_POINT_TEST_F)
#ifdef OTG_REAL_DOUBLE
#define OTG_SHARED_POINT_TEST_D
#else
#define OTG_SHARED_POINT_TEST_F
#endif
#include "shared/math/vec3.h"
//
#include "shared/math/generic_begin.h"

#ifndef OTG_SHARED_POINT_TEST_PARTS
#define OTG_SHARED_POINT_TEST_PARTS
/// The part of a triangle that a point of it lies on: edge k runs from corner k to corner (k + 1) % 3.
#define OTG_PART_FACE 0
#define OTG_PART_EDGE 1    ///< + k
#define OTG_PART_CORNER 4  ///< + k
#endif

#ifndef __OPENCL_VERSION__
namespace otg {
#endif

// Nearest points ------------------------------------------------------------------------------------------------------

/// The nearest point of a triangle so thin that rounding has taken its normal; its longest edge is all of it.
OTG_GENERIC int OTG_NAME(otgNearestOnLongestEdge)(OTG_VEC3 a, OTG_VEC3 b, OTG_VEC3 c, OTG_VEC3 p, OTG_VEC3* on) {
  OTG_VEC3 from = a, along = OTG_NAME(otgSub)(b, a);
  const OTG_VEC3 ca = OTG_NAME(otgSub)(a, c), bc = OTG_NAME(otgSub)(c, b);
  int part = OTG_PART_EDGE;
  REAL square = OTG_NAME(otgDot)(along, along), t;
  if (OTG_NAME(otgDot)(bc, bc) > square) {
    from = b;
    along = bc;
    part = OTG_PART_EDGE + 1;
    square = OTG_NAME(otgDot)(bc, bc);
  }
  if (OTG_NAME(otgDot)(ca, ca) > square) {
    from = c;
    along = ca;
    part = OTG_PART_EDGE + 2;
    square = OTG_NAME(otgDot)(ca, ca);
  }
  t = OTG_NAME(otgDot)(along, OTG_NAME(otgSub)(p, from));
  t = t > 0 ? OTG_MIN(t / square, OTG_REAL(1)) : OTG_REAL(0);
  *on = OTG_NAME(otgAdd)(from, OTG_NAME(otgScale)(along, t));
  return part;
}

/// The nearest point `on` of a triangle, and which part of it that is. Source: C. Ericson, Real-Time Collision
/// Detection (2005), 5.1.5.
OTG_GENERIC int OTG_NAME(otgNearestOnTriangle)(OTG_VEC3 a, OTG_VEC3 b, OTG_VEC3 c, OTG_VEC3 p, OTG_VEC3* on) {
  const OTG_VEC3 ab = OTG_NAME(otgSub)(b, a), ac = OTG_NAME(otgSub)(c, a), ap = OTG_NAME(otgSub)(p, a);
  const REAL d1 = OTG_NAME(otgDot)(ab, ap), d2 = OTG_NAME(otgDot)(ac, ap);
  if (d1 <= 0 && d2 <= 0) {
    *on = a;
    return OTG_PART_CORNER;
  }
  const OTG_VEC3 bp = OTG_NAME(otgSub)(p, b);
  const REAL d3 = OTG_NAME(otgDot)(ab, bp), d4 = OTG_NAME(otgDot)(ac, bp);
  if (d3 >= 0 && d4 <= d3) {
    *on = b;
    return OTG_PART_CORNER + 1;
  }
  const REAL vc = d1 * d4 - d3 * d2;
  if (vc <= 0 && d1 >= 0 && d3 <= 0) {
    *on = OTG_NAME(otgAdd)(a, OTG_NAME(otgScale)(ab, d1 > 0 ? d1 / (d1 - d3) : d1));
    return OTG_PART_EDGE;
  }
  const OTG_VEC3 cp = OTG_NAME(otgSub)(p, c);
  const REAL d5 = OTG_NAME(otgDot)(ab, cp), d6 = OTG_NAME(otgDot)(ac, cp);
  if (d6 >= 0 && d5 <= d6) {
    *on = c;
    return OTG_PART_CORNER + 2;
  }
  const REAL vb = d5 * d2 - d1 * d6;
  if (vb <= 0 && d2 >= 0 && d6 <= 0) {
    *on = OTG_NAME(otgAdd)(a, OTG_NAME(otgScale)(ac, d2 > 0 ? d2 / (d2 - d6) : d2));
    return OTG_PART_EDGE + 2;
  }
  const REAL va = d3 * d6 - d5 * d4;
  if (va <= 0 && d4 - d3 >= 0 && d5 - d6 >= 0) {
    const REAL along = (d4 - d3) + (d5 - d6), w = along > 0 ? (d4 - d3) / along : along;
    *on = OTG_NAME(otgAdd)(b, OTG_NAME(otgScale)(OTG_NAME(otgSub)(c, b), w));
    return OTG_PART_EDGE + 1;
  }
  // Inside: along the normal, which keeps the point in the plane where the barycentric form loses it by cancellation.
  const OTG_VEC3 n = OTG_NAME(otgCross)(ab, ac);
  const REAL nn = OTG_NAME(otgDot)(n, n);
  if (!(nn > 0)) return OTG_NAME(otgNearestOnLongestEdge)(a, b, c, p, on);
  *on = OTG_NAME(otgSub)(p, OTG_NAME(otgScale)(n, OTG_NAME(otgDot)(ap, n) / nn));
  return OTG_PART_FACE;
}

OTG_GENERIC REAL OTG_NAME(otgDistance)(OTG_VEC3 a, OTG_VEC3 b) {
  const OTG_VEC3 d = OTG_NAME(otgSub)(a, b);
  return OTG_SQRT(OTG_NAME(otgDot)(d, d));
}

OTG_GENERIC OTG_VEC3 OTG_NAME(otgLowest3)(OTG_VEC3 a, OTG_VEC3 b, OTG_VEC3 c) {
  return OTG_NAME(otgVec)(OTG_MIN(OTG_MIN(a.x, b.x), c.x), OTG_MIN(OTG_MIN(a.y, b.y), c.y),
                          OTG_MIN(OTG_MIN(a.z, b.z), c.z));
}
OTG_GENERIC OTG_VEC3 OTG_NAME(otgHighest3)(OTG_VEC3 a, OTG_VEC3 b, OTG_VEC3 c) {
  return OTG_NAME(otgVec)(OTG_MAX(OTG_MAX(a.x, b.x), c.x), OTG_MAX(OTG_MAX(a.y, b.y), c.y),
                          OTG_MAX(OTG_MAX(a.z, b.z), c.z));
}

/// How far a triangle counts as being from p whose nearest point is `distance` away: no less than its box is.
OTG_GENERIC REAL OTG_NAME(otgSearchDistance)(OTG_VEC3 a, OTG_VEC3 b, OTG_VEC3 c, OTG_VEC3 p, REAL distance) {
  const OTG_VEC3 lo = OTG_NAME(otgLowest3)(a, b, c), hi = OTG_NAME(otgHighest3)(a, b, c);
  const OTG_VEC3 d = OTG_NAME(otgVec)(OTG_MAX(OTG_MAX(lo.x - p.x, p.x - hi.x), OTG_REAL(0)),
                                      OTG_MAX(OTG_MAX(lo.y - p.y, p.y - hi.y), OTG_REAL(0)),
                                      OTG_MAX(OTG_MAX(lo.z - p.z, p.z - hi.z), OTG_REAL(0)));
  return OTG_MAX(distance, OTG_SQRT(OTG_NAME(otgDot)(d, d)));
}

/// By how much the distance of a point (centred frame) from a box below the root may be off, along each axis.
OTG_GENERIC REAL OTG_NAME(otgSearchSlack)(OTG_VEC3 p, OTG_VEC3 rootCenter, OTG_VEC3 rootExtent) {
  return OTG_REAL(0x1p-49) *
         (OTG_ABS(p.x) + OTG_ABS(p.y) + OTG_ABS(p.z) + OTG_ABS(rootCenter.x) + OTG_ABS(rootCenter.y) +
          OTG_ABS(rootCenter.z) + rootExtent.x + rootExtent.y + rootExtent.z);
}

/// The squared distance of a point (centred frame) from a node's box: no triangle in it has a search distance whose
/// square is less.
OTG_GENERIC REAL OTG_NAME(otgBoxDistance2)(OTG_VEC3 center, OTG_VEC3 extent, OTG_VEC3 p, REAL slack) {
  const OTG_VEC3 d = OTG_NAME(otgVec)(OTG_MAX(OTG_ABS(p.x - center.x) - extent.x - slack, OTG_REAL(0)),
                                      OTG_MAX(OTG_ABS(p.y - center.y) - extent.y - slack, OTG_REAL(0)),
                                      OTG_MAX(OTG_ABS(p.z - center.z) - extent.z - slack, OTG_REAL(0)));
  return OTG_NAME(otgDot)(d, d) * OTG_REAL(1 - 1e-14);
}

// Rays ----------------------------------------------------------------------------------------------------------------

/// Whether a ray meets a triangle: 0 if not, 1 from the front, 2 if the triangle faces along the ray; `at`: where, in
/// lengths of the direction d. Edges count as inside, by a hair more than rounding, so that a ray through an edge
/// cannot slip between two triangles. Source: Moeller and Trumbore, "Fast, Minimum Storage Ray/Triangle Intersection",
/// JGT 2(1), 1997.
OTG_GENERIC int OTG_NAME(otgRayMeetsTriangle)(OTG_VEC3 o, OTG_VEC3 d, OTG_VEC3 p0, OTG_VEC3 p1, OTG_VEC3 p2, REAL* at) {
  const REAL hair = OTG_REAL(1e-9);
  const OTG_VEC3 e1 = OTG_NAME(otgSub)(p1, p0), e2 = OTG_NAME(otgSub)(p2, p0);
  const OTG_VEC3 h = OTG_NAME(otgCross)(d, e2);
  const REAL det = OTG_NAME(otgDot)(e1, h);
  if (det == 0) return 0;
  const OTG_VEC3 s = OTG_NAME(otgSub)(o, p0);
  const REAL u = OTG_NAME(otgDot)(s, h) / det;
  const OTG_VEC3 q = OTG_NAME(otgCross)(s, e1);
  const REAL v = OTG_NAME(otgDot)(d, q) / det;
  if (u < -hair || v < -hair || u + v > 1 + hair) return 0;
  *at = OTG_NAME(otgDot)(e2, q) / det;
  // det = -(d . normal): negative when the triangle faces along the ray.
  return det < 0 ? 2 : 1;
}

/// How much wider a triangle's box may be for rays to count as passing it. Trees have to be searched with boxes that
/// are wider by twice as much. `from`: the ray's origin in the centred frame, `origin` that of this frame.
OTG_GENERIC REAL OTG_NAME(otgRayReach)(REAL radius, OTG_VEC3 from, OTG_VEC3 origin) {
  return OTG_REAL(1e-6) * radius + OTG_REAL(3e-14) * (OTG_ABS(from.x) + OTG_ABS(from.y) + OTG_ABS(from.z) +
                                                      OTG_ABS(origin.x) + OTG_ABS(origin.y) + OTG_ABS(origin.z));
}

/// One axis of a box: narrows the range of the ray. `inverse`: 1 / d. 0 if nothing is left.
OTG_GENERIC int OTG_NAME(otgRayMeetsRange)(REAL o, REAL d, REAL inverse, REAL lo, REAL hi, REAL* near, REAL* far) {
  REAL t0, t1;
  if (d == 0) return !(o < lo || o > hi);
  t0 = (lo - o) * inverse;
  t1 = (hi - o) * inverse;
  *near = OTG_MAX(*near, OTG_MIN(t0, t1));
  *far = OTG_MIN(*far, OTG_MAX(t0, t1));
  return !(*near > *far);
}

/// Whether a ray passes a box, lo to hi, at 0 or later; `near`: where it enters it, at the earliest 0.
OTG_GENERIC int OTG_NAME(otgRayEntersBox)(OTG_VEC3 o, OTG_VEC3 d, OTG_VEC3 inverse, OTG_VEC3 lo, OTG_VEC3 hi,
                                          REAL* near) {
  REAL far = OTG_REAL(INFINITY);
  *near = 0;
  return OTG_NAME(otgRayMeetsRange)(o.x, d.x, inverse.x, lo.x, hi.x, near, &far) &&
         OTG_NAME(otgRayMeetsRange)(o.y, d.y, inverse.y, lo.y, hi.y, near, &far) &&
         OTG_NAME(otgRayMeetsRange)(o.z, d.z, inverse.z, lo.z, hi.z, near, &far);
}

OTG_GENERIC int OTG_NAME(otgRayPassesBox)(OTG_VEC3 o, OTG_VEC3 d, OTG_VEC3 inverse, OTG_VEC3 lo, OTG_VEC3 hi) {
  REAL near;
  return OTG_NAME(otgRayEntersBox)(o, d, inverse, lo, hi, &near);
}

/// The same for the box of a triangle made wider by `reach`.
OTG_GENERIC int OTG_NAME(otgRayPassesTriangleBox)(OTG_VEC3 o, OTG_VEC3 d, OTG_VEC3 inverse, OTG_VEC3 a, OTG_VEC3 b,
                                                  OTG_VEC3 c, REAL reach) {
  const OTG_VEC3 wider = OTG_NAME(otgVec)(reach, reach, reach);
  return OTG_NAME(otgRayPassesBox)(o, d, inverse, OTG_NAME(otgSub)(OTG_NAME(otgLowest3)(a, b, c), wider),
                                   OTG_NAME(otgAdd)(OTG_NAME(otgHighest3)(a, b, c), wider));
}

/// A ray's direction as tests of boxes have it. Parts so small that no ray gets through a mesh's reach along them are
/// 0: with their inverses, times would be infinite.
OTG_GENERIC OTG_VEC3 OTG_NAME(otgRayAlong)(OTG_VEC3 d) {
  const REAL least = OTG_REAL(1e-30);
  return OTG_NAME(otgVec)(OTG_ABS(d.x) < least ? 0 : d.x, OTG_ABS(d.y) < least ? 0 : d.y,
                          OTG_ABS(d.z) < least ? 0 : d.z);
}

/// Whether a triangle counts as hit, by itself: 0 if not, 1 from the front, 2 from behind. `at`: where, in lengths of
/// the direction; no earlier than where the ray enters the triangle's box, wider by `reach` (otgRayReach). So a search
/// that passes over boxes that begin later than a hit passes over no triangle that counts as nearer. `along` and
/// `inverse`: otgRayAlong of d, and 1 / its parts.
OTG_GENERIC int OTG_NAME(otgRayHitsTriangle)(OTG_VEC3 o, OTG_VEC3 d, OTG_VEC3 along, OTG_VEC3 inverse, OTG_VEC3 a,
                                             OTG_VEC3 b, OTG_VEC3 c, REAL reach, REAL* at) {
  const OTG_VEC3 wider = OTG_NAME(otgVec)(reach, reach, reach);
  REAL near;
  const int meets = OTG_NAME(otgRayMeetsTriangle)(o, d, a, b, c, at);
  if (meets == 0 || !(*at >= 0) ||
      !OTG_NAME(otgRayEntersBox)(o, along, inverse, OTG_NAME(otgSub)(OTG_NAME(otgLowest3)(a, b, c), wider),
                                 OTG_NAME(otgAdd)(OTG_NAME(otgHighest3)(a, b, c), wider), &near)) {
    return 0;
  }
  *at = OTG_MAX(*at, near);
  return *at < OTG_REAL(INFINITY) ? meets : 0;
}

/// Unit vectors of the rays whose crossings separate inside from outside. No rational directions: rays along axes run
/// through edges and vertices of real meshes.
OTG_GENERIC OTG_VEC3 OTG_NAME(otgParityDirection)(int k) {
  return k == 0   ? OTG_NAME(otgVec)(OTG_REAL(0.5391643), OTG_REAL(0.6713921), OTG_REAL(0.5083117))
         : k == 1 ? OTG_NAME(otgVec)(OTG_REAL(-0.7231847), OTG_REAL(0.2790419), OTG_REAL(0.6317723))
                  : OTG_NAME(otgVec)(OTG_REAL(0.1874319), OTG_REAL(-0.8310647), OTG_REAL(0.5236533));
}

#ifndef __OPENCL_VERSION__
}  // namespace otg
#endif
#include "shared/math/generic_end.h"
#endif
