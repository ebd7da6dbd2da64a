// SPDX-License-Identifier: BSD-3-Clause
// The exact decision whether two closed triangles meet: what the filter of triangle_test.h falls back to. Corners are
// doubles and taken as exact.
#ifndef OTG_SHARED_TRIANGLE_EXACT_H
#define OTG_SHARED_TRIANGLE_EXACT_H
#include "shared/math/exact_sum.h"
#include "shared/math/expansion.h"
#include "shared/math/product_sum.h"

#ifndef __OPENCL_VERSION__
namespace otg {
#define OTG_EXACT_ORIENT3 otgHostOrient3
#define OTG_EXACT_MINOR otgHostMinor

/// As otgExactOrient3, for any doubles.
inline int otgHostOrient3(const double* a, const double* b, const double* c, const double* d) {
  int fits = 1;
  for (int k = 0; k < 3; ++k) {
    fits &= otgIsExactCoordinate(a[k]) & otgIsExactCoordinate(b[k]) & otgIsExactCoordinate(c[k]) &
            otgIsExactCoordinate(d[k]);
  }
  return fits ? otgExactOrient3(a, b, c, d) : otgOrient3OfAnySize(a, b, c, d);
}

/// As otgExactMinor, for any doubles.
inline int otgHostMinor(double a1, double a0, double d1, double d0, double b1, double b0, double c1, double c0) {
  int fits = 1;
  for (const double x : {a1, a0, d1, d0, b1, b0, c1, c0}) fits &= otgIsExactCoordinate(x);
  return fits ? otgExactMinor(a1, a0, d1, d0, b1, b0, c1, c0) : otgMinorOfAnySize(a1, a0, d1, d0, b1, b0, c1, c0);
}
#else
// The caller has looked at otgIsExactCoordinate.
#define OTG_EXACT_ORIENT3 otgSumOrient3
#define OTG_EXACT_MINOR otgSumMinor
#endif

/// More than what underflow can add to a determinant of coordinates up to the largest float: about 1e-285.
#define OTG_TINY_DETERMINANT 1e-280

/// Sign of det[b - a, c - a, d - a], or 0 where double arithmetic cannot decide.
OTG_INLINE int otgOrient3Filter(const double* a, const double* b, const double* c, const double* d) {
  double ux = b[0] - a[0], uy = b[1] - a[1], uz = b[2] - a[2];
  double vx = c[0] - a[0], vy = c[1] - a[1], vz = c[2] - a[2];
  double wx = d[0] - a[0], wy = d[1] - a[1], wz = d[2] - a[2];
  double uyvz = uy * vz, uzvy = uz * vy, uzvx = uz * vx, uxvz = ux * vz, uxvy = ux * vy, uyvx = uy * vx;
  double det = wx * (uyvz - uzvy) + wy * (uzvx - uxvz) + wz * (uxvy - uyvx);
  double permanent = fabs(wx) * (fabs(uyvz) + fabs(uzvy)) + fabs(wy) * (fabs(uzvx) + fabs(uxvz)) +
                     fabs(wz) * (fabs(uxvy) + fabs(uyvx));
  // (7 + 56 u) u of Shewchuk 1997, rounded up.
  double bound = 8.0e-16 * permanent + OTG_TINY_DETERMINANT;
  return det > bound ? 1 : det < -bound ? -1 : 0;
}

/// The same, exact where the filter cannot decide.
OTG_INLINE int otgOrient3(const double* a, const double* b, const double* c, const double* d) {
  int s = otgOrient3Filter(a, b, c, d);
  // Rows (b - a), (c - a), (d - a) are an even permutation of the rows d - a, b - a, c - a.
  return s != 0 ? s : OTG_EXACT_ORIENT3(d, b, c, a);
}

/// Sign of otgOrient2, or 0 where double arithmetic cannot decide.
OTG_INLINE int otgOrient2Filter(const double* a, const double* b, const double* c, int i, int j) {
  double l = (a[i] - c[i]) * (b[j] - c[j]), r = (a[j] - c[j]) * (b[i] - c[i]);
  double det = l - r, bound = 4.0e-16 * (fabs(l) + fabs(r)) + OTG_TINY_DETERMINANT;
  return det > bound ? 1 : det < -bound ? -1 : 0;
}

/// The same as otgOrient3 in two dimensions, coordinates i and j of each point: positive when a, b, c turn
/// counter-clockwise.
OTG_INLINE int otgOrient2(const double* a, const double* b, const double* c, int i, int j) {
  int s = otgOrient2Filter(a, b, c, i, j);
  return s != 0 ? s : OTG_EXACT_MINOR(a[i], c[i], b[j], c[j], a[j], c[j], b[i], c[i]);
}

/// Is p in the closed triangle t (coordinates i, j)? Either turn of t.
OTG_INLINE int otgPointInTriangle2(const double* p, const double* t, int i, int j) {
  int s0 = otgOrient2(t, t + 3, p, i, j);
  int s1 = otgOrient2(t + 3, t + 6, p, i, j);
  int s2 = otgOrient2(t + 6, t, p, i, j);
  return (s0 >= 0 && s1 >= 0 && s2 >= 0) || (s0 <= 0 && s1 <= 0 && s2 <= 0);
}

/// Do the closed segments pq and rs meet properly or touch at an inner point? Shared end points and collinear overlap
/// are found by the point-in-triangle tests of the caller.
OTG_INLINE int otgSegmentsCross2(const double* p, const double* q, const double* r, const double* s, int i, int j) {
  int a = otgOrient2(p, q, r, i, j) * otgOrient2(p, q, s, i, j);
  if (a > 0) return 0;
  int b = otgOrient2(r, s, p, i, j) * otgOrient2(r, s, q, i, j);
  if (b > 0) return 0;
  return a < 0 || b < 0;
}

/// Two triangles in one plane. Projects along the axis on which the normal of the larger of them is largest.
OTG_INLINE int otgCoplanarTrianglesMeet(const double* a, const double* b) {
  double best = -1.0;
  int axis = 0;
  for (int k = 0; k < 3; ++k) {
    int i = (k + 1) % 3, j = (k + 2) % 3;
    double na = fabs((a[3 + i] - a[i]) * (a[6 + j] - a[j]) - (a[3 + j] - a[j]) * (a[6 + i] - a[i]));
    double nb = fabs((b[3 + i] - b[i]) * (b[6 + j] - b[j]) - (b[3 + j] - b[j]) * (b[6 + i] - b[i]));
    double n = na > nb ? na : nb;
    if (n > best) {
      best = n;
      axis = k;
    }
  }
  const int i = (axis + 1) % 3, j = (axis + 2) % 3;
  for (int k = 0; k < 3; ++k) {
    if (otgPointInTriangle2(a + 3 * k, b, i, j) || otgPointInTriangle2(b + 3 * k, a, i, j)) return 1;
  }
  for (int k = 0; k < 3; ++k) {
    for (int l = 0; l < 3; ++l) {
      if (otgSegmentsCross2(a + 3 * k, a + 3 * ((k + 1) % 3), b + 3 * l, b + 3 * ((l + 1) % 3), i, j)) return 1;
    }
  }
  return 0;
}

/// Does an edge of `s`, with its corners' sides of the plane of `t` given, meet the closed triangle `t`? Edges that lie
/// in the plane may be passed over when `s` itself does not: wherever such an edge meets t, so does another edge of s
/// at its end, or an edge of t meets s.
OTG_INLINE int otgEdgesMeetTriangle(const double* s, const int* side, const double* t) {
  for (int k = 0; k < 3; ++k) {
    const double *p = s + 3 * k, *q = s + 3 * ((k + 1) % 3);
    int sp = side[k], sq = side[(k + 1) % 3], o0, o1, o2;
    if (sp * sq > 0 || (sp == 0 && sq == 0)) continue;
    o0 = otgOrient3(p, q, t, t + 3);
    o1 = otgOrient3(p, q, t + 3, t + 6);
    if (o0 * o1 < 0) continue;
    o2 = otgOrient3(p, q, t + 6, t);
    if (o0 * o2 < 0 || o1 * o2 < 0) continue;
    return 1;
  }
  return 0;
}

/// Are the three corners on one line? Exact.
OTG_INLINE int otgIsWithoutArea(const double* t) {
  // All filters first: a triangle with area may well lie along an axis.
  OTG_EXACT_ROLLED
  for (int k = 0; k < 3; ++k) {
    if (otgOrient2Filter(t, t + 3, t + 6, k, (k + 1) % 3) != 0) return 0;
  }
  OTG_EXACT_ROLLED
  for (int k = 0; k < 3; ++k) {
    if (otgOrient2(t, t + 3, t + 6, k, (k + 1) % 3) != 0) return 0;
  }
  return 1;
}

/// 1 when the closed triangles a and b (nine doubles each: x, y, z of three corners) have a point in common, else 0.
/// Exact, on devices for coordinates that are otgIsExactCoordinate(); neither triangle may be a point or a segment.
OTG_INLINE int otgTrianglesMeetExact(const double* a, const double* b) {
  int sa[3], sb[3];
  for (int k = 0; k < 3; ++k) sa[k] = otgOrient3(b, b + 3, b + 6, a + 3 * k);
  if ((sa[0] > 0 && sa[1] > 0 && sa[2] > 0) || (sa[0] < 0 && sa[1] < 0 && sa[2] < 0)) return 0;
  if (sa[0] == 0 && sa[1] == 0 && sa[2] == 0) return otgCoplanarTrianglesMeet(a, b);
  for (int k = 0; k < 3; ++k) sb[k] = otgOrient3(a, a + 3, a + 6, b + 3 * k);
  if ((sb[0] > 0 && sb[1] > 0 && sb[2] > 0) || (sb[0] < 0 && sb[1] < 0 && sb[2] < 0)) return 0;
  return otgEdgesMeetTriangle(a, sa, b) || otgEdgesMeetTriangle(b, sb, a);
}

#ifndef __OPENCL_VERSION__
}  // namespace otg
#endif
#endif  // OTG_SHARED_TRIANGLE_EXACT_H
