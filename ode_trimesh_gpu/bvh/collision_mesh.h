// SPDX-License-Identifier: BSD-3-Clause
// A mesh with its trees: what a collision query takes.
#pragma once

#include <memory>

#include "bvh/layouts.h"
#include "bvh/tree.h"
#include "bvh/wide_tree.h"
#include "mesh/adjacency.h"

namespace otg {

/// Immutable after construction and safe to share between threads; layouts other than the standard one are made once,
/// on first use (thread-safe).
class CollisionMesh {
 public:
  CollisionMesh(std::shared_ptr<const TriMesh> mesh, BuildStrategy strategy);
  /// The same tree topology refitted to moved vertices; built anew where refitting would leave boxes that overlap much
  /// more (kRebuildCost) than those of the last build.
  CollisionMesh(std::shared_ptr<const TriMesh> moved, const CollisionMesh& before);
  /// With a tree that was built before, for this very mesh.
  CollisionMesh(std::shared_ptr<const TriMesh> mesh, BinaryTree&& tree);
  ~CollisionMesh();
  CollisionMesh(const CollisionMesh&) = delete;
  CollisionMesh& operator=(const CollisionMesh&) = delete;

  const TriMesh& mesh() const { return *mesh_; }
  const std::shared_ptr<const TriMesh>& meshPtr() const { return mesh_; }
  const BinaryTree& tree() const { return tree_; }
  const QuantizedTree& quantized() const;
  const NoLeafTree& noLeaf() const;
  const WideTree& wide() const;
  const Adjacency& adjacency() const;

  /// Expires with this object, whatever else holds the mesh: for caches of what was derived from it.
  std::weak_ptr<const void> lifetime() const { return alive_; }

  /// A refitted tree may cost this many times what the built one did (sahCost), which queries take about as much
  /// longer.
  static constexpr double kRebuildCost = 1.5;

 private:
  struct Lazy;
  std::shared_ptr<const TriMesh> mesh_;
  BinaryTree tree_;
  double builtCost_ = 0;  ///< of a refitted tree: sahCost when it was built
  std::unique_ptr<Lazy> lazy_;
  std::shared_ptr<const char> alive_ = std::make_shared<const char>('\0');
};

}  // namespace otg
