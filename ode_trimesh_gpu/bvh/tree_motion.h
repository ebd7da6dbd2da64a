// SPDX-License-Identifier: BSD-3-Clause
// Refitting a tree and its layouts where few triangles have moved.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "base/block_sum.h"
#include "bvh/layouts.h"
#include "bvh/mesh_box.h"
#include "bvh/tree.h"
#include "bvh/wide_tree.h"

namespace otg {

/// What is known of one tree beside itself: exact bounds of its nodes, where each triangle's leaf is, and sums of
/// areas. Made from the tree, and kept in step with it. Takes about 40 bytes for each triangle.
class TreeMotion {
 public:
  TreeMotion(const BinaryTree& tree, const TriMesh& mesh);

  /// First step, before the vertices move: finds the leaves of `triangles` (each once) and all nodes above them. May
  /// throw std::bad_alloc, after which the object is of no further use.
  void plan(const BinaryTree& tree, std::span<const std::uint32_t> triangles);
  /// Second step: the boxes of those nodes as refitTree() would make them, bit for bit. Throws nothing.
  void refit(BinaryTree& tree, const TriMesh& mesh);

  /// The nodes of the last plan, children before their parents.
  std::span<const std::uint32_t> nodes() const { return nodes_; }
  /// sahCost() of the tree, bit for bit, after refit(). To be called once for each.
  double cost(const BinaryTree& tree);

 private:
  MeshBox exactBox(const BinaryTree& tree, const TriMesh& mesh, std::uint32_t node) const;

  struct Bounds6 {
    Vec3f lo, hi;
  };
  std::vector<std::uint32_t> leafOf_;  ///< of each triangle
  std::vector<Bounds6> inner_;         ///< of each inner node, at the place of its children: (child - 1) / 2
  std::vector<std::uint8_t> pending_;  ///< by the same places: children that the plan has and refit() has not served
  KeptBlockSum areas_;
  std::vector<std::uint32_t> nodes_, changed_;
};

/// Where the nodes of a binary tree are in a layout that was made of it.
struct WidePlaces {
  std::vector<std::uint32_t> lane;  ///< eight times the wide node and the lane; kNone for nodes that were opened
};
struct NoLeafPlaces {
  std::vector<std::uint32_t> node;  ///< of inner nodes; kNone for leaves
};
NoLeafPlaces noLeafPlaces(const BinaryTree& tree);

/// New boxes of some nodes, as the binary tree has them.
void refitLayout(WideTree& wide, const WidePlaces& places, const BinaryTree& tree,
                 std::span<const std::uint32_t> nodes);
void refitLayout(NoLeafTree& noLeaf, const NoLeafPlaces& places, const BinaryTree& tree,
                 std::span<const std::uint32_t> nodes);

}  // namespace otg
