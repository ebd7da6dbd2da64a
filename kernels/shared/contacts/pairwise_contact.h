// SPDX-License-Identifier: BSD-3-Clause
// The published contact of one intersecting pair of triangles: the smaller of the two moves of one triangle out along
// the other's normal gives depth and normal, a shared point the position; the contact is dropped if moving along the
// line in which the two planes meet separates the triangles sooner.
#if defined(OTG_REAL_DOUBLE) ? !defined(OTG_SHARED_PAIRWISE_CONTACT_D) : !defined(OTG_SHARED_PAIRWISE_CONTACT_F)
#ifdef OTG_REAL_DOUBLE
#define OTG_SHARED_PAIRWISE_CONTACT_D
#else
#define OTG_SHARED_PAIRWISE_CONTACT_F
#endif
#include "shared/math/corner_cross.h"
//
#include "shared/math/generic_begin.h"

#ifndef OTG_PAIR_CONTACT_KINDS
#define OTG_PAIR_CONTACT_KINDS
#ifdef __OPENCL_VERSION__
enum { OTG_CONTACT_NONE = 0, OTG_CONTACT_FACE_A = 1, OTG_CONTACT_FACE_B = 2, OTG_CONTACT_COPLANAR = 3 };
#else
namespace otg {
enum PairContactKind : int { OTG_CONTACT_NONE, OTG_CONTACT_FACE_A, OTG_CONTACT_FACE_B, OTG_CONTACT_COPLANAR };
}
#endif
#endif

