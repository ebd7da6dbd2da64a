// SPDX-License-Identifier: BSD-3-Clause
// Bounding volume hierarchy of axis-aligned boxes in the mesh's own (centred) frame: the binary tree that the build
// strategies make and every other layout is derived from.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "base/array.h"
#include "mesh/tri_mesh.h"

namespace otg {

/// How the tree is built.
enum class BuildStrategy {
  kMeanSplit,  ///< the published one: axis of greatest variance of the box centres, split at their mean
  kSah,        ///< binned surface-area heuristic (default)
};

/// One node of the standard binary tree, 32 bytes. Boxes are centre and half-extents in the mesh's centred frame
/// (mesh coordinate minus TriMesh::origin()), rounded outward: the box contains the exact triangle.
struct BvhNode {
  Vec3f center;
  Vec3f extent;
  std::int32_t child;    ///< inner node: its children are nodes child and child + 1 (child > 0); leaf: ~triangle (< 0)
  std::uint32_t parent;  ///< kNone for the root
  bool isLeaf() const { return child < 0; }
  std::uint32_t triangle() const { return static_cast<std::uint32_t>(~child); }
};
static_assert(sizeof(BvhNode) == 32);

/// One triangle per leaf; 2 F - 1 nodes, node 0 is the root, children follow their parents. Empty for an empty mesh.
struct BinaryTree {
  Array<BvhNode> nodes;
  std::uint32_t depth = 0;  ///< nodes on the longest way from the root to a leaf, 0 when empty
  BuildStrategy strategy = BuildStrategy::kSah;
};

/// No build makes a tree deeper than this, whatever the input: where a strategy peels off a few triangles at a time,
/// both fall back to halving the triangles by their order along the widest axis. The bound for n triangles is
/// 3 ceil(log2 n) + 8, which also keeps the time O(n log n).
inline constexpr std::uint32_t kMaxTreeDepth = 96;

BinaryTree buildTree(const TriMesh& mesh, BuildStrategy strategy);

/// New boxes for moved vertices (mesh has the triangles that the tree was built from): O(F), same topology.
void refitTree(BinaryTree& tree, const TriMesh& mesh);

/// Sum of the surface areas of all nodes over that of the root: grows as refitting makes boxes overlap, so that a
/// caller can decide to build anew. 1 for a single leaf, 0 for an empty tree; where the root has no area, the number of
/// nodes.
double sahCost(const BinaryTree& tree);

/// Half the surface area of a node's box.
inline double halfArea(const BvhNode& n) {
  return double{n.extent.x} * n.extent.y + double{n.extent.y} * n.extent.z + double{n.extent.z} * n.extent.x;
}
/// sahCost() from the BlockSum of halfArea() over all nodes.
double relativeCost(const BinaryTree& tree, double sumOfHalfAreas);

/// Checks every invariant; empty string when all hold, else the first violation in words.
std::string validateTree(const BinaryTree& tree, const TriMesh& mesh);

}  // namespace otg
