// SPDX-License-Identifier: BSD-3-Clause
// The trees of one mesh in all their layouts, which its scaled images share.
#pragma once

#include <optional>
#include <span>

#include "base/first_use.h"
#include "bvh/layouts.h"
#include "bvh/tree.h"
#include "bvh/tree_motion.h"
#include "bvh/wide_tree.h"

namespace otg {

/// Safe to share between threads; layouts other than the standard one are made once, on first use (thread-safe).
/// Immutable but for moves, which are only for those that hold the object.
class MeshTrees {
 public:
  /// `builtCost`: of a tree that was refitted, sahCost() when it was built; else 0.
  explicit MeshTrees(BinaryTree&& tree, double builtCost = 0) : tree_(std::move(tree)), builtCost_(builtCost) {}

  const BinaryTree& tree() const { return tree_; }
  const QuantizedTree& quantized() const;
  const NoLeafTree& noLeaf() const;
  const WideTree& wide() const;
  /// sahCost() when the tree was built.
  double builtCost() const { return builtCost_ > 0 ? builtCost_ : sahCost(tree_); }
  /// A refitted tree may cost this many times what the built one did (sahCost), which queries take about as much
  /// longer.
  static constexpr double kRebuildCost = 1.5;

  /// First step of a move: lists what there is to refit when `triangles` of the mesh change; the first time it makes
  /// what is needed to find that. Throws std::bad_alloc: dropMotion() then.
  void planMove(const TriMesh& mesh, std::span<const std::uint32_t> triangles);
  /// Second step, after the vertices have moved: all layouts are refitted.
  void refit(const TriMesh& mesh) noexcept;
  /// After refit(): builds the tree anew if refitting has made it too bad; says whether. Without memory for that it
  /// stays as it is, which is right if slow.
  bool rebuildIfWorn(const TriMesh& mesh) noexcept;
  /// Frees what is kept between moves; it is made again when it is needed.
  void dropMotion() noexcept;

 private:
  BinaryTree tree_;
  double builtCost_ = 0;
  FirstUse<QuantizedTree> quantized_;
  FirstUse<NoLeafTree> noLeaf_;
  FirstUse<WideTree> wide_;
  std::optional<TreeMotion> motion_;
  std::optional<WidePlaces> widePlaces_;      ///< of the wide tree that is there
  std::optional<NoLeafPlaces> noLeafPlaces_;  ///< of the no-leaf tree that is there
};

}  // namespace otg
