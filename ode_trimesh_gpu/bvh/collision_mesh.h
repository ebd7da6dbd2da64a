// SPDX-License-Identifier: BSD-3-Clause
// A mesh with its trees: what a collision query takes.
#pragma once

#include <cstdint>
#include <deque>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "base/first_use.h"
#include "bvh/box_scale.h"
#include "bvh/mesh_trees.h"
#include "bvh/solid_parts.h"
#include "mesh/adjacency.h"
#include "mesh/convex_polyhedron.h"
#include "mesh/outward_sides.h"
#include "mesh/vertex_motion.h"

namespace otg {

/// Safe to share between threads; layouts other than the standard one are made once, on first use (thread-safe).
/// Immutable after construction, but for moveSome(). Several may have the same trees, as said at the constructors.
class CollisionMesh {
 public:
  CollisionMesh(std::shared_ptr<const TriMesh> mesh, BuildStrategy strategy);
  /// The same tree topology refitted to moved vertices; built anew where refitting would leave boxes that overlap much
  /// more (kRebuildCost) than those of the last build.
  CollisionMesh(std::shared_ptr<const TriMesh> moved, const CollisionMesh& before);
  /// A scaled image of another mesh: the same triangles (perhaps turned round), vertices times `factors`, which are
  /// finite and not 0, rounded to float. It has the trees of the other one, whose boxes are scaled when they are looked
  /// at (boxScale()); trees of its own where that cannot be done (makeBoxScale()) and where the factors differ too much
  /// (stretchesTooMuch()). So it does where those boxes would overlap much more (kRebuildCost) than the other one's did
  /// when its tree was built.
  CollisionMesh(std::shared_ptr<const TriMesh> image, const CollisionMesh& of, const Vec3f& factors);
  /// With a tree that was built before, for this very mesh.
  CollisionMesh(std::shared_ptr<const TriMesh> mesh, BinaryTree&& tree);
  ~CollisionMesh();
  CollisionMesh(const CollisionMesh&) = delete;
  CollisionMesh& operator=(const CollisionMesh&) = delete;

  /// Moves some vertices in place. The mesh, its tree, its layouts and its adjacency are then what moveVertices() and
  /// the constructor for moved vertices would make of all of them. Only a wide tree may open other nodes. The cost
  /// follows the number of `moved`; the first time, and where the tree has to be built anew, that of a build. `moved`
  /// are the mesh's own numbers. Only for the one that holds both this object and its mesh alone, and not for an image
  /// with the trees of another mesh. Other images of this mesh keep boxes as they were.
  ///
  /// False, and nothing has changed, where that cannot be done (VertexMotion::move()) or another owner holds the mesh.
  /// Throws std::bad_alloc, and nothing has changed.
  bool moveSome(std::span<const MovedVertex> moved);
  /// moveSome() in two steps, for meshes that move together or not at all. What beginMove() returns and throws is that
  /// of moveSome(); after true the vertices are in their new places, all else is not, and one of the others has to
  /// follow. `images`: how many images have the trees of this mesh and are going to move with it (followMove()), or not
  /// to be used any more. Where that is not all who have them, this mesh and the images that follow go on with a copy.
  bool beginMove(std::span<const MovedVertex> moved, long images = 0);
  /// The same for an image with the trees of `of`, whose own move has begun with the same vertices. Its finishMove()
  /// comes after that of `of`, its undoMove() before or after.
  bool followMove(const CollisionMesh& of, std::span<const MovedVertex> moved);
  void finishMove() noexcept;
  void undoMove() noexcept;
  /// The mesh's own number of a vertex; kNone for one that repair has merged into another. Not const for the same
  /// reason as moveSome(), which it prepares.
  std::uint32_t ownVertex(std::uint32_t ofCaller);

  const TriMesh& mesh() const { return *mesh_; }
  const std::shared_ptr<const TriMesh>& meshPtr() const { return mesh_; }
  /// Boxes of these are to be taken through boxScale().
  const BinaryTree& tree() const { return trees_->tree(); }
  const QuantizedTree& quantized() const { return trees_->quantized(); }
  const NoLeafTree& noLeaf() const { return trees_->noLeaf(); }
  const WideTree& wide() const { return trees_->wide(); }
  /// Null where the boxes of the trees are those of this mesh.
  const BoxScale<float>* boxScale() const { return imageBoxes_ ? &*imageBoxes_ : nullptr; }
  /// The same, for those who multiply anyway.
  const BoxScale<float>& anyBoxScale() const { return imageBoxes_ ? *imageBoxes_ : kSameBoxes; }
  /// A copy of the tree with this mesh's boxes.
  BinaryTree ownBoxes() const;
  /// Calls `use` with a tree that has this mesh's boxes: tree() where it has them, else a copy.
  template <class Use>
  decltype(auto) withOwnBoxes(const Use& use) const {
    return imageBoxes_ ? use(static_cast<const BinaryTree&>(ownBoxes())) : use(tree());
  }
  const Adjacency& adjacency() const;
  /// The mesh as a convex polyhedron, or null if it is none. Determined on the first request (thread-safe), and again
  /// after vertices have moved. May throw std::bad_alloc.
  const ConvexPolyhedron* convex() const;