#ifndef __OPENCL_VERSION__
namespace otg {
/// In the frame of the corners. `kind` says whose face gave the normal, or that there is no contact.
template <class REAL>
struct PairContact {
  Vec3<REAL> position, normal;  ///< moving A along the normal by `depth` takes it out
  REAL depth;
  int kind;
};
#define OTG_PAIR_CONTACT PairContact<REAL>
#else
#define OTG_PAIR_CONTACT OTG_NAME(otg_pair_contact)
typedef struct {
  OTG_VEC3 position, normal;
  REAL depth;
  int kind;
} OTG_PAIR_CONTACT;
#endif

/// Some vector at right angles to e, which is not zero.
OTG_GENERIC OTG_VEC3 OTG_NAME(otgAcross)(OTG_VEC3 e) {
  const REAL x = OTG_ABS(e.x), y = OTG_ABS(e.y), z = OTG_ABS(e.z);
  if (x <= y && x <= z) return OTG_NAME(otgVec)(OTG_REAL(0), -e.z, e.y);
  if (y <= z) return OTG_NAME(otgVec)(e.z, OTG_REAL(0), -e.x);
  return OTG_NAME(otgVec)(-e.y, e.x, OTG_REAL(0));
}

/// Unit normal (p1 - p0) x (p2 - p0). Where twice the digits do not give it, some unit vector at right angles to the
/// triangle's longer edge.
OTG_GENERIC OTG_VEC3 OTG_NAME(otgUnitNormal)(const OTG_VEC3* p) {
  OTG_VEC3 n = OTG_NAME(otgCornerCross)(p[0], p[1], p[2]);
  // Scaled first, so that small triangles do not underflow in float.
  REAL m = OTG_NAME(otgLargestPart)(n), l;
  if (!(m > 0)) {
    const OTG_VEC3 e = OTG_NAME(otgSub)(p[1], p[0]), f = OTG_NAME(otgSub)(p[2], p[0]);
    n = OTG_NAME(otgAcross)(OTG_NAME(otgLargestPart)(e) < OTG_NAME(otgLargestPart)(f) ? f : e);
    m = OTG_NAME(otgLargestPart)(n);
  }
  n = OTG_NAME(otgVec)(n.x / m, n.y / m, n.z / m);
  l = OTG_SQRT(OTG_NAME(otgDot)(n, n));
  return OTG_NAME(otgVec)(n.x / l, n.y / l, n.z / l);
}

/// Where a triangle meets a plane, as an interval on a line: `s` signed distances of its corners, `c` their coordinates
/// along the line. Writes the ends with their points.
OTG_GENERIC void OTG_NAME(otgPlaneInterval)(const OTG_VEC3* p, const REAL* s, OTG_VEC3 line, REAL* lo, REAL* hi,
                                            OTG_VEC3* atLo, OTG_VEC3* atHi) {
  int count = 0;
  OTG_VEC3 nearest = p[0];  // not its number: devices keep corners in registers only if all indices are constants
  REAL least = OTG_ABS(s[0]);
  for (int k = 0; k < 3; ++k) {
    int j = (k + 1) % 3, have = 0;
    OTG_VEC3 x = p[k];
    REAL c;
    if (OTG_ABS(s[k]) < least) {
      nearest = x;
      least = OTG_ABS(s[k]);
    }
    if (s[k] == 0) {
      have = 1;
    } else if ((s[k] > 0 && s[j] < 0) || (s[k] < 0 && s[j] > 0)) {
      x = OTG_NAME(otgAdd)(p[k], OTG_NAME(otgScale)(OTG_NAME(otgSub)(p[j], p[k]), s[k] / (s[k] - s[j])));
      have = 1;
    }
    if (!have) continue;
    c = OTG_NAME(otgDot)(x, line);
    if (count == 0 || c < *lo) {
      *lo = c;
      *atLo = x;
    }
    if (count == 0 || c > *hi) {
      *hi = c;
      *atHi = x;
    }
    ++count;
  }
  if (count == 0) {  // only rounding can do that to a triangle that meets the plane: its nearest corner touches
    *lo = *hi = OTG_NAME(otgDot)(nearest, line);
    *atLo = *atHi = nearest;
  }
}

/// Mean of the corners of the overlap of two triangles in (nearly) one plane: A clipped by the three sides of B.
OTG_GENERIC OTG_VEC3 OTG_NAME(otgCoplanarPoint)(const OTG_VEC3* a, const OTG_VEC3* cornersB, OTG_VEC3 normalB) {
  OTG_VEC3 poly[9], next[9], b[3], sum;  // `b`: a copy, so that the caller's corners can stay in registers
  int n = 3;
  for (int k = 0; k < 3; ++k) {
    poly[k] = a[k];
    b[k] = cornersB[k];
  }
  for (int side = 0; side < 3; ++side) {
    OTG_VEC3 inward = OTG_NAME(otgCross)(normalB, OTG_NAME(otgSub)(b[(side + 1) % 3], b[side]));
    int m = 0, best = 0;
    REAL most = 0;
    for (int k = 0; k < n; ++k) {
      OTG_VEC3 p = poly[k], q = poly[(k + 1) % n];
      REAL dp = OTG_NAME(otgDot)(inward, OTG_NAME(otgSub)(p, b[side]));
      REAL dq = OTG_NAME(otgDot)(inward, OTG_NAME(otgSub)(q, b[side]));
      if (k == 0 || dp > most) {
        most = dp;
        best = k;
      }
      if (dp >= 0) next[m++] = p;
      if ((dp > 0 && dq < 0) || (dp < 0 && dq > 0))
        next[m++] = OTG_NAME(otgAdd)(p, OTG_NAME(otgScale)(OTG_NAME(otgSub)(q, p), dp / (dp - dq)));
    }
    if (m == 0) next[m++] = poly[best];  // touching, lost to rounding: the corner that is least outside
    n = m;
    for (int k = 0; k < n; ++k) poly[k] = next[k];
  }
  sum = poly[0];
  for (int k = 1; k < n; ++k) sum = OTG_NAME(otgAdd)(sum, poly[k]);
  return OTG_NAME(otgVec)(sum.x / OTG_REAL(n), sum.y / OTG_REAL(n), sum.z / OTG_REAL(n));
}

/// The contact of a pair that is known to intersect. Corners in one frame, neither triangle without area.
OTG_GENERIC OTG_PAIR_CONTACT OTG_NAME(otgPairwiseContact)(const OTG_VEC3* a, const OTG_VEC3* b) {
  OTG_PAIR_CONTACT contact;
  OTG_VEC3 na = OTG_NAME(otgUnitNormal)(a), nb = OTG_NAME(otgUnitNormal)(b), line = OTG_NAME(otgCross)(na, nb);
  REAL sa[3], sb[3], moveA, moveB, sine;
  for (int k = 0; k < 3; ++k) {
    sa[k] = OTG_NAME(otgDot)(nb, OTG_NAME(otgSub)(a[k], b[0]));
    sb[k] = OTG_NAME(otgDot)(na, OTG_NAME(otgSub)(b[k], a[0]));
  }
  moveA = -OTG_MIN(OTG_MIN(sa[0], sa[1]), sa[2]);  // A along +nb
  moveB = -OTG_MIN(OTG_MIN(sb[0], sb[1]), sb[2]);  // B along +na, which is A along -na
  if (moveA <= moveB) {
    contact.kind = OTG_CONTACT_FACE_B;
    contact.normal = nb;
    contact.depth = OTG_MAX(moveA, OTG_REAL(0));
  } else {
    contact.kind = OTG_CONTACT_FACE_A;
    contact.normal = OTG_NAME(otgVec)(-na.x, -na.y, -na.z);
    contact.depth = OTG_MAX(moveB, OTG_REAL(0));
  }
  sine = OTG_SQRT(OTG_NAME(otgDot)(line, line));
  if (sine < OTG_REAL(1e-6)) {  // (nearly) one plane: there is no line along which to compare
    contact.kind = OTG_CONTACT_COPLANAR;
    contact.position = OTG_NAME(otgCoplanarPoint)(a, b, nb);
  } else {
    REAL loA = 0, hiA = 0, loB = 0, hiB = 0, apart;
    OTG_VEC3 atLoA = a[0], atHiA = a[0], atLoB = b[0], atHiB = b[0], from, to;
    line = OTG_NAME(otgVec)(line.x / sine, line.y / sine, line.z / sine);
    OTG_NAME(otgPlaneInterval)(a, sa, line, &loA, &hiA, &atLoA, &atHiA);
    OTG_NAME(otgPlaneInterval)(b, sb, line, &loB, &hiB, &atLoB, &atHiB);
    apart = OTG_MIN(hiA - loB, hiB - loA);
    if (apart < contact.depth) contact.kind = OTG_CONTACT_NONE;
    from = loA > loB ? atLoA : atLoB;
    to = hiA < hiB ? atHiA : atHiB;
    contact.position = OTG_NAME(otgScale)(OTG_NAME(otgAdd)(from, to), OTG_REAL(0.5));
  }
  return contact;
}

#undef OTG_PAIR_CONTACT
#ifndef __OPENCL_VERSION__
}  // namespace otg
#endif
#include "shared/math/generic_end.h"
#endif
