// SPDX-License-Identifier: BSD-3-Clause
// Which nodes of a binary tree become those of an eight-way one, such that the sum of their surface areas is least.
// That sum is an estimate of how many are visited. Source: H. Ylitie, T. Karras, S. Laine, "Efficient Incoherent Ray
// Traversal on GPUs Through Compressed Wide BVHs", 2017, section 3.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "bvh/tree.h"
#include "bvh/wide_node.h"

namespace otg {

class TreeCollapse {
 public:
  /// `isEnd(n)`: node n is a leaf, or is to be one. So is all that is below it.
  template <class IsEnd>
  TreeCollapse(const BinaryTree& tree, const IsEnd& isEnd) : tree_(tree), costs_(tree.nodes.size(), kNoCosts) {
    for (std::size_t n = tree.nodes.size(); n-- > 0;) {
      if (!isEnd(n)) count(n);
    }
  }

  /// The children of the eight-way node that stands for a node that is no end. Returns how many.
  int childrenOf(std::int32_t node, std::int32_t* slots) const {
    int count = 0;
    share(node, kWideArity, slots, count);
    return count;
  }

 private:
  /// [i]: least area of the eight-way nodes of a subtree that takes i + 1 lanes of the node above, or fewer.
  using Costs = std::array<float, kWideArity - 1>;
  static constexpr Costs kNoCosts{};  ///< of ends

  void count(std::size_t node);
  void split(std::int32_t node, int lanes, std::int32_t* slots, int& count) const;
  void share(std::int32_t node, int lanes, std::int32_t* slots, int& count) const;

  const BinaryTree& tree_;
  std::vector<Costs> costs_;
};

}  // namespace otg
