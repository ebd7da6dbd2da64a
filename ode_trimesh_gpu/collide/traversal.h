// SPDX-License-Identifier: BSD-3-Clause
// How trees are traversed, and what comes out. Plain data, in a header of its own: see wide_kernels.h for who must not
// see more.
#pragma once

#include <compare>
#include <cstdint>

namespace otg {

enum class Traversal { kStandard, kQuantized, kNoLeaf, kWide };
enum class DescentRule { kFirstTreeFirst, kLargerFirst, kAlternating, kBoth };

struct TrianglePair {
  std::uint32_t a, b;
  /// By a, then by b: one comparison.
  constexpr std::uint64_t key() const { return std::uint64_t{a} << 32 | b; }
  friend constexpr bool operator==(const TrianglePair& x, const TrianglePair& y) { return x.key() == y.key(); }
  friend constexpr auto operator<=>(const TrianglePair& x, const TrianglePair& y) { return x.key() <=> y.key(); }
};

}  // namespace otg
