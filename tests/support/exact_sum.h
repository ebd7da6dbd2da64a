// SPDX-License-Identifier: BSD-3-Clause
// Sums of any floats in exact arithmetic, as a fixed-point number that spans the whole range of float. An oracle: slow,
// and without anything in common with the expansions that the library uses.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>

namespace otg {

class ExactSum {
 public:
  /// Adds x; chains.
  ExactSum& add(float x) {
    if (x == 0) return *this;
    int exponent = 0;
    const auto mantissa = static_cast<std::int64_t>(std::ldexp(std::frexp(std::fabs(x), &exponent), 24));
    // x = mantissa 2^(exponent - 24); in units of 2^-192 (floats have no bits below 2^-149) that is a shift to the
    // left.
    const int shift = exponent - 24 + 192;
    const std::int64_t part = mantissa << (shift % 32);
    const std::int64_t sign = x < 0 ? -1 : 1;
    limbs_[static_cast<std::size_t>(shift / 32)] += sign * (part & 0xffffffff);
    limbs_[static_cast<std::size_t>(shift / 32) + 1] += sign * (part >> 32);
    return *this;
  }
  ExactSum& subtract(float x) { return add(-x); }
  /// -1, 0 or 1.
  int sign() const {
    std::int64_t carry = 0;
    bool any = false;
    for (const std::int64_t limb : limbs_) {
      const std::int64_t value = limb + carry;
      any = any || (value & 0xffffffff) != 0;
      carry = value >> 32;  // towards minus infinity
    }
    return carry < 0 ? -1 : (carry > 0 || any ? 1 : 0);
  }

 private:
  /// Least significant first, 32 bits each and room for carries above them.
  std::array<std::int64_t, 12> limbs_{};
};

}  // namespace otg
