// SPDX-License-Identifier: BSD-3-Clause
#include "bvh/tree_motion.h"

namespace otg {

TreeMotion::TreeMotion(const BinaryTree& tree, const TriMesh& mesh)
    : leafOf_((tree.nodes.size() + 1) / 2), inner_(tree.nodes.size() / 2), pending_(tree.nodes.size() / 2, 0) {
  for (std::size_t i = tree.nodes.size(); i-- > 0;) {
    const BvhNode& node = tree.nodes[i];
    if (node.isLeaf()) {
      leafOf_[node.triangle()] = static_cast<std::uint32_t>(i);
      continue;
    }
    const auto child = static_cast<std::uint32_t>(node.child);
    MeshBox box = exactBox(tree, mesh, child);
    box.grow(exactBox(tree, mesh, child + 1));
    inner_[(child - 1) / 2] = {{box.lo[0], box.lo[1], box.lo[2]}, {box.hi[0], box.hi[1], box.hi[2]}};
  }
  areas_.build(tree.nodes.size(), [&](std::size_t i) { return halfArea(tree.nodes[i]); });
}

MeshBox TreeMotion::exactBox(const BinaryTree& tree, const TriMesh& mesh, std::uint32_t i) const {
  const BvhNode& node = tree.nodes[i];
  if (node.isLeaf()) return boxOfTriangle(mesh, node.triangle());
  const Bounds6& b = inner_[static_cast<std::uint32_t>(node.child - 1) / 2];
  return MeshBox{{b.lo.x, b.lo.y, b.lo.z, 0}, {b.hi.x, b.hi.y, b.hi.z, 0}};
}

void TreeMotion::plan(const BinaryTree& tree, std::span<const std::uint32_t> triangles) {
  nodes_.clear();
  const auto place = [&](std::uint32_t inner) { return static_cast<std::uint32_t>(tree.nodes[inner].child - 1) / 2; };
  for (const std::uint32_t t : triangles) {
    for (std::uint32_t i = tree.nodes[leafOf_[t]].parent; i != kNone; i = tree.nodes[i].parent) {
      if (pending_[place(i)]++ != 0) break;  // what is above has been counted
    }
  }
  // Up again, from each leaf as far as all that is below has been listed.
  for (const std::uint32_t t : triangles) {
    nodes_.push_back(leafOf_[t]);
    for (std::uint32_t i = tree.nodes[leafOf_[t]].parent; i != kNone; i = tree.nodes[i].parent) {
      if (--pending_[place(i)] != 0) break;
      nodes_.push_back(i);
    }
  }
  changed_.reserve(nodes_.size());
}

void TreeMotion::refit(BinaryTree& tree, const TriMesh& mesh) {
  for (const std::uint32_t i : nodes_) {
    BvhNode& node = tree.nodes[i];
    MeshBox box;
    if (node.isLeaf()) {
      box = boxOfTriangle(mesh, node.triangle());
    } else {
      const auto child = static_cast<std::uint32_t>(node.child);
      box = exactBox(tree, mesh, child);
      box.grow(exactBox(tree, mesh, child + 1));
      inner_[(child - 1) / 2] = {{box.lo[0], box.lo[1], box.lo[2]}, {box.hi[0], box.hi[1], box.hi[2]}};
    }
    enclose(box, mesh.origin(), node);
  }
}

double TreeMotion::cost(const BinaryTree& tree) {
  changed_.assign(nodes_.begin(), nodes_.end());
  areas_.update(changed_, [&](std::size_t i) { return halfArea(tree.nodes[i]); });
  return relativeCost(tree, areas_.total());
}

NoLeafPlaces noLeafPlaces(const BinaryTree& tree) {
  NoLeafPlaces places;
  places.node.assign(tree.nodes.size(), kNone);
  std::uint32_t count = 0;
  for (std::size_t i = 0; i < tree.nodes.size(); ++i) {
    if (!tree.nodes[i].isLeaf()) places.node[i] = count++;
  }
  return places;
}

void refitLayout(WideTree& wide, const WidePlaces& places, const BinaryTree& tree,
                 std::span<const std::uint32_t> nodes) {
  for (const std::uint32_t i : nodes) {
    const std::uint32_t place = places.lane[i];
    if (place == kNone) continue;
    WideNode& node = wide.nodes[place / kWideArity];
    setBox(node, place % kWideArity, tree.nodes[i].center, tree.nodes[i].extent);
  }
  if (!tree.nodes.empty()) {
    wide.rootCenter = tree.nodes[0].center;
    wide.rootExtent = tree.nodes[0].extent;
  }
}

void refitLayout(NoLeafTree& noLeaf, const NoLeafPlaces& places, const BinaryTree& tree,
                 std::span<const std::uint32_t> nodes) {
  if (noLeaf.nodes.empty()) return;
  for (const std::uint32_t i : nodes) {
    if (places.node[i] == kNone) continue;
    noLeaf.nodes[places.node[i]].center = tree.nodes[i].center;
    noLeaf.nodes[places.node[i]].extent = tree.nodes[i].extent;
  }
}

}  // namespace otg
