// SPDX-License-Identifier: BSD-3-Clause
// A mesh with its trees.
#include "bvh/collision_mesh.h"

#include <optional>

#include "bvh/tree_motion.h"

namespace otg {

/// All that moveSome() keeps between calls.
struct CollisionMesh::Motion {
  VertexMotion vertices;
  std::optional<TreeMotion> tree;
  std::optional<WidePlaces> wide;      ///< of the wide tree that is there
  std::optional<NoLeafPlaces> noLeaf;  ///< of the no-leaf tree that is there
  std::shared_ptr<const char> alive;   ///< from beginMove() to the end of the move: the lifetime after it
};

CollisionMesh::CollisionMesh(std::shared_ptr<const TriMesh> mesh, BuildStrategy strategy)
    : mesh_(std::move(mesh)), tree_(buildTree(*mesh_, strategy)) {}

CollisionMesh::CollisionMesh(std::shared_ptr<const TriMesh> moved, const CollisionMesh& before)
    : mesh_(std::move(moved)), tree_(before.tree_) {
  refitTree(tree_, *mesh_);
  builtCost_ = before.builtCost_ > 0 ? before.builtCost_ : sahCost(before.tree_);
  if (sahCost(tree_) > kRebuildCost * builtCost_) {
    tree_ = buildTree(*mesh_, tree_.strategy);
    builtCost_ = 0;
  }
}

CollisionMesh::CollisionMesh(std::shared_ptr<const TriMesh> mesh, BinaryTree&& tree)
    : mesh_(std::move(mesh)), tree_(std::move(tree)) {}

CollisionMesh::~CollisionMesh() = default;

const QuantizedTree& CollisionMesh::quantized() const {
  return quantized_.get([this] { return quantizeTree(tree_); });
}

const NoLeafTree& CollisionMesh::noLeaf() const {
  return noLeaf_.get([this] { return makeNoLeafTree(tree_); });
}

const WideTree& CollisionMesh::wide() const {
  return wide_.get([this] { return makeWideTree(tree_); });
}

const Adjacency& CollisionMesh::adjacency() const {
  return adjacency_.get([this] { return buildAdjacency(*mesh_); });
}

CollisionMesh::Motion& CollisionMesh::motion() {
  if (motion_ == nullptr) motion_.reset(new Motion{VertexMotion(*mesh_), {}, {}, {}, {}});
  return *motion_;
}

std::uint32_t CollisionMesh::ownVertex(std::uint32_t ofCaller) {
  return motion().vertices.ownVertex(ofCaller);
}

bool CollisionMesh::moveSome(std::span<const MovedVertex> moved) {
  if (!beginMove(moved)) return false;
  finishMove();
  return true;
}

bool CollisionMesh::beginMove(std::span<const MovedVertex> moved) {
  // A count of one is for good: only the holder could make another. The copy that is dropped at once orders what the
  // last of the others did with the mesh before what is done to it here.
  { const std::shared_ptr<const TriMesh> ordered = mesh_; }
  if (mesh_.use_count() != 1) return false;
  try {
    Motion& m = motion();
    if (!m.tree) m.tree.emplace(tree_, *mesh_);
    if (wide_.made() != nullptr && !m.wide) {
      WidePlaces places;
      wide_.set(makeWideTree(tree_, &places.lane));
      m.wide = std::move(places);
    }
    if (noLeaf_.made() != nullptr && !m.noLeaf) m.noLeaf = noLeafPlaces(tree_);
    m.vertices.plan(*mesh_, moved);
    m.tree->plan(tree_, m.vertices.triangles());
    m.alive = std::make_shared<const char>('\0');
    if (builtCost_ == 0) builtCost_ = sahCost(tree_);
    // Every mesh is made as an object that is not const (TriMeshBuilder, TriMeshParts); shared it is const.
    if (!m.vertices.move(const_cast<TriMesh&>(*mesh_))) {
      motion_.reset();
      return false;
    }
  } catch (...) {
    motion_.reset();
    throw;
  }
  return true;
}

void CollisionMesh::undoMove() noexcept {
  motion_->vertices.undo(const_cast<TriMesh&>(*mesh_));
  motion_.reset();
}

void CollisionMesh::finishMove() noexcept {
  Motion& m = *motion_;
  alive_ = std::move(m.alive);
  m.tree->refit(tree_, *mesh_);
  const std::span<const std::uint32_t> nodes = m.tree->nodes();
  if (WideTree* const wide = wide_.made()) refitLayout(*wide, *m.wide, tree_, nodes);
  if (NoLeafTree* const noLeaf = noLeaf_.made()) refitLayout(*noLeaf, *m.noLeaf, tree_, nodes);
  if (QuantizedTree* const quantized = quantized_.made()) {
    if (!refitLayout(*quantized, tree_, nodes)) quantized_.reset();
  }
  if (Adjacency* const adjacency = adjacency_.made()) {
    try {
      updateAdjacency(*adjacency, *mesh_, m.vertices.triangles());
    } catch (const std::bad_alloc&) {
      adjacency_.reset();  // to be built when it is asked for
    }
  }
  logMove(m.vertices.triangles());
  rebuildIfWorn();
}

void CollisionMesh::logMove(std::span<const std::uint32_t> triangles) noexcept {
  ++log_.moves;
  const std::size_t most = mesh_->triangleCount() / kLoggedShare;
  try {
    while (!log_.counts.empty() && log_.triangles.size() + triangles.size() > most) {
      log_.triangles.erase(log_.triangles.begin(),
                           log_.triangles.begin() + static_cast<std::ptrdiff_t>(log_.counts.front()));
      log_.counts.pop_front();
    }
    if (triangles.size() > most) return;
    log_.triangles.insert(log_.triangles.end(), triangles.begin(), triangles.end());
    log_.counts.push_back(triangles.size());
  } catch (const std::bad_alloc&) {
    log_.triangles.clear();
    log_.counts.clear();
  }
}

std::optional<std::vector<std::uint32_t>> CollisionMesh::changedSince(std::uint64_t moves) const {
  const std::uint64_t since = log_.moves - moves;
  if (moves > log_.moves || since > log_.counts.size()) return std::nullopt;
  std::size_t count = 0;
  for (std::uint64_t i = 1; i <= since; ++i) count += log_.counts[log_.counts.size() - i];
  return std::vector<std::uint32_t>(log_.triangles.end() - static_cast<std::ptrdiff_t>(count), log_.triangles.end());
}

/// Builds the tree anew if refitting has made it too bad. For want of memory it stays as it is, which is right if slow.
void CollisionMesh::rebuildIfWorn() noexcept {
  if (motion_->tree->cost(tree_) <= kRebuildCost * builtCost_) return;
  try {
    auto structure = std::make_shared<const char>('\0');
    tree_ = buildTree(*mesh_, tree_.strategy);
    structure_ = std::move(structure);
  } catch (const std::bad_alloc&) {
    return;
  }
  builtCost_ = 0;
  quantized_.reset();
  noLeaf_.reset();
  wide_.reset();
  motion_->tree.reset();
  motion_->wide.reset();
  motion_->noLeaf.reset();
}

}  // namespace otg
