// SPDX-License-Identifier: BSD-3-Clause
// Moving some vertices of a mesh in place, at a cost that follows their number.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "base/block_sum.h"
#include "base/bounds.h"
#include "mesh/tri_mesh.h"

namespace otg {

/// A vertex, by the mesh's own number, and where it goes.
struct MovedVertex {
  std::uint32_t vertex;
  Vec3f to;
};

/// What is known of one mesh beside itself so that few of its vertices can move without a look at all of them: which
/// triangles use a vertex, which vertices lie where, and sums and bounds by parts. Made from the mesh, and kept in step
/// with it by move(). Takes about 40 bytes for each triangle, 15 less where a part is another's.
class VertexMotion {
 public:
  /// `like`, if there is one: that of a mesh which may have the same points and triangles in other places, or turned
  /// round; what does not depend on places is shared with it then.
  explicit VertexMotion(const TriMesh& mesh, const VertexMotion* like = nullptr);

  /// First step: takes the moves over (a vertex that is named twice goes where it is sent last), and lists the
  /// triangles that they change. The mesh is only read. May throw std::bad_alloc.
  void plan(const TriMesh& mesh, std::span<const MovedVertex> moved);

  /// Second step: makes the moves in place. The mesh is then, bit for bit, what moveVertices() with all vertices would
  /// make of it. False where more changes than numbers of those triangles: vertices that were one point part, others
  /// meet, a triangle loses or gains its area; a closed component turns inside out; the middle of the mesh wanders off
  /// from origin(). False, too, where surfaces may touch along edges. Then the mesh is as it was, it takes
  /// moveVertices(), and this object is of no further use; also after an exception.
  bool move(TriMesh& mesh);

  /// After move() has succeeded: the mesh is as it was before. This object is of no further use.
  void undo(TriMesh& mesh) noexcept;

  /// Of the last plan, each once: the triangles with a moved corner.
  std::span<const std::uint32_t> triangles() const { return triangles_; }

  /// The mesh's number of a vertex by the caller's; kNone for one that repair has merged into another.
  std::uint32_t ownVertex(std::uint32_t ofCaller) const {
    return links_->ownVertex.empty() ? ofCaller : links_->ownVertex[ofCaller];
  }

 private:
  static constexpr std::uint32_t kBlock = 32;
  struct Measures {
    Vec3f boundsMin{}, boundsMax{}, center{};
    float radius = 0;
    Array<double> componentVolume;
  };
  /// What depends on triangles, and on which vertices are one point, alone.
  struct Links {
    SharedArray<std::uint32_t> weld, componentOf;  ///< those of the mesh's topology
    std::vector<std::uint32_t> ownVertex;          ///< by the caller's number; empty where that is the same number
    std::vector<std::uint32_t> firstUse, uses;     ///< the triangles of vertex v: uses[firstUse[v]] ..
    std::vector<std::uint32_t> ring;               ///< the next vertex of the same point, round; empty if each is alone
    /// Where there are several components: triangles by component (those of none left out), and the place of each.
    std::vector<std::uint32_t> componentFirst, byComponent, placeOf;
  };
  static std::shared_ptr<const Links> linksOf(const TriMesh& mesh);
  /// Of kBlock neighbouring vertices, those that triangles use.
  Bounds blockOf(const TriMesh& mesh, std::uint32_t block) const;
  bool isUsed(std::uint32_t v) const { return links_->firstUse[v] != links_->firstUse[v + 1]; }
  void enter(const TriMesh& mesh, std::uint32_t point);
  void leave(const TriMesh& mesh, std::uint32_t point);
  bool occupied(const TriMesh& mesh, std::uint32_t point) const;
  std::uint32_t& bucketOf(const Vec3f& p) { return head_[hashPosition(p) & (head_.size() - 1)]; }
  bool keepsPoints(const TriMesh& mesh);
  bool keepsArea(const TriMesh& mesh) const;
  bool tryMove(TriMesh& mesh);
  void rehash(TriMesh& mesh, bool forth) noexcept;
  double largestDistance2(const TriMesh& mesh, const Vec3f& center) const;
  bool volumesAfter(const TriMesh& mesh, const Bounds& bounds, std::vector<double>& volumes);
  /// For several closed components: which lie in which, and how far each reaches.
  void measureNesting(const TriMesh& mesh, const Topology& topology);
  bool staysApart(const TriMesh& mesh, std::span<const std::uint32_t> changed) const;
  std::size_t firstOf(std::uint32_t component) const {
    return links_->componentFirst.empty() ? 0 : links_->componentFirst[component];
  }

  std::shared_ptr<const Links> links_;
  std::vector<std::uint32_t> head_, next_;  ///< welded vertices by the hash of their places
  std::vector<Bounds> blocks_;
  std::vector<KeptBlockSum> volume6_;    ///< of each component
  std::vector<std::uint8_t> wellWound_;  ///< componentsWellWound()
  std::uint32_t closedComponents_ = 0;
  /// Of several closed components: whether none lies in another one. Of each the bounds, which only grow while vertices
  /// move, and the vertices that reached farthest when it was measured.
  bool apart_ = false;
  std::vector<Bounds> reach_;
  std::vector<std::array<std::uint32_t, 6>> farthest_;

  std::vector<MovedVertex> moves_;  ///< each vertex once
  std::vector<Vec3f> before_;       ///< where they were
  Measures measuresBefore_;         ///< what the last move() has changed beside them
  std::vector<std::uint32_t> triangles_;
  std::vector<std::uint32_t> vertexMark_, triangleMark_;  ///< the number of the plan that last named it
  std::vector<std::uint32_t> placeInMoves_;
  std::uint32_t plan_ = 0;
};

}  // namespace otg
