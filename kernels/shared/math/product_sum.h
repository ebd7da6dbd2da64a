// SPDX-License-Identifier: BSD-3-Clause
// Exact signs for doubles of any size, on the CPU: where expansions could underflow or overflow. Devices leave such
// pairs to the CPU.
#ifndef OTG_SHARED_PRODUCT_SUM_H
#define OTG_SHARED_PRODUCT_SUM_H
#include "shared/math/platform.h"

#ifndef __OPENCL_VERSION__
namespace otg {

/// A sum of products of three doubles, as a fixed-point number with a place for every bit that such products have.
class ProductSum {
 public:
  /// Adds sign * x * y * z; `sign` is 1 or -1.
  void add(int sign, double x, double y, double z) {
    if (x == 0 || y == 0 || z == 0) return;
    std::uint64_t digits[6] = {1, 0, 0, 0, 0, 0};  // 32 bits each, the least first
    int place = kUnit;
    for (const double factor : {x, y, z}) {
      int exponent = 0;
      const auto bits = static_cast<std::uint64_t>(std::ldexp(std::frexp(std::fabs(factor), &exponent), 53));
      place += exponent - 53;
      if (factor < 0) sign = -sign;
      const std::uint64_t low = bits & kDigit, high = bits >> 32;
      std::uint64_t carry = 0, before = 0;
      for (std::uint64_t& digit : digits) {
        // Below 2^64: the high part of a factor has 21 bits.
        const std::uint64_t product = digit * low, next = (product & kDigit) + before * high + carry;
        carry = (product >> 32) + (next >> 32);
        before = digit;
        digit = next & kDigit;
      }
    }
    std::int64_t* limb = limbs_ + place / 32;
    for (const std::uint64_t digit : digits) {
      const std::uint64_t moved = digit << (place % 32);
      limb[0] += sign * static_cast<std::int64_t>(moved & kDigit);
      limb[1] += sign * static_cast<std::int64_t>(moved >> 32);
      ++limb;
    }
  }

  /// 1, -1 or 0.
  int sign() const {
    std::int64_t carry = 0;
    bool any = false;
    for (const std::int64_t limb : limbs_) {
      const std::int64_t value = limb + carry;
      any = any || (value & static_cast<std::int64_t>(kDigit)) != 0;
      carry = value >> 32;  // towards minus infinity
    }
    return carry < 0 ? -1 : carry > 0 || any ? 1 : 0;
  }

 private:
  static constexpr std::uint64_t kDigit = 0xffffffff;
  /// The place of 1. The least double is 2^-1074; its 53 bits are counted down from there.
  static constexpr int kUnit = 3 * (1074 + 53);
  static constexpr int kLimbs = (kUnit + 3 * 1024) / 32 + 8;
  std::int64_t limbs_[kLimbs] = {};  ///< 32 bits each, and what was added to them
};

/// Adds sign * det[p, q, r].
inline void otgAddDeterminant(ProductSum& sum, int sign, const double* p, const double* q, const double* r) {
  for (int i = 0; i < 3; ++i) {
    const int j = (i + 1) % 3, k = (i + 2) % 3;
    sum.add(sign, p[i], q[j], r[k]);
    sum.add(-sign, p[i], q[k], r[j]);
  }
}

/// As otgExactOrient3, for doubles of any size.
inline int otgOrient3OfAnySize(const double* a, const double* b, const double* c, const double* d) {
  ProductSum sum;
  otgAddDeterminant(sum, 1, a, b, c);
  otgAddDeterminant(sum, -1, d, b, c);
  otgAddDeterminant(sum, -1, a, d, c);
  otgAddDeterminant(sum, -1, a, b, d);
  return sum.sign();
}

/// As otgExactMinor, for doubles of any size.
inline int otgMinorOfAnySize(double a1, double a0, double d1, double d0, double b1, double b0, double c1, double c0) {
  ProductSum sum;
  sum.add(1, 1, a1, d1);
  sum.add(-1, 1, a1, d0);
  sum.add(-1, 1, a0, d1);
  sum.add(1, 1, a0, d0);
  sum.add(-1, 1, b1, c1);
  sum.add(1, 1, b1, c0);
  sum.add(1, 1, b0, c1);
  sum.add(-1, 1, b0, c0);
  return sum.sign();
}

}  // namespace otg
#endif
#endif  // OTG_SHARED_PRODUCT_SUM_H
