// SPDX-License-Identifier: BSD-3-Clause
// Three vertex indices. Plain data, in a header of its own: see collide/simd/wide_kernels.h for who must not see more.
#pragma once

#include <cstdint>

namespace otg {

/// Three vertex indices, counter-clockwise seen from outside.
struct Triangle {
  std::uint32_t v[3];
  friend bool operator==(const Triangle&, const Triangle&) = default;
};

}  // namespace otg
