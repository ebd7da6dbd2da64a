// SPDX-License-Identifier: BSD-3-Clause
// Eight-way tree for SIMD: the binary tree collapsed, the boxes of a node's children side by side.
// Source of the layout: I. Wald, C. Benthin, S. Boulos, "Getting Rid of Packets", 2008 (multi-branching BVHs).
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "bvh/tree.h"
#include "bvh/wide_node.h"

namespace otg {

struct WideTree {
  std::vector<WideNode> nodes;  ///< node 0 is the root; empty for an empty mesh
  Vec3f rootCenter{}, rootExtent{};
  std::uint32_t depth = 0;
};

/// Opens each node's largest inner child until there are eight. Boxes are those of the binary tree, bit for bit.
WideTree makeWideTree(const BinaryTree& tree);

/// Empty when every box contains its subtree's triangles and every triangle appears once.
std::string validateLayout(const WideTree& tree, const TriMesh& mesh);

}  // namespace otg
