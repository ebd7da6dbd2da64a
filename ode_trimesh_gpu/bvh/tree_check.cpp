// SPDX-License-Identifier: BSD-3-Clause
#include "bvh/tree_check.h"

#include <algorithm>
#include <cstddef>
#include <cstring>

namespace otg {
namespace {

constexpr unsigned kTooDeep = 200;
static_assert(kTooDeep > kMaxTreeDepth && kTooDeep < 256);

/// Two numbers at a time: an exponent of ones carries into the place of the sign when kOne is added to the rest.
constexpr std::uint64_t kRest = 0x7fffffff7fffffffu, kOne = 0x0080000000800000u;

std::uint64_t carriesOf(const BvhNode& node) {
  static_assert(offsetof(BvhNode, child) == 24);
  const auto pair = [&](std::size_t k) {
    std::uint64_t numbers;
    std::memcpy(&numbers, reinterpret_cast<const unsigned char*>(&node) + 8 * k, sizeof numbers);
    return (numbers & kRest) + kOne;
  };
  return pair(0) | pair(1) | pair(2);
}

}  // namespace

TreeCheck::TreeCheck(const Array<BvhNode>& nodes, std::size_t triangles)
    : nodes_(nodes), triangles_(triangles), sizeMatches_(nodes.size() == (triangles == 0 ? 0 : 2 * triangles - 1)) {
  if (!sizeMatches_) return;
  depth_.resize(nodes.size());
  seen_.assign(triangles + 1, 0);
}

/// Whether a node is a leaf cannot be foretold, hence no branch on it.
void TreeCheck::nodes(std::size_t begin, std::size_t end) {
  if (!sizeMatches_) return;
  const BvhNode* const nodes = nodes_.data();
  const auto triangles = static_cast<std::uint32_t>(triangles_);
  std::uint8_t *const depth = depth_.data(), *const seen = seen_.data();
  std::size_t inner = 0;
  unsigned bad = 0, deepest = deepest_;
  std::uint64_t carried = 0;
  if (begin == 0 && end > 0) {
    bad |= nodes[0].parent ^ kNone;
    depth[0] = 1;
    inner += nodes[0].child >= 0;
    ++seen[std::min(nodes[0].triangle(), triangles)];
    carried |= carriesOf(nodes[0]);
    begin = 1;
  }
  for (std::size_t i = begin; i < end; ++i) {
    const BvhNode& node = nodes[i];
    inner += node.child >= 0;
    ++seen[std::min(node.triangle(), triangles)];  // of an inner node, a number that no triangle has
    carried |= carriesOf(node);
    const auto parent = static_cast<std::uint32_t>(std::min<std::size_t>(node.parent, i - 1));
    const auto firstOfPair = static_cast<std::uint32_t>((i - 1) | 1);
    bad |= (parent ^ node.parent) | (static_cast<std::uint32_t>(nodes[parent].child) ^ firstOfPair);
    const unsigned here = std::min(depth[parent] + 1u, kTooDeep);
    depth[i] = static_cast<std::uint8_t>(here);
    deepest = std::max(deepest, here);
  }
  inner_ += inner;
  bad_ |= bad;
  deepest_ = deepest;
  carried_ |= carried;
}

std::string TreeCheck::fault(std::uint32_t depth) const {
  if (!sizeMatches_) return "a tree of another size";
  if (triangles_ == 0) return depth == 0 ? std::string() : "a tree of another depth";
  // Each node but the root is a child of one before it. So many nodes are twice as many as there are inner ones, each
  // of which therefore has both its children to itself.
  if (bad_ != 0 || inner_ != triangles_ - 1) return "nodes that do not make a tree";
  if (std::any_of(seen_.begin(), seen_.end() - 1, [](std::uint8_t leaves) { return leaves != 1; })) {
    return "a triangle without a leaf";
  }
  if (deepest_ != depth || deepest_ > kMaxTreeDepth) return "a tree of another depth";
  return (carried_ & ~kRest) == 0 ? std::string() : "a box that is not finite";
}

}  // namespace otg
