// SPDX-License-Identifier: BSD-3-Clause
// The same signs as expansion.h, in an eighth of its memory: products are added to one expansion term by term. For
// devices, where every work-item has its own memory for them; the CPU, which has it to spare, is quicker with
// expansions of fixed lengths.
//
// Exact where all coordinates are otgIsExactCoordinate().
//
// Source of the method: J. R. Shewchuk, "Adaptive Precision Floating-Point Arithmetic and Fast Robust Geometric
// Predicates", Discrete & Computational Geometry 18 (1997): GROW-EXPANSION and COMPRESS.
#ifndef OTG_SHARED_EXACT_SUM_H
#define OTG_SHARED_EXACT_SUM_H
#include "shared/math/expansion.h"

#ifndef __OPENCL_VERSION__
namespace otg {
#define OTG_EXACT_ROLLED
#else
#define OTG_EXACT_ROLLED _Pragma("unroll 1")  // they are inlined in many places
#endif

/// A compressed expansion has a term for every 53 bits at most. Products of three differences have bits from 2^903 down
/// to 2^-1053 (otgIsExactCoordinate), so 37 terms are enough, and one more while a term is added.
#define OTG_EXACT_TERMS 40

/// Terms that do not overlap, by increasing magnitude.
typedef struct {
  double term[OTG_EXACT_TERMS];
  int count;
} otg_exact_sum;

/// The same value in as few terms as it takes.
OTG_INLINE void otgExactCompress(otg_exact_sum* s) {
  int bottom = s->count - 1, top = 0;
  double q = s->term[bottom], low;
  for (int i = s->count - 2; i >= 0; --i) {
    otgFastTwoSum(q, s->term[i], &q, &low);
    if (low != 0.0) {
      s->term[bottom--] = q;
      q = low;
    }
  }
  for (int i = bottom + 1; i < s->count; ++i) {
    otgFastTwoSum(s->term[i], q, &q, &low);
    if (low != 0.0) s->term[top++] = low;
  }
  s->term[top++] = q;
  s->count = top;
}

OTG_INLINE void otgExactAdd(otg_exact_sum* s, double x) {
  int n = 0;
  if (x == 0.0) return;
  if (s->count == OTG_EXACT_TERMS) otgExactCompress(s);
  OTG_EXACT_ROLLED
  for (int i = 0; i < s->count; ++i) {
    double low;
    otgTwoSum(x, s->term[i], &x, &low);
    if (low != 0.0) s->term[n++] = low;
  }
  if (x != 0.0) s->term[n++] = x;
  s->count = n;
}

OTG_INLINE int otgExactSign(const otg_exact_sum* s) {
  return s->count == 0 ? 0 : otgSignOf(s->term[s->count - 1]);
}

/// Adds sign * x * y * z for factors of two terms each, the first of which may be zero.
OTG_INLINE void otgExactAddProduct(otg_exact_sum* s, double sign, const double* x, const double* y, const double* z) {
  OTG_EXACT_ROLLED
  for (int item = 0; item < 8; ++item) {
    const double p = x[item & 1], q = y[item >> 1 & 1], r = z[item >> 2];
    double high, low, part[4];
    if (p == 0.0 || q == 0.0 || r == 0.0) continue;
    otgTwoProduct(sign * p, q, &high, &low);
    otgTwoProduct(low, r, &part[1], &part[0]);
    otgTwoProduct(high, r, &part[3], &part[2]);
    OTG_EXACT_ROLLED
    for (int k = 0; k < 4; ++k) otgExactAdd(s, part[k]);
  }
}

/// *h == a - b exactly, the smaller term first.
OTG_INLINE void otgTwoTerms(double a, double b, double* h) {
  otgTwoSum(a, -b, &h[1], &h[0]);
}

/// As otgExactOrient3.
OTG_INLINE int otgSumOrient3(const double* a, const double* b, const double* c, const double* d) {
  double row[3][3][2];
  otg_exact_sum sum;
  sum.count = 0;
  for (int k = 0; k < 3; ++k) {
    otgTwoTerms(a[k], d[k], row[0][k]);
    otgTwoTerms(b[k], d[k], row[1][k]);
    otgTwoTerms(c[k], d[k], row[2][k]);
  }
  OTG_EXACT_ROLLED
  for (int p = 0; p < 6; ++p) {  // permutations: the even ones first
    const int i = p % 3, j = (i + (p < 3 ? 1 : 2)) % 3, k = (i + (p < 3 ? 2 : 1)) % 3;
    otgExactAddProduct(&sum, p < 3 ? 1.0 : -1.0, row[0][i], row[1][j], row[2][k]);
  }
  return otgExactSign(&sum);
}

/// Exact sign of (a1 - a0) (d1 - d0) - (b1 - b0) (c1 - c0).
OTG_INLINE int otgSumMinor(double a1, double a0, double d1, double d0, double b1, double b0, double c1, double c0) {
  const double one[2] = {0.0, 1.0};
  double x[2], y[2];
  otg_exact_sum sum;
  sum.count = 0;
  OTG_EXACT_ROLLED
  for (int k = 0; k < 2; ++k) {
    otgTwoTerms(k == 0 ? a1 : b1, k == 0 ? a0 : b0, x);
    otgTwoTerms(k == 0 ? d1 : c1, k == 0 ? d0 : c0, y);
    otgExactAddProduct(&sum, k == 0 ? 1.0 : -1.0, x, y, one);
  }
  return otgExactSign(&sum);
}

#ifndef __OPENCL_VERSION__
}  // namespace otg
#endif
#endif  // OTG_SHARED_EXACT_SUM_H
