// SPDX-License-Identifier: BSD-3-Clause
// A validated triangle mesh, immutable but for its only holder (vertex_motion.h).
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "base/array.h"
#include "base/first_use.h"
#include "base/shared_array.h"
#include "mesh/content_key.h"
#include "mesh/mass_properties.h"
#include "mesh/repair.h"
#include "mesh/topology.h"
#include "mesh/validation.h"
#include "shared/math/vec3.h"

namespace otg {

/// Arrays as a caller has them. Nothing is kept: buildTriMesh copies what it needs.
struct MeshInput {
  enum class Scalar { kFloat, kDouble };
  const void* vertices = nullptr;  ///< x, y, z of each vertex; doubles are rounded to float once
  Scalar scalar = Scalar::kFloat;
  std::size_t vertexStride = 0;  ///< bytes from one vertex to the next, 0 = tightly packed
  std::size_t vertexCount = 0;
  const void* indices = nullptr;   ///< three 32-bit vertex indices for each triangle
  std::size_t triangleStride = 0;  ///< bytes from one triangle to the next, 0 = tightly packed
  std::size_t triangleCount = 0;
};

/// How triangles and vertices are numbered inside a TriMesh. kInput: as the caller (after repairs) does. kLocal: what
/// hangs together lies together (mesh/local_order.h), which queries read from memory faster. Results of collide() and
/// reports are in the caller's numbers all the same. kBySize: kInput for a mesh of up to kMostUnsorted triangles, which
/// caches hold anyhow, else kLocal. A numbering depends on neighbours alone.
enum class MeshOrder { kInput, kLocal, kBySize };
inline constexpr std::size_t kMostUnsorted = 1024;

/// A solid is closed, manifold along its edges, consistently wound and faces outward: it has an inside.
/// Anything else is a shell.
enum class MeshClass { kSolid, kShell };

struct AdjacencyLinks;

class TriMesh {
 public:
  /// Vertices in the mesh's own frame, as the caller gave them (after repair, if any was requested).
  std::span<const Vec3f> vertices() const { return vertices_; }
  std::span<const Triangle> triangles() const { return triangles_; }
  std::size_t triangleCount() const { return triangles_.size(); }

  /// The caller's number of a triangle (after repairs that drop some: the number in the list that remains), and back.
  std::uint32_t callerTriangle(std::uint32_t t) const { return callerTriangle_.empty() ? t : callerTriangle_[t]; }
  std::uint32_t triangleOfCaller(std::uint32_t t) const { return triangleOfCaller_.empty() ? t : triangleOfCaller_[t]; }
  /// Whether each of the caller's triangles has the same number in both.
  bool isNumberedAs(const TriMesh& other) const;
  /// The caller's number of a vertex; where repair merged several, that of the first.
  std::uint32_t callerVertex(std::uint32_t v) const { return inputVertexOf_.empty() ? v : inputVertexOf_[v]; }

  /// How many vertices the caller gave, those that repair merged into others among them.
  std::size_t inputVertexCount() const { return inputVertexCount_; }

  /// True for a zero-area triangle. Such triangles keep their number, lie in the tree, and never reach the near phase.
  bool isDegenerate(std::uint32_t triangle) const { return degenerate_[triangle] != 0; }

  /// Edges, neighbours, components on vertices welded by position.
  const Topology& topology() const { return topology_; }
  /// Made on the first request, by this mesh or one that shares it. May throw std::bad_alloc.
  const AdjacencyLinks& adjacencyLinks() const;
  /// findFirstCopies(), without a search where the report knows of no duplicates. Made on the first request. May throw
  /// std::bad_alloc.
  std::span<const std::uint32_t> firstCopies() const;
  const ValidationReport& report() const { return report_; }
  MeshClass meshClass() const { return report_.solid ? MeshClass::kSolid : MeshClass::kShell; }
  /// Of the polyhedron at density 1; only meaningful for solids (signed sums for shells). Computed on the first
  /// request.
  const MassProperties& massProperties() const;

  /// Of what the caller gave, as far as the mesh has taken it over. Computed on the first request.
  std::uint64_t contentHash() const {
    return trianglesHash_->get([this] { return hashOfTriangles(); }) +
           verticesHash_.get([this] { return hashOfVertices(); });
  }

