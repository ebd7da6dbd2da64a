// SPDX-License-Identifier: BSD-3-Clause
// The validators find each kind of damage.
#include "bvh/collision_mesh.h"
#include "support/catch.h"
#include "support/mesh_samples.h"

using namespace otg;
using namespace otg::samples;

namespace {

bool says(const std::string& error, const std::string& words) {
  INFO("expected \"" << words << "\", got \"" << error << "\"");
  CHECK(error.find(words) != std::string::npos);
  return error.find(words) != std::string::npos;
}

/// Boxes that enclose everything, for damage that would show in the boxes first.
void widen(BinaryTree& tree) {
  for (BvhNode& node : tree.nodes) node.extent = {100, 100, 100};
}
void widen(QuantizedTree& tree) {
  tree.extentStep = {1, 1, 1};
  for (QuantizedNode& node : tree.nodes) std::fill(node.extent, node.extent + 3, std::uint16_t{100});
}
void widen(NoLeafTree& tree) {
  for (NoLeafNode& node : tree.nodes) node.extent = {100, 100, 100};
}
void widen(WideTree& tree) {
  for (WideNode& node : tree.nodes) {
    for (float* extent : {node.extentX, node.extentY, node.extentZ}) std::fill(extent, extent + node.count, 100.0f);
  }
}

struct Damage {
  MeshPtr mesh = scenes::build(scenes::makeSphere(1.0, 2));
  BinaryTree tree = buildTree(*mesh, BuildStrategy::kSah);
  std::size_t leaf = 0, inner = 0, otherInner = 0;  ///< neither inner node is the root
  Damage() {
    for (std::size_t i = 1; i < tree.nodes.size(); ++i) {
      if (tree.nodes[i].isLeaf()) {
        leaf = i;
      } else {
        otherInner = inner;
        inner = i;
      }
    }
  }
};

}  // namespace

TEST_CASE("damage to a binary tree is found") {
  Damage d;
  REQUIRE(validateTree(d.tree, *d.mesh) == "");
  Array<BvhNode>& nodes = d.tree.nodes;
  const std::uint32_t other = (nodes[d.leaf].triangle() + 1) % 320;
  SECTION("a node is missing") {
    nodes = std::vector<BvhNode>(nodes.begin(), nodes.end() - 1);
    REQUIRE(says(validateTree(d.tree, *d.mesh), "wrong number of nodes"));
  }
  SECTION("a tree for another mesh") {
    REQUIRE(says(validateTree(d.tree, *scenes::build({})), "wrong number of nodes"));
    REQUIRE(says(validateTree({{}, 1, BuildStrategy::kSah}, *scenes::build({})), "wrong depth"));
  }
  SECTION("a triangle twice") {
    widen(d.tree);
    nodes[d.leaf].child = static_cast<std::int32_t>(~other);
    REQUIRE(says(validateTree(d.tree, *d.mesh), "two leaves"));
  }
  SECTION("a triangle out of range") {
    widen(d.tree);
    nodes[d.leaf].child = static_cast<std::int32_t>(~std::uint32_t{320});
    REQUIRE(says(validateTree(d.tree, *d.mesh), "triangle out of range"));
  }
  SECTION("a child before its parent") {
    nodes[d.inner].child = 1;
    REQUIRE(says(validateTree(d.tree, *d.mesh), "does not follow"));
  }
  SECTION("a child that is the node itself") {
    nodes[d.inner].child = static_cast<std::int32_t>(d.inner);
    REQUIRE(says(validateTree(d.tree, *d.mesh), "does not follow"));
  }
  SECTION("a child past the end") {
    nodes[d.inner].child = static_cast<std::int32_t>(nodes.size() - 1);
    REQUIRE(says(validateTree(d.tree, *d.mesh), "does not follow"));
  }
  SECTION("two parents for one child") {
    widen(d.tree);
    nodes[d.otherInner].child = nodes[d.inner].child;
    REQUIRE(says(validateTree(d.tree, *d.mesh), "second parent"));
  }
  SECTION("a wrong way up") {
    widen(d.tree);
    nodes[d.leaf].parent = 0;
    REQUIRE(says(validateTree(d.tree, *d.mesh), "another parent"));
  }
  SECTION("a root with a parent") {
    nodes[0].parent = 1;
    REQUIRE(says(validateTree(d.tree, *d.mesh), "root has a parent"));
  }
  SECTION("a wrong depth") {
    ++d.tree.depth;
    REQUIRE(says(validateTree(d.tree, *d.mesh), "wrong depth"));
  }
  SECTION("a box moved by its own width") {
    nodes[d.leaf].center.x += 2 * nodes[d.leaf].extent.x;
    REQUIRE(says(validateTree(d.tree, *d.mesh), "does not enclose"));
  }
  SECTION("an inner box too small by little") {
    // The step up that the build adds, and once more.
    for (int i = 0; i < 2; ++i) nodes[d.inner].extent.z = std::nextafter(nodes[d.inner].extent.z, 0.0f);
    REQUIRE(says(validateTree(d.tree, *d.mesh), "does not enclose"));
  }
  SECTION("a box that is not a number") {
    nodes[d.leaf].extent.y = std::numeric_limits<float>::quiet_NaN();
    REQUIRE(says(validateTree(d.tree, *d.mesh), "does not enclose"));
    nodes[d.leaf].extent.y = 1;
    nodes[d.leaf].center.y = std::numeric_limits<float>::quiet_NaN();
    REQUIRE(says(validateTree(d.tree, *d.mesh), "does not enclose"));
  }
  SECTION("a box without end") {
    nodes[d.leaf].extent.y = std::numeric_limits<float>::infinity();
    REQUIRE(says(validateTree(d.tree, *d.mesh), "infinite box"));
  }
}

