// SPDX-License-Identifier: BSD-3-Clause
// Checks of a binary tree and of the layouts derived from it.
#include <string>

#include "bvh/layouts.h"
#include "bvh/triangle_boxes.h"
#include "bvh/wide_tree.h"

namespace otg {
namespace {

bool encloses(const Vec3f& center, const Vec3f& extent, const Bounds& b) {
  const double c[3] = {center.x, center.y, center.z}, e[3] = {extent.x, extent.y, extent.z};
  for (int k = 0; k < 3; ++k) {
    if (!(c[k] - e[k] <= b.lo[k] && b.hi[k] <= c[k] + e[k])) return false;
  }
  return true;
}

std::string at(const char* what, std::size_t node) {
  return std::string(what) + " at node " + std::to_string(node);
}

/// Each of n triangles exactly once.
class LeafCheck {
 public:
  explicit LeafCheck(std::size_t n) : seen_(n, 0) {}
  std::string add(std::uint32_t triangle, std::size_t node) {
    if (triangle >= seen_.size()) return at("triangle out of range", node);
    if (seen_[triangle]++) return at("triangle in two leaves", node);
    return {};
  }
  std::string finish() const {
    for (std::size_t t = 0; t < seen_.size(); ++t) {
      if (!seen_[t]) return "triangle " + std::to_string(t) + " in no leaf";
    }
    return {};
  }

