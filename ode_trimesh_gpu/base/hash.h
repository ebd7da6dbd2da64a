// SPDX-License-Identifier: BSD-3-Clause
// The hash of bytes and that of numbers.
#pragma once

#include <cstddef>
#include <cstdint>

namespace otg {

inline constexpr std::uint64_t kFnvStart = 0xcbf29ce484222325u;

/// 64-bit FNV-1a: the same on every machine, for what is stored or shown. `state`: of the bytes before.
inline std::uint64_t fnv1a(const void* bytes, std::size_t count, std::uint64_t state = kFnvStart) {
  const auto* const p = static_cast<const unsigned char*>(bytes);
  for (std::size_t i = 0; i < count; ++i) state = (state ^ p[i]) * 0x100000001b3u;
  return state;
}

/// Spreads what tells numbers apart over all bits: for the places in hash tables.
constexpr std::uint64_t spreadBits(std::uint64_t number) {
  number = (number ^ (number >> 32)) * 0x9e3779b97f4a7c15u;
  return number ^ (number >> 32);
}

}  // namespace otg
