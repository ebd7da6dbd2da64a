// SPDX-License-Identifier: BSD-3-Clause
// Checks of a binary tree and of the layouts derived from it.
#include <string>

#include "bvh/layouts.h"
#include "bvh/mesh_box.h"
#include "bvh/packed_tree.h"
#include "bvh/wide_tree.h"
#include "shared/math/expansion.h"

namespace otg {
namespace {

/// Whether a - b + c - d >= 0 in exact arithmetic.
bool notNegative(float a, float b, float c, float d) {
  double ab[2], cd[2], sum[4];
  const int terms = otgExpansionSum(otgExactDifference(a, b, ab), ab, otgExactDifference(c, d, cd), cd, sum);
  return sum[terms - 1] >= 0;
}

/// Whether the box in the centred frame contains the one in the mesh's own frame, in exact arithmetic.
bool encloses(const TriMesh& mesh, const Vec3f& center, const Vec3f& extent, const MeshBox& box) {
  const float o[3] = {mesh.origin().x, mesh.origin().y, mesh.origin().z};
  const float c[3] = {center.x, center.y, center.z}, e[3] = {extent.x, extent.y, extent.z};
  for (int k = 0; k < 3; ++k) {
    if (!std::isfinite(c[k]) || !(e[k] >= 0)) return false;
    if (std::isinf(e[k])) continue;
    // lo - origin >= c - e, and c + e >= hi - origin.
    if (!notNegative(box.lo[k], o[k], e[k], c[k]) || !notNegative(c[k], box.hi[k], e[k], -o[k])) return false;
  }
  return true;
}

std::string at(const char* what, std::size_t node) {
  return std::string(what) + " at node " + std::to_string(node);
}

/// Walks a tree's nodes from the last to the first, so that everything below a node has been seen before the node.
class Walk {
 public:
  Walk(const TriMesh& mesh, std::size_t nodes)
      : mesh_(mesh), boxes_(nodes), parents_(nodes, 0), leaves_(mesh.triangleCount(), 0) {}

  /// `node` holds the triangle.
  std::string leaf(std::size_t node, std::uint32_t triangle) {
    if (triangle >= leaves_.size()) return at("triangle out of range", node);
    if (leaves_[triangle]++ != 0) return at("triangle in two leaves", node);
    boxes_[node].grow(boxOfTriangle(mesh_, triangle));
    return {};
  }
  /// `node` has `child` below it.
  std::string child(std::size_t node, std::size_t child) {
    if (child <= node || child >= boxes_.size()) return at("child does not follow its parent", node);
    if (parents_[child]++ != 0) return at("second parent", child);
    boxes_[node].grow(boxes_[child]);
    return {};
  }
  /// The box of everything that was put below `node`.
  const MeshBox& below(std::size_t node) const { return boxes_[node]; }

  /// After all nodes.
  std::string finish() const {
    for (std::size_t i = 1; i < parents_.size(); ++i) {
      if (parents_[i] == 0) return at("no parent", i);
    }
    for (std::size_t t = 0; t < leaves_.size(); ++t) {
      if (leaves_[t] == 0) return "triangle " + std::to_string(t) + " in no leaf";
    }
    return {};
  }

