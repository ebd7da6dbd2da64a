// SPDX-License-Identifier: BSD-3-Clause
// Cells of grids.
#pragma once

#include <algorithm>
#include <cstddef>

namespace otg {

/// Which of `count` cells of width 1 (at least one) holds x: the first or the last where x lies outside, the first
/// where it is no number. Monotonic. Any double is allowed: to convert one that an integer cannot hold would be
/// undefined.
inline std::size_t gridPlace(double x, std::size_t count) {
  return x > 0 ? static_cast<std::size_t>(std::min(x, static_cast<double>(count - 1))) : 0;
}

}  // namespace otg
