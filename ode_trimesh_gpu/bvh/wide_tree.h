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

/// Keeps the nodes of the binary tree whose surface areas have the least sum (TreeCollapse). Boxes are those of the
/// binary tree, bit for bit. `lanes`, if not null, gets for each node of the binary tree eight times its wide node,
/// plus its lane there. It is kNone for nodes that were opened.
WideTree makeWideTree(const BinaryTree& tree, std::vector<std::uint32_t>* lanes = nullptr);

inline void setBox(WideNode& node, std::uint32_t lane, const Vec3f& center, const Vec3f& extent) {
  node.centerX[lane] = center.x;
  node.centerY[lane] = center.y;
  node.centerZ[lane] = center.z;
  node.extentX[lane] = extent.x;
  node.extentY[lane] = extent.y;
  node.extentZ[lane] = extent.z;
}

/// Empty when every box contains its subtree's triangles and every triangle appears once.
std::string validateLayout(const WideTree& tree, const TriMesh& mesh);

}  // namespace otg
