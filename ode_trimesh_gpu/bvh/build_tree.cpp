// SPDX-License-Identifier: BSD-3-Clause
// Top-down construction of the binary tree by either strategy.
#include "bvh/split_rules.h"

namespace otg {
namespace {

/// The `count` triangles from `begin` on become the subtree at `node`.
struct Task {
  std::uint32_t node, begin, count, depth;
};

/// Levels that halving needs below a node of n leaves: log2, rounded up.
std::uint32_t levelsFor(std::uint32_t n) {
  return static_cast<std::uint32_t>(std::bit_width(n - 1));
}

}  // namespace

BinaryTree buildTree(const TriMesh& mesh, BuildStrategy strategy) {
  BinaryTree tree;
  tree.strategy = strategy;
  const auto n = static_cast<std::uint32_t>(mesh.triangleCount());
  if (n == 0) return tree;
  std::vector<MeshBox> boxes(n), roomForBoxes(n);
  std::vector<std::uint32_t> triangles(n), roomForTriangles(n);
  for (std::uint32_t t = 0; t < n; ++t) {
    boxes[t] = boxOfTriangle(mesh, t);
    triangles[t] = t;
  }
  // Three times the depth of a balanced tree is more than meshes need. It keeps the time O(n log n) for inputs of which
  // every free split peels off a few triangles. 28 levels is the most (kMaxTriangles), so kMaxTreeDepth holds.
  const std::uint32_t depthLimit = std::min(kMaxTreeDepth, 3 * levelsFor(n) + 8);

  tree.nodes = std::vector<BvhNode>(2 * std::size_t{n} - 1);
  tree.nodes[0].parent = kNone;
  // Pairs of siblings are laid out in the order in which a walk that goes left first opens their parents.
  std::uint32_t used = 1;
  std::vector<Task> stack{{0, 0, n, 1}};
  while (!stack.empty()) {
    const Task task = stack.back();
    stack.pop_back();
    tree.depth = std::max(tree.depth, task.depth);
    BvhNode& node = tree.nodes[task.node];
    const TriangleSet set{boxes.data() + task.begin, triangles.data() + task.begin, roomForBoxes.data(),
                          roomForTriangles.data(), task.count};
    MeshBox box, centers;
    for (std::uint32_t i = 0; i < set.size; ++i) {
      box.grow(set.boxes[i]);
      centers.grow(set.boxes[i].middle());
    }
    enclose(box, mesh.origin(), node);
    if (set.size == 1) {
      node.child = static_cast<std::int32_t>(~set.triangles[0]);
      continue;
    }
    std::uint32_t left = 0;
    // Free splits as long as halving would still fit below the worst of them.
    if (task.depth + levelsFor(set.size) < depthLimit) {
      left = strategy == BuildStrategy::kMeanSplit ? splitAtMean(set) : splitBySah(set, centers);
    }
    if (left == 0) left = splitInHalves(set, centers);
    node.child = static_cast<std::int32_t>(used);
    tree.nodes[used].parent = tree.nodes[used + 1].parent = task.node;
    stack.push_back({used + 1, task.begin + left, task.count - left, task.depth + 1});
    stack.push_back({used, task.begin, left, task.depth + 1});
    used += 2;
  }
  return tree;
}

}  // namespace otg
