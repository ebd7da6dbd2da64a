// SPDX-License-Identifier: BSD-3-Clause
// Exact sums and products of doubles as expansions: sums of non-overlapping doubles of increasing magnitude whose last
// term has the sign of the whole. Needs IEEE double arithmetic with round to nearest and no contraction. Exact where
// all coordinates are otgIsExactCoordinate(): then nothing overflows or underflows.
//
// Source of the method: J. R. Shewchuk, "Adaptive Precision Floating-Point Arithmetic and Fast Robust Geometric
// Predicates", Discrete & Computational Geometry 18 (1997); products split by fma instead of by Dekker's constant.
#ifndef OTG_SHARED_EXPANSION_H
#define OTG_SHARED_EXPANSION_H
#include "shared/math/platform.h"

#ifndef __OPENCL_VERSION__
namespace otg {
#define OTG_FMA(a, b, c) std::fma(a, b, c)
#else
#define OTG_FMA(a, b, c) fma(a, b, c)
#endif

#define OTG_EXACT_LEAST 1e-90
#define OTG_EXACT_MOST 1e90

/// A bound on coordinates, not on their differences: 1 - 1e-160 has a part that is as small as what was taken away.
/// Within it coordinates have bits from 2^299 down to 2^-351, and products of three differences from 2^903 to 2^-1053.
OTG_INLINE int otgIsExactCoordinate(double x) {
  return x == 0.0 || (fabs(x) >= OTG_EXACT_LEAST && fabs(x) <= OTG_EXACT_MOST);
}

/// *x + *y == a + b exactly, *x the rounded sum.
OTG_INLINE void otgTwoSum(double a, double b, double* x, double* y) {
  double s = a + b;
  double bv = s - a;
  double av = s - bv;
  *y = (a - av) + (b - bv);
  *x = s;
}

/// The same when |a| >= |b|.
OTG_INLINE void otgFastTwoSum(double a, double b, double* x, double* y) {
  double s = a + b;
  *y = b - (s - a);
  *x = s;
}

/// *x + *y == a * b exactly.
OTG_INLINE void otgTwoProduct(double a, double b, double* x, double* y) {
  double p = a * b;
  *y = OTG_FMA(a, b, -p);
  *x = p;
}

/// h = e + f without zero terms; h holds up to ne + nf terms and must not overlap its inputs. Returns the number of
/// terms (at least 1; a single 0 for zero).
OTG_INLINE int otgExpansionSum(int ne, const double* e, int nf, const double* f, double* h) {
  double q, hh;
  int i = 0, j = 0, n = 0;
  // Merge by increasing magnitude.
  if ((f[0] > e[0]) == (f[0] > -e[0])) {
    q = e[i++];
  } else {
    q = f[j++];
  }
  while (i < ne || j < nf) {
    double next;
    if (j >= nf || (i < ne && ((f[j] > e[i]) == (f[j] > -e[i])))) {
      next = e[i++];
    } else {
      next = f[j++];
    }
    otgTwoSum(q, next, &q, &hh);
    if (hh != 0.0) h[n++] = hh;
  }
  if (q != 0.0 || n == 0) h[n++] = q;
  return n;
}

/// h = e * b without zero terms; h holds up to 2 ne terms.
OTG_INLINE int otgExpansionScale(int ne, const double* e, double b, double* h) {
  double q, hh, p1, p0, s;
  int n = 0;
  otgTwoProduct(e[0], b, &q, &hh);
  if (hh != 0.0) h[n++] = hh;
  for (int i = 1; i < ne; ++i) {
    otgTwoProduct(e[i], b, &p1, &p0);
    otgTwoSum(q, p0, &s, &hh);
    if (hh != 0.0) h[n++] = hh;
    otgFastTwoSum(p1, s, &q, &hh);
    if (hh != 0.0) h[n++] = hh;
  }
  if (q != 0.0 || n == 0) h[n++] = q;
  return n;
}

/// Terms of a - b: one when the difference is exact, else two.
OTG_INLINE int otgExactDifference(double a, double b, double* h) {
  double x, y;
  otgTwoSum(a, -b, &x, &y);
  if (y == 0.0) {
    h[0] = x;
    return 1;
  }
  h[0] = y;
  h[1] = x;
  return 2;
}

/// h = e * f for a factor f of one or two terms; h holds up to 2 ne nf terms (ne at most 16).
OTG_INLINE int otgExpansionTimes(int ne, const double* e, int nf, const double* f, double* h) {
  double low[32], high[32];
  int nl, nh;
  if (nf == 1) return otgExpansionScale(ne, e, f[0], h);
  nl = otgExpansionScale(ne, e, f[0], low);
  nh = otgExpansionScale(ne, e, f[1], high);
  return otgExpansionSum(nl, low, nh, high, h);
}

/// h = a d - b c for factors of one or two terms each; h holds up to 16 terms.
OTG_INLINE int otgExpansionMinor(int na, const double* a, int nd, const double* d, int nb, const double* b, int nc,
                                 const double* c, double* h) {
  double ad[8], bc[8];
  int nad = otgExpansionTimes(na, a, nd, d, ad);
  int nbc = otgExpansionTimes(nb, b, nc, c, bc);
  for (int i = 0; i < nbc; ++i) bc[i] = -bc[i];
  return otgExpansionSum(nad, ad, nbc, bc, h);
}

OTG_INLINE int otgSignOf(double x) {
  return (x > 0.0) - (x < 0.0);
}

/// Exact sign of the determinant with rows a - d, b - d, c - d: positive when a lies on the side of the plane through
/// d, b, c to which (b - d) x (c - d) points. Arrays are x, y, z.
OTG_INLINE int otgExactOrient3(const double* a, const double* b, const double* c, const double* d) {
  double ra[3][2], rb[3][2], rc[3][2];
  int na[3], nb[3], nc[3];
  double minor[16], t0[64], t1[64], t2[64], s[128], total[192];
  int nm, n0, n1, n2, ns, nt;
  for (int k = 0; k < 3; ++k) {
    na[k] = otgExactDifference(a[k], d[k], ra[k]);
    nb[k] = otgExactDifference(b[k], d[k], rb[k]);
    nc[k] = otgExactDifference(c[k], d[k], rc[k]);
  }
  nm = otgExpansionMinor(nb[1], rb[1], nc[2], rc[2], nb[2], rb[2], nc[1], rc[1], minor);
  n0 = otgExpansionTimes(nm, minor, na[0], ra[0], t0);
  nm = otgExpansionMinor(nb[2], rb[2], nc[0], rc[0], nb[0], rb[0], nc[2], rc[2], minor);
  n1 = otgExpansionTimes(nm, minor, na[1], ra[1], t1);
  nm = otgExpansionMinor(nb[0], rb[0], nc[1], rc[1], nb[1], rb[1], nc[0], rc[0], minor);
  n2 = otgExpansionTimes(nm, minor, na[2], ra[2], t2);
  ns = otgExpansionSum(n0, t0, n1, t1, s);
  nt = otgExpansionSum(ns, s, n2, t2, total);
  return otgSignOf(total[nt - 1]);
}

/// Exact sign of (a1 - a0) (d1 - d0) - (b1 - b0) (c1 - c0).
OTG_INLINE int otgExactMinor(double a1, double a0, double d1, double d0, double b1, double b0, double c1, double c0) {
  double a[2], b[2], c[2], d[2], h[16];
  int na = otgExactDifference(a1, a0, a);
  int nb = otgExactDifference(b1, b0, b);
  int nc = otgExactDifference(c1, c0, c);
  int nd = otgExactDifference(d1, d0, d);
  int n = otgExpansionMinor(na, a, nd, d, nb, b, nc, c, h);
  return otgSignOf(h[n - 1]);
}

#ifndef __OPENCL_VERSION__
}  // namespace otg
#endif
#endif  // OTG_SHARED_EXPANSION_H
