// SPDX-License-Identifier: BSD-3-Clause
// Whether queries can walk a tree that comes from elsewhere.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "bvh/tree.h"

namespace otg {

/// Checks that every node is reached once, that parents and children know each other, and that siblings are an odd
/// number and the next. Checks that leaves name each triangle of the mesh once, and that boxes are finite. The tree
/// must be as deep as it says, and no deeper than builds make it. validateTree() looks at the boxes too; this is what a
/// walk relies on.
///
/// Nodes are looked at piece by piece, as they come in. Whatever they are, nothing outside the arrays is read.
class TreeCheck {
 public:
  /// The array has its size, but no elements yet. It stays where it is.
  TreeCheck(const Array<BvhNode>& nodes, std::size_t triangles);
  /// Nodes `begin` to `end` are there, in order and without gaps.
  void nodes(std::size_t begin, std::size_t end);
  /// After all of them: in words, empty where nothing is wrong.
  std::string fault(std::uint32_t depth) const;

 private:
  const Array<BvhNode>& nodes_;
  std::size_t triangles_;
  bool sizeMatches_;
  std::vector<std::uint8_t> depth_;  ///< of each node
  std::vector<std::uint8_t> seen_;   ///< how many leaves each triangle has, and all that are no triangle
  std::size_t inner_ = 0;
  unsigned bad_ = 0, deepest_ = 1;
  std::uint64_t carried_ = 0;
};

}  // namespace otg
