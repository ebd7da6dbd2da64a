// SPDX-License-Identifier: BSD-3-Clause
// Eight-way tree for devices: one array of child records, several triangles to a leaf, and a cut of it to begin at.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "bvh/tree.h"
#include "bvh/wide_node.h"

namespace otg {

inline constexpr std::uint32_t kPackedArity = kWideArity;
inline constexpr std::uint32_t kMaxCutNodes = 512;

/// A box in the mesh's centred frame and what is in it. The children of a node lie side by side.
struct PackedNode {
  Vec3f center;
  std::int32_t first;  ///< inner: index of the first child; leaf: place in PackedTree::triangles
  Vec3f extent;
  std::int32_t count;  ///< inner: children, 2 to 8 (> 0); leaf: minus the number of triangles (< 0)
  bool isLeaf() const { return count < 0; }
};
static_assert(sizeof(PackedNode) == 32);

struct PackedTree {
  std::vector<PackedNode> nodes;         ///< node 0 is the root; empty for an empty mesh
  std::vector<std::uint32_t> triangles;  ///< triangle numbers in the order of the leaves
  std::uint32_t depth = 0;               ///< nodes on the longest way from the root to a leaf
  /// Nodes that together hold every triangle once, at most kMaxCutNodes: what is left when the node of the largest area
  /// is opened again and again. Scattered, but always in the same order. So neighbours, which are tested side by side,
  /// are not all near the other mesh at once.
  std::vector<std::uint32_t> cut;
};

/// The nodes whose areas have the least sum (TreeCollapse). Boxes are those of the binary tree, bit for bit.
/// `leafTriangles`: 1 to 16. `binaryNodes`, if requested, receives for each node the one of the binary tree that it has
/// the box of.
PackedTree makePackedTree(const BinaryTree& tree, std::uint32_t leafTriangles,
                          std::vector<std::uint32_t>* binaryNodes = nullptr);

/// Empty when every box contains its subtree's triangles, and leaves and cut hold every triangle once.
std::string validateLayout(const PackedTree& tree, const TriMesh& mesh);

}  // namespace otg
