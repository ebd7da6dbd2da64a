// SPDX-License-Identifier: BSD-3-Clause
#include "bvh/wide_tree.h"

#include <algorithm>
#include <limits>

#include "bvh/collapse_tree.h"

namespace otg {
namespace {

void setLane(WideNode& node, int lane, const Vec3f& center, const Vec3f& extent, std::int32_t child) {
  setBox(node, static_cast<std::uint32_t>(lane), center, extent);
  node.child[lane] = child;
}

}  // namespace

WideTree makeWideTree(const BinaryTree& tree, std::vector<std::uint32_t>* lanes) {
  WideTree out;
  if (lanes != nullptr) lanes->assign(tree.nodes.size(), kNone);
  if (tree.nodes.empty()) return out;
  out.rootCenter = tree.nodes[0].center;
  out.rootExtent = tree.nodes[0].extent;
  struct Task {
    std::int32_t binary;  ///< node of the binary tree whose children, opened, fill the wide node
    std::size_t wide;
    std::uint32_t depth;
  };
  const TreeCollapse collapse(tree, [&](std::size_t n) { return tree.nodes[n].isLeaf(); });
  out.nodes.emplace_back();
  std::vector<Task> stack{{0, 0, 1}};
  while (!stack.empty()) {
    const Task task = stack.back();
    stack.pop_back();
    out.depth = std::max(out.depth, task.depth);
    std::int32_t slots[kWideArity];
    int count = 1;
    if (tree.nodes[task.binary].isLeaf()) {  // a mesh of one triangle
      slots[0] = task.binary;
    } else {
      count = collapse.childrenOf(task.binary, slots);
    }
    for (int k = 0; k < kWideArity; ++k) {
      if (k >= count) {
        // An extent of minus infinity makes every gap plus infinity.
        const float inf = std::numeric_limits<float>::infinity();
        setLane(out.nodes[task.wide], k, {0, 0, 0}, {-inf, -inf, -inf}, 0);
        continue;
      }
      const BvhNode& n = tree.nodes[slots[k]];
      std::int32_t child = n.child;
      if (!n.isLeaf()) {
        child = static_cast<std::int32_t>(out.nodes.size());
        stack.push_back({slots[k], out.nodes.size(), task.depth + 1});
        out.nodes.emplace_back();
      }
      setLane(out.nodes[task.wide], k, n.center, n.extent, child);
      if (lanes != nullptr) (*lanes)[slots[k]] = static_cast<std::uint32_t>(kWideArity * task.wide) + k;
    }
    out.nodes[task.wide].count = count;
  }
  return out;
}

}  // namespace otg
