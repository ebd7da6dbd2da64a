// SPDX-License-Identifier: BSD-3-Clause
#include "bvh/mesh_trees.h"

#include <new>

namespace otg {

const QuantizedTree& MeshTrees::quantized() const {
  return quantized_.get([this] { return quantizeTree(tree_); });
}

const NoLeafTree& MeshTrees::noLeaf() const {
  return noLeaf_.get([this] { return makeNoLeafTree(tree_); });
}

const WideTree& MeshTrees::wide() const {
  return wide_.get([this] { return makeWideTree(tree_); });
}

void MeshTrees::planMove(const TriMesh& mesh, std::span<const std::uint32_t> triangles) {
  if (!motion_) motion_.emplace(tree_, mesh);
  if (wide_.made() != nullptr && !widePlaces_) {
    WidePlaces places;
    wide_.set(makeWideTree(tree_, &places.lane));
    widePlaces_ = std::move(places);
  }
  if (noLeaf_.made() != nullptr && !noLeafPlaces_) noLeafPlaces_ = noLeafPlaces(tree_);
  motion_->plan(tree_, triangles);
  builtCost_ = builtCost();
}

void MeshTrees::refit(const TriMesh& mesh) noexcept {
  motion_->refit(tree_, mesh);
  const std::span<const std::uint32_t> nodes = motion_->nodes();
  if (WideTree* const wide = wide_.made()) refitLayout(*wide, *widePlaces_, tree_, nodes);
  if (NoLeafTree* const noLeaf = noLeaf_.made()) refitLayout(*noLeaf, *noLeafPlaces_, tree_, nodes);
  if (QuantizedTree* const quantized = quantized_.made()) {
    if (!refitLayout(*quantized, tree_, nodes)) quantized_.reset();
  }
}

bool MeshTrees::rebuildIfWorn(const TriMesh& mesh) noexcept {
  if (motion_->cost(tree_) <= kRebuildCost * builtCost_) return false;
  try {
    tree_ = buildTree(mesh, tree_.strategy);
  } catch (const std::bad_alloc&) {
    return false;
  }
  builtCost_ = 0;
  quantized_.reset();
  noLeaf_.reset();
  wide_.reset();
  dropMotion();
  return true;
}

void MeshTrees::dropMotion() noexcept {
  motion_.reset();
  widePlaces_.reset();
  noLeafPlaces_.reset();
}

}  // namespace otg
