// SPDX-License-Identifier: BSD-3-Clause
#include "bvh/wide_tree.h"

#include <algorithm>
#include <array>
#include <limits>

namespace otg {
namespace {

float areaOf(const BvhNode& n) {
  return n.extent.x * n.extent.y + n.extent.y * n.extent.z + n.extent.z * n.extent.x;
}

void setLane(WideNode& node, int lane, const Vec3f& center, const Vec3f& extent, std::int32_t child) {
  setBox(node, static_cast<std::uint32_t>(lane), center, extent);
  node.child[lane] = child;
}

/// Which nodes of the binary tree become wide ones, such that the sum of their surface areas is least. Source: H.
/// Ylitie, T. Karras, S. Laine, "Efficient Incoherent Ray Traversal on GPUs Through Compressed Wide BVHs", 2017,
/// section 3.
class Collapse {
 public:
  explicit Collapse(const BinaryTree& tree) : tree_(tree), costs_(tree.nodes.size()) {
    for (std::size_t n = tree.nodes.size(); n-- > 0;) {
      if (tree.nodes[n].isLeaf()) continue;
      Costs& cost = costs_[n];
      const Costs &left = costs_[tree.nodes[n].child], &right = costs_[tree.nodes[n].child + 1];
      cost[0] = areaOf(tree.nodes[n]) + sharedCost(left, right, kWideArity);
      for (int most = 2; most < kWideArity; ++most) {
        cost[most - 1] = std::min(cost[most - 2], sharedCost(left, right, most));
      }
    }
  }

  /// The children of the wide node that stands for an inner node.
  int childrenOf(std::int32_t node, std::int32_t* slots) const {
    int count = 0;
    share(node, kWideArity, slots, count);
    return count;
  }

 private:
  /// [i]: least area of the wide nodes of a subtree that takes i + 1 lanes of the node above, or fewer.
  using Costs = std::array<float, kWideArity - 1>;

  static float sharedCost(const Costs& left, const Costs& right, int lanes) {
    float least = left[0] + right[lanes - 2];
    for (int k = 1; k < lanes - 1; ++k) least = std::min(least, left[k] + right[lanes - 2 - k]);
    return least;
  }

  void split(std::int32_t node, int lanes, std::int32_t* slots, int& count) const {
    if (!tree_.nodes[node].isLeaf()) {
      const Costs& cost = costs_[node];
      while (lanes > 1 && cost[lanes - 1] == cost[lanes - 2]) --lanes;
      if (lanes > 1) {
        share(node, lanes, slots, count);
        return;
      }
    }
    slots[count++] = node;
  }

  void share(std::int32_t node, int lanes, std::int32_t* slots, int& count) const {
    const std::int32_t left = tree_.nodes[node].child, right = left + 1;
    int best = 1;
    const auto costOf = [&](int k) { return costs_[left][k - 1] + costs_[right][lanes - 1 - k]; };
    for (int k = 2; k < lanes; ++k) {
      if (costOf(k) < costOf(best)) best = k;
    }
    split(left, best, slots, count);
    split(right, lanes - best, slots, count);
  }

  const BinaryTree& tree_;
  std::vector<Costs> costs_;  ///< zero for leaves
};

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
  const Collapse collapse(tree);
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