 private:
  std::vector<std::uint8_t> seen_;
};

}  // namespace

std::string validateTree(const BinaryTree& tree, const TriMesh& mesh) {
  const std::size_t n = mesh.triangleCount();
  if (tree.nodes.size() != (n ? 2 * n - 1 : 0)) return "wrong number of nodes";
  if (n == 0) return tree.depth == 0 ? "" : "an empty tree has depth 0";
  LeafCheck leaves(n);
  std::vector<Bounds> bounds(tree.nodes.size());
  std::vector<std::uint32_t> depth(tree.nodes.size(), 0);
  if (tree.nodes[0].parent != kNone) return "the root has a parent";
  depth[0] = 1;
  std::uint32_t deepest = 1;
  for (std::size_t i = 0; i < tree.nodes.size(); ++i) {
    const BvhNode& node = tree.nodes[i];
    if (depth[i] == 0) return at("unreachable", i);
    deepest = std::max(deepest, depth[i]);
    if (node.isLeaf()) {
      if (std::string error = leaves.add(node.triangle(), i); !error.empty()) return error;
      continue;
    }
    const auto child = static_cast<std::size_t>(node.child);
    if (child <= i || child + 1 >= tree.nodes.size()) return at("children do not follow", i);
    for (std::size_t c = child; c < child + 2; ++c) {
      if (depth[c] != 0) return at("two parents", c);
      if (tree.nodes[c].parent != i) return at("wrong parent", c);
      depth[c] = depth[i] + 1;
    }
  }
  if (std::string error = leaves.finish(); !error.empty()) return error;
  if (deepest != tree.depth) return "wrong depth";
  if (deepest > kMaxTreeDepth) return "too deep";
  for (std::size_t i = tree.nodes.size(); i-- > 0;) {
    const BvhNode& node = tree.nodes[i];
    if (node.isLeaf()) {
      bounds[i] = boundsOf(mesh, node.triangle());
    } else {
      bounds[i] = bounds[node.child];
      bounds[i].grow(bounds[node.child + 1]);
    }
    if (!encloses(node.center, node.extent, bounds[i])) return at("box does not enclose", i);
  }
  return {};
}

std::string validateLayout(const QuantizedTree& tree, const TriMesh& mesh) {
  const std::size_t n = mesh.triangleCount();
  if (tree.nodes.size() != (n ? 2 * n - 1 : 0)) return "wrong number of nodes";
  LeafCheck leaves(n);
  std::vector<Bounds> bounds(tree.nodes.size());
  for (std::size_t i = tree.nodes.size(); i-- > 0;) {
    const QuantizedNode& node = tree.nodes[i];
    if (node.child < 0) {
      const auto triangle = static_cast<std::uint32_t>(~node.child);
      if (std::string error = leaves.add(triangle, i); !error.empty()) return error;
      bounds[i] = boundsOf(mesh, triangle);
    } else {
      const auto child = static_cast<std::size_t>(node.child);
      if (child <= i || child + 1 >= tree.nodes.size()) return at("children do not follow", i);
      bounds[i] = bounds[child];
      bounds[i].grow(bounds[child + 1]);
    }
    const Vec3f center{node.center[0] * tree.centerStep.x, node.center[1] * tree.centerStep.y,
                       node.center[2] * tree.centerStep.z};
    const Vec3f extent{node.extent[0] * tree.extentStep.x, node.extent[1] * tree.extentStep.y,
                       node.extent[2] * tree.extentStep.z};
    if (!encloses(center, extent, bounds[i])) return at("box does not enclose", i);
  }
  return leaves.finish();
}

std::string validateLayout(const NoLeafTree& tree, const TriMesh& mesh) {
  const std::size_t n = mesh.triangleCount();
  if (tree.triangleCount != n) return "wrong number of triangles";
  if (tree.nodes.size() != (n ? n - 1 : 0)) return "wrong number of nodes";
  LeafCheck leaves(n);
  if (n == 1) return {};  // the one triangle is the tree
  std::vector<Bounds> bounds(tree.nodes.size());
  for (std::size_t i = tree.nodes.size(); i-- > 0;) {
    const NoLeafNode& node = tree.nodes[i];
    for (const std::int32_t side : {node.left, node.right}) {
      if (side < 0) {
        const auto triangle = static_cast<std::uint32_t>(~side);
        if (std::string error = leaves.add(triangle, i); !error.empty()) return error;
        bounds[i].grow(boundsOf(mesh, triangle));
      } else {
        if (static_cast<std::size_t>(side) <= i || static_cast<std::size_t>(side) >= tree.nodes.size()) {
          return at("children do not follow", i);
        }
        bounds[i].grow(bounds[side]);
      }
    }
    if (!encloses(node.center, node.extent, bounds[i])) return at("box does not enclose", i);
  }
  return leaves.finish();
}

std::string validateLayout(const WideTree& tree, const TriMesh& mesh) {
  const std::size_t n = mesh.triangleCount();
  if (tree.nodes.empty() != (n == 0)) return "wrong number of nodes";
  LeafCheck leaves(n);
  std::vector<Bounds> bounds(tree.nodes.size());
  std::vector<std::uint8_t> parents(tree.nodes.size(), 0);
  for (std::size_t i = tree.nodes.size(); i-- > 0;) {
    const WideNode& node = tree.nodes[i];
    if (node.count < 1 || node.count > kWideArity) return at("wrong number of children", i);
    for (int k = 0; k < node.count; ++k) {
      Bounds box;
      if (node.child[k] < 0) {
        const auto triangle = static_cast<std::uint32_t>(~node.child[k]);
        if (std::string error = leaves.add(triangle, i); !error.empty()) return error;
        box = boundsOf(mesh, triangle);
      } else {
        const auto child = static_cast<std::size_t>(node.child[k]);
        if (child <= i || child >= tree.nodes.size()) return at("children do not follow", i);
        if (parents[child]++) return at("two parents", child);
        box = bounds[child];
      }
      if (!encloses({node.centerX[k], node.centerY[k], node.centerZ[k]},
                    {node.extentX[k], node.extentY[k], node.extentZ[k]}, box)) {
        return at("box does not enclose", i);
      }
      bounds[i].grow(box);
    }
    for (int k = node.count; k < kWideArity; ++k) {
      if (!(node.extentX[k] < 0)) return at("unused lane is not inverted", i);
    }
  }
  return leaves.finish();
}

}  // namespace otg