 private:
  const TriMesh& mesh_;
  std::vector<MeshBox> boxes_;
  std::vector<std::uint8_t> parents_, leaves_;
};

/// One node of the layouts whose child is as BvhNode::child.
std::string visitBinary(Walk& walk, std::size_t node, std::int32_t child) {
  if (child < 0) return walk.leaf(node, static_cast<std::uint32_t>(~child));
  const auto first = static_cast<std::size_t>(child);
  std::string error = walk.child(node, first);
  return error.empty() ? walk.child(node, first + 1) : error;
}

bool isPowerOfTwo(float x) {
  int exponent = 0;
  return std::isnormal(x) && std::frexp(x, &exponent) == 0.5f;
}

}  // namespace

std::string validateTree(const BinaryTree& tree, const TriMesh& mesh) {
  const std::size_t n = mesh.triangleCount();
  if (tree.nodes.size() != (n ? 2 * n - 1 : 0)) return "wrong number of nodes";
  if (n == 0) return tree.depth == 0 ? "" : "wrong depth";
  Walk walk(mesh, tree.nodes.size());
  for (std::size_t i = tree.nodes.size(); i-- > 0;) {
    const BvhNode& node = tree.nodes[i];
    if (std::string error = visitBinary(walk, i, node.child); !error.empty()) return error;
    if (!node.isLeaf() && (tree.nodes[node.child].parent != i || tree.nodes[node.child + 1].parent != i)) {
      return at("child names another parent", i);
    }
    if (!encloses(mesh, node.center, node.extent, walk.below(i))) return at("box does not enclose", i);
    if (!(std::max({node.extent.x, node.extent.y, node.extent.z}) < MeshBox::kInfinity)) return at("infinite box", i);
  }
  if (std::string error = walk.finish(); !error.empty()) return error;
  if (tree.nodes[0].parent != kNone) return "the root has a parent";
  std::vector<std::uint32_t> depth(tree.nodes.size(), 1);
  for (std::size_t i = 1; i < depth.size(); ++i) depth[i] = depth[tree.nodes[i].parent] + 1;
  const std::uint32_t deepest = *std::max_element(depth.begin(), depth.end());
  if (deepest != tree.depth) return "wrong depth";
  if (deepest > kMaxTreeDepth) return "too deep";
  return {};
}

std::string validateLayout(const QuantizedTree& tree, const TriMesh& mesh) {
  const std::size_t n = mesh.triangleCount();
  if (tree.nodes.size() != (n ? 2 * n - 1 : 0)) return "wrong number of nodes";
  if (n == 0) return {};
  for (const Vec3f& step : {tree.centerStep, tree.extentStep}) {
    if (!isPowerOfTwo(step.x) || !isPowerOfTwo(step.y) || !isPowerOfTwo(step.z)) return "step is not a power of two";
  }
  Walk walk(mesh, tree.nodes.size());
  for (std::size_t i = tree.nodes.size(); i-- > 0;) {
    const QuantizedNode& node = tree.nodes[i];
    if (std::string error = visitBinary(walk, i, node.child); !error.empty()) return error;
    const Vec3f center{node.center[0] * tree.centerStep.x, node.center[1] * tree.centerStep.y,
                       node.center[2] * tree.centerStep.z};
    const Vec3f extent{node.extent[0] * tree.extentStep.x, node.extent[1] * tree.extentStep.y,
                       node.extent[2] * tree.extentStep.z};
    if (!encloses(mesh, center, extent, walk.below(i))) return at("box does not enclose", i);
  }
  return walk.finish();
}

std::string validateLayout(const NoLeafTree& tree, const TriMesh& mesh) {
  const std::size_t n = mesh.triangleCount();
  if (tree.triangleCount != n) return "wrong number of triangles";
  if (tree.nodes.size() != (n ? n - 1 : 0)) return "wrong number of nodes";
  if (n < 2) return {};  // a single triangle is the whole tree
  Walk walk(mesh, tree.nodes.size());
  for (std::size_t i = tree.nodes.size(); i-- > 0;) {
    const NoLeafNode& node = tree.nodes[i];
    for (const std::int32_t side : {node.left, node.right}) {
      std::string error =
          side < 0 ? walk.leaf(i, static_cast<std::uint32_t>(~side)) : walk.child(i, static_cast<std::size_t>(side));
      if (!error.empty()) return error;
    }
    if (!encloses(mesh, node.center, node.extent, walk.below(i))) return at("box does not enclose", i);
  }
  return walk.finish();
}

std::string validateLayout(const WideTree& tree, const TriMesh& mesh) {
  if (tree.nodes.empty() != (mesh.triangleCount() == 0)) return "wrong number of nodes";
  Walk walk(mesh, tree.nodes.size());
  for (std::size_t i = tree.nodes.size(); i-- > 0;) {
    const WideNode& node = tree.nodes[i];
    if (node.count < 1 || node.count > kWideArity) return at("wrong number of children", i);
    for (int k = 0; k < node.count; ++k) {
      const std::int32_t child = node.child[k];
      std::string error =
          child < 0 ? walk.leaf(i, static_cast<std::uint32_t>(~child)) : walk.child(i, static_cast<std::size_t>(child));
      if (!error.empty()) return error;
      const MeshBox box = child < 0 ? boxOfTriangle(mesh, static_cast<std::uint32_t>(~child))
                                    : walk.below(static_cast<std::size_t>(child));
      if (!encloses(mesh, {node.centerX[k], node.centerY[k], node.centerZ[k]},
                    {node.extentX[k], node.extentY[k], node.extentZ[k]}, box)) {
        return at("box does not enclose", i);
      }
    }
    for (int k = node.count; k < kWideArity; ++k) {
      if (!(node.extentX[k] < 0)) return at("unused lane is not inverted", i);
    }
  }
  return walk.finish();
}

std::string validateLayout(const PackedTree& tree, const TriMesh& mesh) {
  const std::size_t n = mesh.triangleCount();
  if (tree.nodes.empty() != (n == 0)) return "wrong number of nodes";
  if (tree.triangles.size() != n) return "wrong number of triangles";
  if (n == 0) return tree.cut.empty() ? "" : "a cut through nothing";
  Walk walk(mesh, tree.nodes.size());
  std::vector<std::uint32_t> below(tree.nodes.size(), 0), depth(tree.nodes.size(), 1);
  for (std::size_t i = tree.nodes.size(); i-- > 0;) {
    const PackedNode& node = tree.nodes[i];
    const auto first = static_cast<std::size_t>(node.first);
    if (node.isLeaf()) {
      const auto count = static_cast<std::size_t>(-node.count);
      if (node.first < 0 || first + count > n) return at("leaf out of range", i);
      for (std::size_t k = 0; k < count; ++k) {
        if (std::string error = walk.leaf(i, tree.triangles[first + k]); !error.empty()) return error;
      }
      below[i] = static_cast<std::uint32_t>(count);
    } else {
      if (node.count < 2 || node.count > static_cast<int>(kPackedArity)) return at("wrong number of children", i);
      for (std::size_t k = 0; k < static_cast<std::size_t>(node.count); ++k) {
        if (std::string error = walk.child(i, first + k); !error.empty()) return error;
        below[i] += below[first + k];
        depth[i] = std::max(depth[i], depth[first + k] + 1);
      }
    }
    if (!encloses(mesh, node.center, node.extent, walk.below(i))) return at("box does not enclose", i);
  }
  if (std::string error = walk.finish(); !error.empty()) return error;
  if (depth[0] != tree.depth) return "wrong depth";
  // A cut holds every triangle once if its nodes have as many below them as the mesh and none is below another.
  if (tree.cut.empty() || tree.cut.size() > kMaxCutNodes) return "wrong size of the cut";
  std::vector<std::uint8_t> inCut(tree.nodes.size(), 0);
  std::size_t held = 0;
  for (const std::uint32_t node : tree.cut) {
    if (node >= tree.nodes.size() || inCut[node]++ != 0) return "a node of the cut is out of range or there twice";
    held += below[node];
  }
  for (std::size_t i = 0; i < tree.nodes.size(); ++i) {
    const PackedNode& node = tree.nodes[i];
    if (node.isLeaf() || inCut[i] == 0) continue;
    for (int k = 0; k < node.count; ++k) {  // marks all that is below: children follow their parents
      const std::size_t number = static_cast<std::size_t>(node.first) + static_cast<std::size_t>(k);
      std::uint8_t& child = inCut[number];
      if (child == 1) return at("a node of the cut is below another", number);
      child = 2;
    }
  }
  return held == n ? "" : "the cut does not hold every triangle once";
}

}  // namespace otg
