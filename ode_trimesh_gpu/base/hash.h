// SPDX-License-Identifier: BSD-3-Clause
// The hash of bytes and that of numbers.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstring>

namespace otg {

inline constexpr std::uint64_t kFnvStart = 0xcbf29ce484222325u;

/// 64-bit FNV-1a: the same on every machine, for what is stored or shown. `state`: of the bytes before.
inline std::uint64_t fnv1a(const void* bytes, std::size_t count, std::uint64_t state = kFnvStart) {
  const auto* const p = static_cast<const unsigned char*>(bytes);
  for (std::size_t i = 0; i < count; ++i) state = (state ^ p[i]) * 0x100000001b3u;
  return state;
}

/// Spreads what distinguishes numbers over all bits: for the places in hash tables.
constexpr std::uint64_t spreadBits(std::uint64_t number) {
  number = (number ^ (number >> 32)) * 0x9e3779b97f4a7c15u;  // high bits alone reach low ones, too
  return number ^ (number >> 32);
}

/// A hash of long texts, eight bytes at once: another one than FNV-1a, and not the same on every machine. Two that
/// differ in eight bytes or fewer, at a place that 8 divides, differ in it.
inline std::uint64_t hashOfWords(const void* bytes, std::size_t count) {
  const auto* const p = static_cast<const unsigned char*>(bytes);
  std::uint64_t state = kFnvStart + count;
  for (std::size_t i = 0; i < count; i += sizeof state) {
    std::uint64_t word = 0;
    std::memcpy(&word, p + i, std::min(sizeof word, count - i));
    state = spreadBits(state ^ word);
  }
  return state;
}

}  // namespace otg
