// SPDX-License-Identifier: BSD-3-Clause
// Disjoint sets of numbers whose representative is the smallest member.
#pragma once

#include <cstddef>
#include <cstdint>
#include <numeric>
#include <vector>

namespace otg {

class UnionFind {
 public:
  UnionFind() = default;
  explicit UnionFind(std::size_t count) { reset(count); }
  /// So many sets of one number each. Keeps its memory.
  void reset(std::size_t count) {
    parent_.resize(count);
    std::iota(parent_.begin(), parent_.end(), 0u);
  }
  /// The smallest member of x's set. Halves the path on its way, which bounds the amortised cost by a logarithm.
  std::uint32_t find(std::uint32_t x) {
    while (parent_[x] != x) {
      parent_[x] = parent_[parent_[x]];
      x = parent_[x];
    }
    return x;
  }
  void unite(std::uint32_t a, std::uint32_t b) {
    a = find(a);
    b = find(b);
    if (a < b)
      parent_[b] = a;
    else if (b < a)
      parent_[a] = b;
  }

 private:
  std::vector<std::uint32_t> parent_;
};

}  // namespace otg
