// SPDX-License-Identifier: BSD-3-Clause
// One node of the eight-way tree. Plain data, in a header of its own: see collide/simd/wide_kernels.h for who must not
// see more.
#pragma once

#include <cstdint>

namespace otg {

inline constexpr int kWideArity = 8;

/// Boxes in the mesh's centred frame, child k in lane k. Lanes from `count` on hold an inverted box that overlaps
/// nothing.
struct alignas(64) WideNode {
  float centerX[kWideArity], centerY[kWideArity], centerZ[kWideArity];
  float extentX[kWideArity], extentY[kWideArity], extentZ[kWideArity];
  std::int32_t child[kWideArity];  ///< >= 0: a node that follows this one; < 0: ~triangle
  std::int32_t count;              ///< children in use, 1 to 8
};
static_assert(sizeof(WideNode) == 256);

}  // namespace otg
