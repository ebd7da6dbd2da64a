// SPDX-License-Identifier: BSD-3-Clause
// Numbers of any length that are whole multiples of a power of two: what sums and products of doubles are.
#pragma once

#include <cstdint>
#include <vector>

namespace otg::truth {

class Dyadic {
 public:
  Dyadic() = default;
  Dyadic(double x);  // NOLINT(google-explicit-constructor): every double is one
  friend Dyadic operator+(const Dyadic& x, const Dyadic& y) { return x.plus(y, y.sign_); }
  friend Dyadic operator-(const Dyadic& x, const Dyadic& y) { return x.plus(y, -y.sign_); }
  friend Dyadic operator*(const Dyadic& x, const Dyadic& y);
  friend bool operator<(const Dyadic& x, const Dyadic& y) { return (x - y).sign_ < 0; }
  int sign() const { return sign_; }

 private:
  Dyadic plus(const Dyadic& y, int sign) const;
  void trim();
  int sign_ = 0;
  int place_ = 0;                      ///< digits_[0] counts 2^(32 place_)
  std::vector<std::uint32_t> digits_;  ///< the least first, the last one not 0
};

}  // namespace otg::truth