TEST_CASE("a tree that is too deep is found") {
  // A chain: each inner node has a leaf and the next inner node below it.
  Soup soup;
  for (std::uint32_t i = 0; i < kMaxTreeDepth + 4; ++i) soup.addAt({static_cast<float>(i), 0, 0}, 0.5f);
  const MeshPtr mesh = soup.build();
  const auto n = static_cast<std::uint32_t>(mesh->triangleCount());
  BinaryTree tree;
  tree.nodes = std::vector<BvhNode>(2 * std::size_t{n} - 1);
  tree.nodes[0].parent = kNone;
  for (std::uint32_t i = 0, at = 0; i + 1 < n; ++i) {
    const std::uint32_t child = 2 * i + 1;
    tree.nodes[at].child = static_cast<std::int32_t>(child);
    tree.nodes[child].parent = tree.nodes[child + 1].parent = at;
    tree.nodes[child].child = static_cast<std::int32_t>(~i);
    tree.nodes[child + 1].child = static_cast<std::int32_t>(~(i + 1));
    at = child + 1;
  }
  refitTree(tree, *mesh);
  tree.depth = n;
  REQUIRE(says(validateTree(tree, *mesh), "too deep"));
}

TEST_CASE("damage to a quantised tree is found") {
  Damage d;
  QuantizedTree tree = quantizeTree(d.tree);
  REQUIRE(validateLayout(tree, *d.mesh) == "");
  SECTION("a node is missing") {
    tree.nodes.pop_back();
    REQUIRE(says(validateLayout(tree, *d.mesh), "wrong number of nodes"));
  }
  SECTION("a triangle twice") {
    widen(tree);
    tree.nodes[d.leaf].child = static_cast<std::int32_t>(~((d.tree.nodes[d.leaf].triangle() + 1) % 320));
    REQUIRE(says(validateLayout(tree, *d.mesh), "two leaves"));
  }
  SECTION("two parents for one child") {
    widen(tree);
    tree.nodes[d.otherInner].child = tree.nodes[d.inner].child;
    REQUIRE(says(validateLayout(tree, *d.mesh), "second parent"));
  }
  SECTION("a child before its parent") {
    tree.nodes[d.inner].child = 0;
    REQUIRE(says(validateLayout(tree, *d.mesh), "does not follow"));
  }
  SECTION("a step that is no power of two") {
    tree.extentStep.y *= 1.5f;
    REQUIRE(says(validateLayout(tree, *d.mesh), "power of two"));
  }
  SECTION("a box too small by one step") {
    // The root of a sphere touches all six sides; two steps, because the last one may be slack.
    tree.nodes[0].extent[1] = static_cast<std::uint16_t>(tree.nodes[0].extent[1] - 2);
    REQUIRE(says(validateLayout(tree, *d.mesh), "does not enclose"));
  }
  SECTION("a box moved") {
    tree.nodes[d.inner].center[2] = static_cast<std::int16_t>(-tree.nodes[d.inner].center[2] + 9);
    REQUIRE(says(validateLayout(tree, *d.mesh), "does not enclose"));
  }
}

