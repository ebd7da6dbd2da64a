// SPDX-License-Identifier: BSD-3-Clause
// Top-down construction of the binary tree by either strategy.
#include <algorithm>
#include <array>

#include "bvh/triangle_boxes.h"

namespace otg {
namespace {

/// A triangle on its way into the tree.
struct Primitive {
  Bounds box;
  double center[3];
  std::uint32_t triangle;
};

/// Triangles begin..end - 1 become the subtree at `node`.
struct Task {
  std::uint32_t node, begin, end, depth;
};

/// log2 rounded up: levels that halving needs for n leaves.
std::uint32_t levelsFor(std::uint32_t n) {
  std::uint32_t levels = 0;
  while ((std::uint64_t{1} << levels) < n) ++levels;
  return levels;
}

Bounds centerBounds(const Primitive* p, std::uint32_t n) {
  Bounds b;
  for (std::uint32_t i = 0; i < n; ++i) {
    for (int k = 0; k < 3; ++k) {
      b.lo[k] = std::min(b.lo[k], p[i].center[k]);
      b.hi[k] = std::max(b.hi[k], p[i].center[k]);
    }
  }
  return b;
}

/// Halves by order along the widest axis of the centres; ties by triangle number, so equal centres split too.
std::uint32_t splitInHalves(Primitive* p, std::uint32_t n) {
  const Bounds b = centerBounds(p, n);
  int axis = 0;
  for (int k = 1; k < 3; ++k) {
    if (b.hi[k] - b.lo[k] > b.hi[axis] - b.lo[axis]) axis = k;
  }
  std::nth_element(p, p + n / 2, p + n, [axis](const Primitive& x, const Primitive& y) {
    return x.center[axis] != y.center[axis] ? x.center[axis] < y.center[axis] : x.triangle < y.triangle;
  });
  return n / 2;
}

/// The published rule: axis of greatest variance of the box centres, split at their mean. 0 when a side would be empty.
std::uint32_t splitAtMean(Primitive* p, std::uint32_t n) {
  double mean[3] = {0, 0, 0}, variance[3] = {0, 0, 0};
  for (std::uint32_t i = 0; i < n; ++i) {
    for (int k = 0; k < 3; ++k) mean[k] += p[i].center[k];
  }
  for (double& m : mean) m /= n;
  for (std::uint32_t i = 0; i < n; ++i) {
    for (int k = 0; k < 3; ++k) variance[k] += (p[i].center[k] - mean[k]) * (p[i].center[k] - mean[k]);
  }
  const auto axis = static_cast<int>(std::max_element(variance, variance + 3) - variance);
  const Primitive* middle = std::partition(p, p + n, [&](const Primitive& x) { return x.center[axis] < mean[axis]; });
  const auto left = static_cast<std::uint32_t>(middle - p);
  return left == n ? 0 : left;
}

/// Binned surface-area heuristic over all three axes. 0 when all centres coincide.
/// Source of the method: I. Wald, "On fast Construction of SAH-based Bounding Volume Hierarchies", 2007.
std::uint32_t splitBySah(Primitive* p, std::uint32_t n) {
  constexpr int kBins = 16;
  struct Bin {
    Bounds box;
    std::uint32_t count = 0;
  };
  const Bounds range = centerBounds(p, n);
  double scale[3];
  for (int k = 0; k < 3; ++k) {
    const double width = range.hi[k] - range.lo[k];
    scale[k] = width > 0 ? kBins / width : 0;
  }
  const auto binOf = [&](const Primitive& x, int k) {
    return std::min(kBins - 1, static_cast<int>((x.center[k] - range.lo[k]) * scale[k]));
  };
  std::array<std::array<Bin, kBins>, 3> bins{};
  for (std::uint32_t i = 0; i < n; ++i) {
    for (int k = 0; k < 3; ++k) {
      Bin& bin = bins[k][binOf(p[i], k)];
      bin.box.grow(p[i].box);
      ++bin.count;
    }
  }
  double bestCost = std::numeric_limits<double>::infinity();
  int bestAxis = -1, bestSplit = 0;
  for (int k = 0; k < 3; ++k) {
    if (!(scale[k] > 0) || !std::isfinite(scale[k])) continue;
    double rightCost[kBins];
    Bounds box;
    std::uint32_t count = 0;
    for (int i = kBins - 1; i > 0; --i) {
      box.grow(bins[k][i].box);
      count += bins[k][i].count;
      rightCost[i] = count ? count * box.halfArea() : -1;
    }
    box = {};
    count = 0;
    for (int i = 1; i < kBins; ++i) {
      box.grow(bins[k][i - 1].box);
      count += bins[k][i - 1].count;
      if (count == 0 || rightCost[i] < 0) continue;
      const double cost = count * box.halfArea() + rightCost[i];
      if (cost < bestCost) {
        bestCost = cost;
        bestAxis = k;
        bestSplit = i;
      }
    }
  }
  if (bestAxis < 0) return 0;
  const Primitive* middle =
      std::partition(p, p + n, [&](const Primitive& x) { return binOf(x, bestAxis) < bestSplit; });
  return static_cast<std::uint32_t>(middle - p);
}

std::vector<Primitive> primitivesOf(const TriMesh& mesh) {
  std::vector<Primitive> primitives(mesh.triangleCount());
  for (std::uint32_t t = 0; t < primitives.size(); ++t) {
    Primitive& p = primitives[t];
    p.box = boundsOf(mesh, t);
    p.triangle = t;
    for (int k = 0; k < 3; ++k) p.center[k] = 0.5 * p.box.lo[k] + 0.5 * p.box.hi[k];
  }
  return primitives;
}

}  // namespace

BinaryTree buildTree(const TriMesh& mesh, BuildStrategy strategy) {
  BinaryTree tree;
  tree.strategy = strategy;
  if (mesh.triangleCount() == 0) return tree;
  std::vector<Primitive> primitives = primitivesOf(mesh);
  const auto n = static_cast<std::uint32_t>(primitives.size());
  tree.nodes.resize(2 * std::size_t{n} - 1);
  tree.nodes[0].parent = kNone;
  std::uint32_t used = 1;
  std::vector<Task> stack{{0, 0, n, 1}};
  while (!stack.empty()) {
    const Task task = stack.back();
    stack.pop_back();
    tree.depth = std::max(tree.depth, task.depth);
    BvhNode& node = tree.nodes[task.node];
    const std::uint32_t count = task.end - task.begin;
    if (count == 1) {
      node.child = static_cast<std::int32_t>(~primitives[task.begin].triangle);
      continue;
    }
    Primitive* first = primitives.data() + task.begin;
    std::uint32_t left = 0;
    // Once halving would just fit into what is left of the depth, halve.
    if (task.depth + levelsFor(count) < kMaxTreeDepth) {
      left = strategy == BuildStrategy::kMeanSplit ? splitAtMean(first, count) : splitBySah(first, count);
    }
    if (left == 0) left = splitInHalves(first, count);
    node.child = static_cast<std::int32_t>(used);
    for (std::uint32_t k = 0; k < 2; ++k) tree.nodes[used + k].parent = task.node;
    stack.push_back({used + 1, task.begin + left, task.end, task.depth + 1});
    stack.push_back({used, task.begin, task.begin + left, task.depth + 1});
    used += 2;
  }
  refitTree(tree, mesh);
  return tree;
}

}  // namespace otg