  /// Axis-aligned bounds of the vertices that triangles use; min > max when there are none.
  const Vec3f& boundsMin() const { return boundsMin_; }
  const Vec3f& boundsMax() const { return boundsMax_; }
  /// The middle of the bounds, rounded to float.
  const Vec3f& center() const { return center_; }
  /// No vertex that a triangle uses is farther than this from center() (rounded up).
  float radius() const { return radius_; }
  /// The origin of the *centred frame* in which boxes and float filters work. So their error follows the size of the
  /// mesh, and not its distance from the origin of its own frame. It is center() when the mesh is built, and stays
  /// there when vertices move, unless that is far from the middle by then (originAfterMove()). No contact depends on
  /// it.
  const Vec3f& origin() const { return origin_; }

 private:
  std::uint64_t hashOfVertices() const;
  std::uint64_t hashOfTriangles() const;
  friend struct TriMeshBuilder;
  friend struct TriMeshParts;
  friend class VertexMotion;
  TriMesh() = default;
  Array<Vec3f> vertices_;
  /// What does not depend on the places of vertices is shared by meshes that were made of one another.
  SharedArray<Triangle> triangles_;
  SharedArray<std::uint8_t> degenerate_;
  Topology topology_;
  std::shared_ptr<FirstUse<AdjacencyLinks>> links_;                    ///< of these triangles and this topology
  std::shared_ptr<FirstUse<std::vector<std::uint32_t>>> firstCopies_;  ///< likewise
  std::shared_ptr<FirstUse<std::uint64_t>> trianglesHash_;             ///< of these triangles
  FirstUse<std::uint64_t> verticesHash_;
  ValidationReport report_;
  FirstUse<MassProperties> mass_;
  Vec3f boundsMin_{}, boundsMax_{}, center_{}, origin_{};
  float radius_ = 0;
  /// How many vertices the caller gave, and which of them each of vertices_ is (empty where that is the same number).
  /// Where surfaces that touch have been taken apart, several are one of the caller's.
  std::size_t inputVertexCount_ = 0;
  SharedArray<std::uint32_t> inputVertexOf_;
  SharedArray<std::uint32_t> callerTriangle_, triangleOfCaller_;  ///< empty where numbers are the caller's
};

/// What buildTriMesh returns: a mesh, or none and a report whose problems say why (`report.error` in one line).
struct MeshResult {
  std::shared_ptr<const TriMesh> mesh;  ///< null when the input is refused
  ValidationReport report;              ///< the same as mesh->report() when there is a mesh
};

/// Copies, validates, optionally repairs. Never throws for bad input and never aborts: open, inconsistent and
/// degenerate meshes are accepted and classed. Numbers that cannot be worked with are refused: indices out of range,
/// NaN, infinity, counts above the limits, null arrays. An empty mesh (no triangles) is accepted. Throws std::bad_alloc
/// only.
MeshResult buildTriMesh(const MeshInput& input, const RepairOptions& repair = {}, MeshOrder order = MeshOrder::kInput);

/// All of the caller's vertices in its order. Where repair has merged some, the others are zero and no triangle uses
/// them.
std::vector<Vec3f> verticesOfCaller(const TriMesh& mesh);

/// The same triangles with moved vertices: as many, in the same order, as `mesh` was built from (refused otherwise);
/// the triangles in `vertices` are not looked at. Where repair merged vertices, the first of them moves the merged one.
/// Topology is taken over when equal positions stay equal. Otherwise it is rebuilt, and where triangles may get other
/// neighbours a sorted mesh is sorted anew: numbers are those of a build. `turned`: with the triangles turned round,
/// corners (a, b, c) to (a, c, b). A mirror image needs that to face the way that it did.
MeshResult moveVertices(const TriMesh& mesh, const MeshInput& vertices, bool turned = false);

/// New places for some vertices, checked as moveVertices() checks all of them. Of `input` only the vertices are read.
/// Empty when they are refused, or when there are none: the report's error distinguishes them.
std::vector<Vec3f> readSomeVertices(const TriMesh& mesh, const MeshInput& input, ValidationReport& report);

}  // namespace otg
