// SPDX-License-Identifier: BSD-3-Clause
#include "truth/dyadic.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace otg::truth {
namespace {

using Digits = std::vector<std::uint32_t>;

/// `digits` moved up by whole digits, in `size` of them.
Digits movedUp(const Digits& digits, int by, std::size_t size) {
  Digits out(size, 0);
  std::copy(digits.begin(), digits.end(), out.begin() + by);
  return out;
}

}  // namespace

Dyadic::Dyadic(double x) {
  if (x == 0) return;
  sign_ = x < 0 ? -1 : 1;
  int exponent = 0;
  const auto bits = static_cast<std::uint64_t>(std::ldexp(std::frexp(std::fabs(x), &exponent), 53));
  exponent -= 53;
  place_ = exponent >= 0 ? exponent / 32 : -((31 - exponent) / 32);
  const int shift = exponent - 32 * place_;
  const std::uint64_t low = (bits & 0xffffffff) << shift, high = (bits >> 32) << shift;
  const std::uint64_t middle = (low >> 32) + (high & 0xffffffff);
  digits_ = {static_cast<std::uint32_t>(low), static_cast<std::uint32_t>(middle),
             static_cast<std::uint32_t>((high >> 32) + (middle >> 32))};
  trim();
}

void Dyadic::trim() {
  while (!digits_.empty() && digits_.back() == 0) digits_.pop_back();
  std::size_t zeros = 0;
  while (zeros < digits_.size() && digits_[zeros] == 0) ++zeros;
  digits_.erase(digits_.begin(), digits_.begin() + static_cast<std::ptrdiff_t>(zeros));
  place_ += static_cast<int>(zeros);
  if (digits_.empty()) sign_ = place_ = 0;
}

/// *this + sign |y|.
Dyadic Dyadic::plus(const Dyadic& y, int sign) const {
  if (sign == 0) return *this;
  Dyadic out;
  if (sign_ == 0) {
    out = y;
    out.sign_ = sign;
    return out;
  }
  out.place_ = std::min(place_, y.place_);
  const int upX = place_ - out.place_, upY = y.place_ - out.place_;
  const std::size_t size =
      1 + std::max(digits_.size() + static_cast<std::size_t>(upX), y.digits_.size() + static_cast<std::size_t>(upY));
  Digits larger = movedUp(digits_, upX, size), smaller = movedUp(y.digits_, upY, size);
  out.sign_ = sign_;
  if (std::lexicographical_compare(larger.rbegin(), larger.rend(), smaller.rbegin(), smaller.rend())) {
    std::swap(larger, smaller);
    out.sign_ = sign;
  }
  std::int64_t carry = 0;
  for (std::size_t i = 0; i < size; ++i) {
    const std::int64_t other = smaller[i];
    carry += std::int64_t{larger[i]} + (sign == sign_ ? other : -other);
    larger[i] = static_cast<std::uint32_t>(carry & 0xffffffff);
    carry >>= 32;
  }
  out.digits_ = std::move(larger);
  out.trim();
  return out;
}

Dyadic operator*(const Dyadic& x, const Dyadic& y) {
  Dyadic out;
  if (x.sign_ == 0 || y.sign_ == 0) return out;
  out.sign_ = x.sign_ * y.sign_;
  out.place_ = x.place_ + y.place_;
  out.digits_.assign(x.digits_.size() + y.digits_.size(), 0);
  for (std::size_t i = 0; i < x.digits_.size(); ++i) {
    std::uint64_t carry = 0;
    for (std::size_t j = 0; j < y.digits_.size(); ++j) {
      carry += std::uint64_t{x.digits_[i]} * y.digits_[j] + out.digits_[i + j];
      out.digits_[i + j] = static_cast<std::uint32_t>(carry);
      carry >>= 32;
    }
    out.digits_[i + y.digits_.size()] = static_cast<std::uint32_t>(carry);
  }
  out.trim();
  return out;
}

}  // namespace otg::truth