TEST_CASE("damage to a no-leaf tree is found") {
  Damage d;
  NoLeafTree tree = makeNoLeafTree(d.tree);
  REQUIRE(validateLayout(tree, *d.mesh) == "");
  const auto leafSide = [](NoLeafNode& node) -> std::int32_t* {
    return node.left < 0 ? &node.left : node.right < 0 ? &node.right : nullptr;
  };
  const auto innerSide = [](NoLeafNode& node) -> std::int32_t* {
    return node.left >= 0 ? &node.left : node.right >= 0 ? &node.right : nullptr;
  };
  SECTION("another number of triangles") {
    ++tree.triangleCount;
    REQUIRE(says(validateLayout(tree, *d.mesh), "wrong number of triangles"));
  }
  SECTION("a node is missing") {
    tree.nodes.pop_back();
    REQUIRE(says(validateLayout(tree, *d.mesh), "wrong number of nodes"));
  }
  SECTION("a triangle twice, another never") {
    widen(tree);
    std::vector<std::int32_t*> leaves;
    for (NoLeafNode& node : tree.nodes) {
      if (std::int32_t* side = leafSide(node)) leaves.push_back(side);
    }
    *leaves.front() = *leaves.back();
    REQUIRE(says(validateLayout(tree, *d.mesh), "two leaves"));
  }
  SECTION("a triangle out of range") {
    widen(tree);
    for (NoLeafNode& node : tree.nodes) {
      if (std::int32_t* side = leafSide(node)) *side = std::numeric_limits<std::int32_t>::min();
    }
    REQUIRE(says(validateLayout(tree, *d.mesh), "triangle out of range"));
  }
  SECTION("an inner node that nothing leads to, another twice") {
    widen(tree);
    std::vector<std::int32_t*> inner;
    for (NoLeafNode& node : tree.nodes) {
      if (std::int32_t* side = innerSide(node)) inner.push_back(side);
    }
    *inner.front() = *inner.back();
    REQUIRE(says(validateLayout(tree, *d.mesh), "second parent"));
  }
  SECTION("a child before its parent") {
    for (NoLeafNode& node : tree.nodes) {
      if (std::int32_t* side = innerSide(node)) *side = 0;
    }
    REQUIRE(says(validateLayout(tree, *d.mesh), "does not follow"));
  }
  SECTION("a box too small") {
    tree.nodes[0].extent.x *= 0.999f;
    REQUIRE(says(validateLayout(tree, *d.mesh), "does not enclose"));
  }
}

TEST_CASE("damage to a wide tree is found") {
  Damage d;
  WideTree tree = makeWideTree(d.tree);
  REQUIRE(validateLayout(tree, *d.mesh) == "");
  WideNode& last = tree.nodes.back();
  SECTION("no nodes") {
    REQUIRE(says(validateLayout(WideTree{}, *d.mesh), "wrong number of nodes"));
  }
  SECTION("a wrong number of children") {
    last.count = 9;
    REQUIRE(says(validateLayout(tree, *d.mesh), "wrong number of children"));
  }
  SECTION("a child is forgotten") {
    last.count -= 1;
    for (float* extent : {last.extentX, last.extentY, last.extentZ}) extent[last.count] = -1;
    REQUIRE(says(validateLayout(tree, *d.mesh), "in no leaf"));
  }
  SECTION("a triangle twice") {
    widen(tree);
    last.child[0] = last.child[1];
    REQUIRE(says(validateLayout(tree, *d.mesh), "two leaves"));
  }
  SECTION("a node that nothing leads to") {
    widen(tree);
    tree.nodes.push_back(tree.nodes.back());
    REQUIRE(says(validateLayout(tree, *d.mesh), "two leaves"));
    tree.nodes.back() = {};
    REQUIRE(says(validateLayout(tree, *d.mesh), "wrong number of children"));
  }
  SECTION("a box too small") {
    tree.nodes[0].extentY[0] *= 0.999f;
    REQUIRE(says(validateLayout(tree, *d.mesh), "does not enclose"));
  }
}
