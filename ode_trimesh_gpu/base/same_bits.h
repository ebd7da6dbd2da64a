// SPDX-License-Identifier: BSD-3-Clause
// Equality of numbers to the last bit.
#pragma once

#include <array>
#include <bit>

namespace otg {

/// The same bytes are promised for the same bytes, and 0 is not -0. For vectors and poses, which have no padding.
template <class T>
bool sameBits(const T& x, const T& y) {
  using Bytes = std::array<unsigned char, sizeof(T)>;
  return std::bit_cast<Bytes>(x) == std::bit_cast<Bytes>(y);
}

}  // namespace otg
