// SPDX-License-Identifier: BSD-3-Clause
#include "bvh/packed_tree.h"

#include <algorithm>
#include <queue>
#include <utility>

#include "bvh/collapse_tree.h"

namespace otg {
namespace {

float areaOf(const Vec3f& extent) {
  return extent.x * extent.y + extent.y * extent.z + extent.z * extent.x;
}

/// Triangles below each node of the binary tree. Children follow their parents.
std::vector<std::uint32_t> countTriangles(const BinaryTree& tree) {
  std::vector<std::uint32_t> counts(tree.nodes.size(), 1);
  for (std::size_t i = tree.nodes.size(); i-- > 0;) {
    const BvhNode& n = tree.nodes[i];
    if (!n.isLeaf()) counts[i] = counts[n.child] + counts[n.child + 1];
  }
  return counts;
}

class Packer {
 public:
  Packer(const BinaryTree& tree, std::uint32_t leafTriangles, std::vector<std::uint32_t>* binaryNodes)
      : tree_(tree),
        leafTriangles_(leafTriangles),
        binaryNodes_(binaryNodes),
        counts_(countTriangles(tree)),
        collapse_(tree, [this](std::size_t n) { return endsAt(n); }) {}

  PackedTree run() {
    out_.triangles.reserve((tree_.nodes.size() + 1) / 2);
    out_.nodes.push_back({});
    std::vector<Task> stack{{0, 0, 1}};
    while (!stack.empty()) {
      const Task task = stack.back();
      stack.pop_back();
      out_.depth = std::max(out_.depth, task.depth);
      if (binaryNodes_ != nullptr) {
        binaryNodes_->resize(out_.nodes.size());
        (*binaryNodes_)[task.packed] = static_cast<std::uint32_t>(task.binary);
      }
      out_.nodes[task.packed].center = tree_.nodes[task.binary].center;
      out_.nodes[task.packed].extent = tree_.nodes[task.binary].extent;
      if (endsAt(static_cast<std::size_t>(task.binary))) {
        out_.nodes[task.packed].first = static_cast<std::int32_t>(out_.triangles.size());
        out_.nodes[task.packed].count = -static_cast<std::int32_t>(counts_[task.binary]);
        addTriangles(task.binary);
        continue;
      }
      std::int32_t slots[kPackedArity];
      const auto count = static_cast<std::uint32_t>(collapse_.childrenOf(task.binary, slots));
      const std::size_t first = out_.nodes.size();
      out_.nodes[task.packed].first = static_cast<std::int32_t>(first);
      out_.nodes[task.packed].count = static_cast<std::int32_t>(count);
      out_.nodes.resize(first + count);
      for (std::uint32_t k = count; k-- > 0;) stack.push_back({slots[k], first + k, task.depth + 1});
    }
    return std::move(out_);
  }

 private:
  struct Task {
    std::int32_t binary;
    std::size_t packed;
    std::uint32_t depth;
  };

  bool endsAt(std::size_t binary) const { return counts_[binary] <= leafTriangles_; }

  void addTriangles(std::int32_t binary) {
    std::vector<std::int32_t>& stack = leafStack_;
    stack.assign(1, binary);
    while (!stack.empty()) {
      const BvhNode& n = tree_.nodes[stack.back()];
      stack.pop_back();
      if (n.isLeaf()) {
        out_.triangles.push_back(n.triangle());
      } else {
        stack.push_back(n.child + 1);
        stack.push_back(n.child);
      }
    }
  }

  const BinaryTree& tree_;
  const std::uint32_t leafTriangles_;
  std::vector<std::uint32_t>* const binaryNodes_;
  const std::vector<std::uint32_t> counts_;
  const TreeCollapse collapse_;
  std::vector<std::int32_t> leafStack_;
  PackedTree out_;
};

std::vector<std::uint32_t> makeCut(const PackedTree& tree) {
  // Largest area first, ties by number. Areas of huge boxes may be infinite, never NaN.
  using Entry = std::pair<float, std::uint32_t>;
  const auto later = [](const Entry& x, const Entry& y) {
    return x.first != y.first ? x.first < y.first : x.second > y.second;
  };
  std::priority_queue<Entry, std::vector<Entry>, decltype(later)> open(later);
  std::vector<std::uint32_t> cut;
  const auto add = [&](std::uint32_t node) {
    if (tree.nodes[node].isLeaf()) {
      cut.push_back(node);
    } else {
      open.push({areaOf(tree.nodes[node].extent), node});
    }
  };
  add(0);
  while (!open.empty()) {
    const std::uint32_t node = open.top().second;
    const auto children = static_cast<std::uint32_t>(tree.nodes[node].count);
    if (cut.size() + open.size() - 1 + children > kMaxCutNodes) break;
    open.pop();
    for (std::uint32_t k = 0; k < children; ++k) add(static_cast<std::uint32_t>(tree.nodes[node].first) + k);
  }
  for (; !open.empty(); open.pop()) cut.push_back(open.top().second);
  // Fisher and Yates with a linear congruential generator: the same order everywhere.
  std::uint32_t state = 1;
  for (std::size_t i = cut.size(); i > 1; --i) {
    state = state * 1664525u + 1013904223u;
    std::swap(cut[i - 1], cut[(std::uint64_t{state} * i) >> 32]);
  }
  return cut;
}

}  // namespace

PackedTree makePackedTree(const BinaryTree& tree, std::uint32_t leafTriangles,
                          std::vector<std::uint32_t>* binaryNodes) {
  if (binaryNodes != nullptr) binaryNodes->clear();
  if (tree.nodes.empty()) return {};
  PackedTree packed = Packer(tree, leafTriangles, binaryNodes).run();
  packed.cut = makeCut(packed);
  return packed;
}

}  // namespace otg
