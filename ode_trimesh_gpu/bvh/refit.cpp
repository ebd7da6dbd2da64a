// SPDX-License-Identifier: BSD-3-Clause
// Boxes of a binary tree from the leaves up.
#include "bvh/triangle_boxes.h"

namespace otg {

void refitTree(BinaryTree& tree, const TriMesh& mesh) {
  std::vector<Bounds> bounds(tree.nodes.size());
  // Children come after their parents, so backwards is bottom-up.
  for (std::size_t i = tree.nodes.size(); i-- > 0;) {
    BvhNode& node = tree.nodes[i];
    if (node.isLeaf()) {
      bounds[i] = boundsOf(mesh, node.triangle());
    } else {
      bounds[i] = bounds[node.child];
      bounds[i].grow(bounds[node.child + 1]);
    }
    boxOf(bounds[i], node.center, node.extent);
  }
}

double sahCost(const BinaryTree& tree) {
  if (tree.nodes.empty()) return 0;
  const auto area = [](const BvhNode& n) {
    return double{n.extent.x} * n.extent.y + double{n.extent.y} * n.extent.z + double{n.extent.z} * n.extent.x;
  };
  double sum = 0;
  for (const BvhNode& node : tree.nodes) sum += area(node);
  const double root = area(tree.nodes[0]);
  return root > 0 ? sum / root : static_cast<double>(tree.nodes.size());
}

}  // namespace otg
