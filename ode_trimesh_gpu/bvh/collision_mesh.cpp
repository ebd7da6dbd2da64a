// SPDX-License-Identifier: BSD-3-Clause
// A mesh with its trees.
#include "bvh/collision_mesh.h"

#include <mutex>

namespace otg {

struct CollisionMesh::Lazy {
  std::once_flag quantizedOnce, noLeafOnce, wideOnce, adjacencyOnce;
  QuantizedTree quantized;
  NoLeafTree noLeaf;
  WideTree wide;
  Adjacency adjacency;
};

CollisionMesh::CollisionMesh(std::shared_ptr<const TriMesh> mesh, BuildStrategy strategy)
    : mesh_(std::move(mesh)), tree_(buildTree(*mesh_, strategy)), lazy_(std::make_unique<Lazy>()) {}

CollisionMesh::CollisionMesh(std::shared_ptr<const TriMesh> moved, const CollisionMesh& before)
    : mesh_(std::move(moved)), tree_(before.tree_), lazy_(std::make_unique<Lazy>()) {
  refitTree(tree_, *mesh_);
  builtCost_ = before.builtCost_ > 0 ? before.builtCost_ : sahCost(before.tree_);
  if (sahCost(tree_) > kRebuildCost * builtCost_) {
    tree_ = buildTree(*mesh_, tree_.strategy);
    builtCost_ = 0;
  }
}

CollisionMesh::CollisionMesh(std::shared_ptr<const TriMesh> mesh, BinaryTree&& tree)
    : mesh_(std::move(mesh)), tree_(std::move(tree)), lazy_(std::make_unique<Lazy>()) {}

CollisionMesh::~CollisionMesh() = default;

const QuantizedTree& CollisionMesh::quantized() const {
  std::call_once(lazy_->quantizedOnce, [this] { lazy_->quantized = quantizeTree(tree_); });
  return lazy_->quantized;
}

const NoLeafTree& CollisionMesh::noLeaf() const {
  std::call_once(lazy_->noLeafOnce, [this] { lazy_->noLeaf = makeNoLeafTree(tree_); });
  return lazy_->noLeaf;
}

const WideTree& CollisionMesh::wide() const {
  std::call_once(lazy_->wideOnce, [this] { lazy_->wide = makeWideTree(tree_); });
  return lazy_->wide;
}

const Adjacency& CollisionMesh::adjacency() const {
  std::call_once(lazy_->adjacencyOnce, [this] { lazy_->adjacency = buildAdjacency(*mesh_); });
  return lazy_->adjacency;
}

}  // namespace otg
