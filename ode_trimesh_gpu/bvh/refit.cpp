// SPDX-License-Identifier: BSD-3-Clause
// Boxes of a binary tree from the leaves up, and how good they are.
#include "base/block_sum.h"
#include "bvh/mesh_box.h"

namespace otg {

void refitTree(BinaryTree& tree, const TriMesh& mesh) {
  if (tree.nodes.empty()) return;
  // Children come after their parents, so backwards is bottom-up. Until its parent has been served, a node keeps its
  // exact bounds where its box will be: the lower one as its centre, the upper one as its extent.
  const auto keep = [](BvhNode& node, const MeshBox& box) {
    node.center = {box.lo[0], box.lo[1], box.lo[2]};
    node.extent = {box.hi[0], box.hi[1], box.hi[2]};
  };
  const auto kept = [](const BvhNode& node) {
    return MeshBox{{node.center.x, node.center.y, node.center.z, 0}, {node.extent.x, node.extent.y, node.extent.z, 0}};
  };
  const Vec3f origin = mesh.origin();
  for (std::size_t i = tree.nodes.size(); i-- > 0;) {
    BvhNode& node = tree.nodes[i];
    if (node.isLeaf()) {
      keep(node, boxOfTriangle(mesh, node.triangle()));
      continue;
    }
    MeshBox both;
    for (BvhNode* child : {&tree.nodes[node.child], &tree.nodes[node.child + 1]}) {
      const MeshBox box = kept(*child);
      both.grow(box);
      enclose(box, origin, *child);
    }
    keep(node, both);
  }
  enclose(kept(tree.nodes[0]), origin, tree.nodes[0]);
}

double relativeCost(const BinaryTree& tree, double sumOfHalfAreas) {
  if (tree.nodes.empty()) return 0;
  const double root = halfArea(tree.nodes[0]);
  return root > 0 ? sumOfHalfAreas / root : static_cast<double>(tree.nodes.size());
}

double sahCost(const BinaryTree& tree) {
  BlockSum sum;
  for (const BvhNode& node : tree.nodes) sum.add(halfArea(node));
  return relativeCost(tree, sum.total());
}

}  // namespace otg