  /// The parts of a solid whose components overlap each other (takeSolidApart()), or null. Determined likewise.
  struct Parts;
  const Parts* parts() const;

  /// Whether boxes say little of its triangles, as of the fans at the ends of a gear: the boxes' areas are together
  /// more than kThin times the triangles'. Of scanned meshes they are about four times. As the vertices were first.
  bool hasThinTriangles() const { return hasThinTriangles_; }
  static constexpr double kThin = 20;

  /// outwardSides(): which way the triangles face of a mesh that would be a solid but for a few faults. Determined
  /// likewise.
  const std::vector<std::int8_t>& outwardSides() const;

  /// The same mesh with its triangles turned round, where that makes a solid of it; else null. Determined likewise.
  const CollisionMesh* turned() const;

  /// Makes now what first requests of the above and of wide() would make (thread-safe). May throw std::bad_alloc.
  void prepare() const;

  /// Expires with this object, whatever else holds the mesh, and when vertices move: for caches of what was derived
  /// from it.
  std::weak_ptr<const void> lifetime() const { return alive_; }

  /// Expires with this object, too, and when the tree is built anew, but not when vertices move: for copies of the mesh
  /// that follow its moves.
  std::weak_ptr<const void> structure() const { return structure_; }
  /// A name for it that no other mesh has, and never had, as long as anyone holds what structure() returned.
  const void* structureKey() const { return structure_.get(); }
  /// How often vertices have moved.
  std::uint64_t moves() const { return log_.moves; }
  /// The triangles that have changed since there were `moves` moves, some of them perhaps repeatedly. Empty where that
  /// is not known any more: of the last moves so many are known as have changed a kLoggedShare-th of all triangles.
  /// Throws std::bad_alloc.
  std::optional<std::vector<std::uint32_t>> changedSince(std::uint64_t moves) const;
  static constexpr std::size_t kLoggedShare = 8;

  static constexpr double kRebuildCost = MeshTrees::kRebuildCost;

 private:
  struct Motion;
  Motion& motion(const CollisionMesh* of = nullptr);
  void finishOwnMove() noexcept;
  void finishFollowing() noexcept;
  bool imageIsWorn() const;
  void takeOwnTree() noexcept;
  void logMove(std::span<const std::uint32_t> triangles) noexcept;

  std::shared_ptr<const TriMesh> mesh_;
  bool hasThinTriangles_;
  std::shared_ptr<MeshTrees> trees_;
  std::optional<BoxScale<float>> imageBoxes_;  ///< of an image that has the trees of another mesh
  Vec3f factors_{1, 1, 1};                     ///< of such an image
  std::size_t movedSinceLook_ = 0;             ///< triangles of such an image, since imageIsWorn() was called
  FirstUse<Adjacency> adjacency_;
  FirstUse<std::unique_ptr<const ConvexPolyhedron>> convex_;
  FirstUse<OutwardSides> outwardSides_;
  FirstUse<std::unique_ptr<const CollisionMesh>> turned_;
  FirstUse<std::unique_ptr<const Parts>> parts_;
  std::unique_ptr<Motion> motion_;  ///< made by moveSome()
  /// What changedSince() reads: the last `counts.size()` of all moves, each with so many of `triangles`.
  struct MoveLog {
    std::uint64_t moves = 0;
    std::deque<std::size_t> counts;
    std::deque<std::uint32_t> triangles;
  };
  MoveLog log_;
  std::shared_ptr<const char> structure_ = std::make_shared<const char>('\0');
  std::shared_ptr<const char> alive_ = std::make_shared<const char>('\0');
};

struct CollisionMesh::Parts : SolidParts {
  std::vector<std::unique_ptr<const CollisionMesh>> meshes;  ///< one for each part
};

}  // namespace otg
