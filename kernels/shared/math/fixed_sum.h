// SPDX-License-Identifier: BSD-3-Clause
// Sums whose terms may come in any order: whole numbers of a unit, which is a power of two. Terms are rounded to that
// unit, and their sum is exact, so that it is the same whoever adds, and however many at once. In OpenCL C only with
// doubles.
#ifndef OTG_SHARED_FIXED_SUM_H
#define OTG_SHARED_FIXED_SUM_H
#include "shared/math/platform.h"

#ifdef __OPENCL_VERSION__
typedef long otg_long;
#else
#ifdef __SSE2__
#include <emmintrin.h>
#endif
namespace otg {
using otg_long = std::int64_t;
#endif

/// The smallest n with x < 2^n, for x > 0; else 0.
OTG_INLINE otg_int otgBitsOf(double x) {
  otg_int bits = 0;
#ifdef __OPENCL_VERSION__
  if (x > 0) frexp(x, &bits);
#else
  if (x > 0) std::frexp(x, &bits);
#endif
  return bits;
}

/// Units in one, such that the sum of 2^`countBits` terms of less than 2^`termBits` each stays below 2^62.
OTG_INLINE double otgUnitsInOne(otg_int countBits, otg_int termBits) {
  const otg_int bits = 62 - countBits - termBits;
  const otg_int held = bits > 1000 ? 1000 : bits < -1000 ? -1000 : bits;
#ifdef __OPENCL_VERSION__
  return ldexp(1.0, held);
#else
  return std::ldexp(1.0, held);
#endif
}

/// A term in units, to the nearest, ties to even. What is no number is nothing.
OTG_INLINE otg_long otgInUnits(double x, double unitsInOne) {
  const double most = 0x1p62, units = x * unitsInOne;
  const double held = units < most ? (units > -most ? units : -most) : most;
  if (x != x) return 0;
#if defined(__OPENCL_VERSION__)
  return convert_long_rte(held);
#elif defined(__SSE2__)
  return _mm_cvtsd_si64(_mm_set_sd(held));
#else
  return std::llrint(held);
#endif
}

/// Sums wrap; with units as above they never do for terms that keep to their bounds.
OTG_INLINE otg_long otgAddUnits(otg_long x, otg_long y) {
#ifdef __OPENCL_VERSION__
  return x + y;
#else
  return static_cast<otg_long>(static_cast<std::uint64_t>(x) + static_cast<std::uint64_t>(y));
#endif
}

/// The nearest double to a sum.
OTG_INLINE double otgFromUnits(otg_long sum, double unitsInOne) {
#ifdef __OPENCL_VERSION__
  return convert_double_rte(sum) / unitsInOne;
#else
  return static_cast<double>(sum) / unitsInOne;
#endif
}

#ifndef __OPENCL_VERSION__
}  // namespace otg
#endif
#endif  // OTG_SHARED_FIXED_SUM_H
