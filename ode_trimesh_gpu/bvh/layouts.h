// SPDX-License-Identifier: BSD-3-Clause
// Node layouts derived from the binary tree: quantised and no-leaf, as in the published design (after OPCODE).
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "bvh/tree.h"

namespace otg {

/// Centre and half-extents as 16-bit integers on a grid shared by the whole tree: value = q * step. The decoded box
/// always contains the box that it stands for (verified at build time, widened by one step where rounding fell short).
/// Decoded boxes are finite for meshes whose coordinates are at most 1e38; beyond, an extent may decode to infinity.
struct QuantizedNode {
  std::int16_t center[3];
  std::uint16_t extent[3];
  std::int32_t child;  ///< as BvhNode::child
};
static_assert(sizeof(QuantizedNode) == 16);

struct QuantizedTree {
  std::vector<QuantizedNode> nodes;  ///< same numbering as the binary tree
  Vec3f centerStep{}, extentStep{};  ///< powers of two, so that decoding q * step is exact in float
};

/// A tree whose leaves carry no box: only the F - 1 inner nodes exist, and a child that would be a leaf is the
/// triangle.
struct NoLeafNode {
  Vec3f center;
  Vec3f extent;
  /// For each side: >= 0 the index of an inner node, < 0 ~triangle.
  std::int32_t left, right;
};
static_assert(sizeof(NoLeafNode) == 32);

struct NoLeafTree {
  std::vector<NoLeafNode> nodes;  ///< node 0 is the root; empty when the mesh has fewer than two triangles
  std::uint32_t triangleCount = 0;
};

QuantizedTree quantizeTree(const BinaryTree& tree);
NoLeafTree makeNoLeafTree(const BinaryTree& tree);

/// New boxes of some nodes, as the binary tree has them. False where a box does not fit into the grid; the tree is to
/// be quantised anew then.
bool refitLayout(QuantizedTree& quantized, const BinaryTree& tree, std::span<const std::uint32_t> nodes);

/// New boxes of some nodes, as the binary tree has them. False where a box does not fit into the grid; the tree is to
/// be quantised anew then.
bool refitLayout(QuantizedTree& quantized, const BinaryTree& tree, std::span<const std::uint32_t> nodes);

/// Empty when every box of the layout contains its subtree's triangles and every triangle appears once.
std::string validateLayout(const QuantizedTree& tree, const TriMesh& mesh);
std::string validateLayout(const NoLeafTree& tree, const TriMesh& mesh);

}  // namespace otg
