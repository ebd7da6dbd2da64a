// SPDX-License-Identifier: BSD-3-Clause
// Hashes of what a caller gave for a mesh: equal for equal arrays, however the mesh came to be made of them.
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>

#include "base/hash.h"
#include "shared/math/vec3.h"

namespace otg {

/// The share of one vertex, by its caller's number, in the hash; -0 equals +0.
inline std::uint64_t vertexHash(std::uint32_t ofCaller, const Vec3f& p) {
  const auto bits = [](float x) { return std::uint64_t{std::bit_cast<std::uint32_t>(x + 0.0F)}; };
  return spreadBits(spreadBits(spreadBits(std::uint64_t{ofCaller} + 1) ^ (bits(p.x) | bits(p.y) << 32)) ^ bits(p.z));
}

}  // namespace otg
