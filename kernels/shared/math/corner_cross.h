// SPDX-License-Identifier: BSD-3-Clause
// The cross product of two edges of a triangle, for triangles of any shape.
#if defined(OTG_REAL_DOUBLE) ? !defined(OTG_SHARED_CORNER_CROSS_D) : !defined(OTG_SHARED_CORNER_CROSS_F)
#ifdef OTG_REAL_DOUBLE
#define OTG_SHARED_CORNER_CROSS_D
#else
#define OTG_SHARED_CORNER_CROSS_F
#endif
#include "shared/math/expansion.h"
#include "shared/math/vec3.h"
//
#include "shared/math/generic_begin.h"

#ifndef __OPENCL_VERSION__
namespace otg {
#endif

OTG_GENERIC REAL OTG_NAME(otgLargestPart)(OTG_VEC3 v) {
  return OTG_MAX(OTG_MAX(OTG_ABS(v.x), OTG_ABS(v.y)), OTG_ABS(v.z));
}

/// What rounding took from b - a, of which d is the rounded value.
OTG_GENERIC REAL OTG_NAME(otgLostBy)(REAL b, REAL a, REAL d) {
  const REAL back = d - b;
  return (b - (d - back)) - (a + back);
}

/// x y - z w for factors with their lost parts, to twice the digits of the products.
OTG_GENERIC REAL OTG_NAME(otgMinorOf)(REAL x, REAL xLost, REAL y, REAL yLost, REAL z, REAL zLost, REAL w, REAL wLost) {
  const REAL p = x * y, q = z * w, d = p - q;
  const REAL pLost = OTG_FMA(x, y, -p), qLost = OTG_FMA(z, w, -q);
  return d + (OTG_NAME(otgLostBy)(p, q, d) + ((pLost - qLost) + ((x * yLost + xLost * y) - (z * wLost + zLost * w))));
}

/// (b - a) x (c - a). Where products of edges cancel, they are taken to twice their digits.
OTG_GENERIC OTG_VEC3 OTG_NAME(otgCornerCross)(OTG_VEC3 a, OTG_VEC3 b, OTG_VEC3 c) {
  const OTG_VEC3 e = OTG_NAME(otgSub)(b, a), f = OTG_NAME(otgSub)(c, a), n = OTG_NAME(otgCross)(e, f);
  OTG_VEC3 s, t;
  if (OTG_NAME(otgLargestPart)(n) > OTG_REAL(1e-6) * OTG_NAME(otgLargestPart)(e) * OTG_NAME(otgLargestPart)(f)) {
    return n;
  }
  s = OTG_NAME(otgVec)(OTG_NAME(otgLostBy)(b.x, a.x, e.x), OTG_NAME(otgLostBy)(b.y, a.y, e.y),
                       OTG_NAME(otgLostBy)(b.z, a.z, e.z));
  t = OTG_NAME(otgVec)(OTG_NAME(otgLostBy)(c.x, a.x, f.x), OTG_NAME(otgLostBy)(c.y, a.y, f.y),
                       OTG_NAME(otgLostBy)(c.z, a.z, f.z));
  return OTG_NAME(otgVec)(OTG_NAME(otgMinorOf)(e.y, s.y, f.z, t.z, e.z, s.z, f.y, t.y),
                          OTG_NAME(otgMinorOf)(e.z, s.z, f.x, t.x, e.x, s.x, f.z, t.z),
                          OTG_NAME(otgMinorOf)(e.x, s.x, f.y, t.y, e.y, s.y, f.x, t.x));
}

#ifndef __OPENCL_VERSION__
}  // namespace otg
#endif
#include "shared/math/generic_end.h"
#endif
