// SPDX-License-Identifier: BSD-3-Clause
// A convex mesh as a polyhedron: faces of many corners instead of triangles, and what is farthest in a direction.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "mesh/convex_geometry.h"
#include "mesh/convexity.h"

namespace otg {

/// In the mesh's frame and units. Triangles in one plane are one face, and what lies in the middle of a face or of a
/// straight edge is no vertex. Immutable; any number of threads.
class ConvexPolyhedron {
 public:
  /// A corner of a face, and the edge from it to the face's next corner, counter-clockwise seen from outside.
  struct Corner {
    std::uint32_t vertex;    ///< of this polyhedron
    std::uint32_t next;      ///< the vertex at the edge's other end
    std::uint32_t face;      ///< whose corner it is
    std::uint32_t across;    ///< the face at the edge's other side
    std::uint32_t triangle;  ///< of the mesh, in the face, at the corner
    std::uint32_t edge;      ///< of the mesh (Topology::edges): the one with the least number, if there are several
    bool isForward;          ///< the mesh's edge runs from its `a` along this one
  };
  struct Face {
    Vec3d normal;          ///< unit, outward
    double offset;         ///< no vertex has a larger product with the normal
    std::uint32_t corner;  ///< its first; the next face's first ends it
  };

  std::span<const Vec3d> vertices() const { return vertices_; }
  std::uint32_t meshVertex(std::uint32_t v) const { return meshVertex_[v]; }        ///< welded
  std::uint32_t leastTriangle(std::uint32_t v) const { return leastTriangle_[v]; }  ///< of the mesh, that has it
  std::size_t faceCount() const { return faces_.size() - 1; }
  const Face& face(std::uint32_t f) const { return faces_[f]; }
  std::span<const Corner> corners(std::uint32_t f) const {
    return {corners_.data() + faces_[f].corner, faces_[f + 1].corner - faces_[f].corner};
  }
  /// The corners at a vertex: one for each of its faces, and for each of its edges.
  std::span<const std::uint32_t> cornersAt(std::uint32_t v) const {
    return {cornersAt_.data() + firstCornerAt_[v], firstCornerAt_[v + 1] - firstCornerAt_[v]};
  }
  const Corner& corner(std::uint32_t c) const { return corners_[c]; }
  std::uint32_t faceOfTriangle(std::uint32_t t) const { return faceOfTriangle_[t]; }
  /// Unit directions of all edges, parallel ones once; empty if there are more than kMostDirections.
  std::span<const Vec3d> edgeDirections() const { return directions_; }
  static constexpr std::size_t kMostDirections = 6;

  /// The vertex that is farthest along a direction, which needs not be of unit length.
  std::uint32_t support(const Vec3d& direction) const;
  /// The least and the largest product of any vertex with a direction.
  struct Reach {
    double least, most;
  };
  Reach reach(const Vec3d& direction) const;

  /// A box along the axes of the mesh's frame: exactly, so that it has all its corners.
  struct Box {
    Vec3d middle, half;
    std::uint32_t face[3][2];  ///< across each axis, the one that faces down it and the one that faces up
  };
  const Box* box() const { return box_ ? &*box_ : nullptr; }
  /// The same by planes, of which there are as many as faces, in their order; vertices have the same numbers. Null if
  /// there are more than kMostPlanes.
  const ConvexGeometry* geometry() const { return geometry_ ? &*geometry_ : nullptr; }
  static constexpr std::size_t kMostPlanes = 256;
  /// No other polyhedron of the process has had it. It distinguishes polyhedra and orders nothing.
  std::uint64_t stamp() const { return stamp_; }

  Convexity convexity() const { return convexity_; }

 private:
  friend class PolyhedronBuilder;
  static constexpr std::size_t kMostScanned = 32;
  std::uint32_t climb(std::uint32_t from, const Vec3d& direction) const;
  std::size_t cellOf(const Vec3d& direction) const;

  Convexity convexity_ = Convexity::kNone;
  std::optional<Box> box_;
  std::optional<ConvexGeometry> geometry_;
  std::uint64_t stamp_ = 0;
  std::vector<Vec3d> vertices_;
  std::vector<double> x_, y_, z_;  ///< of the vertices, if there are up to kMostScanned
  std::vector<std::uint32_t> meshVertex_, leastTriangle_;
  std::vector<Face> faces_;  ///< and one more that ends the last
  std::vector<Corner> corners_;
  std::vector<std::uint32_t> firstCornerAt_, cornersAt_, neighbours_;
  std::vector<std::uint32_t> faceOfTriangle_;
  std::vector<Vec3d> directions_;
  std::vector<std::uint32_t> starts_;  ///< near the farthest vertex, for each cell of a cube's sides
  std::size_t cells_ = 0;              ///< along an edge of the cube
};

/// Null for a mesh that is no convex body: that has concave edges by more than rounding, or faces that single vertices
/// exceed by more than that; or is too thin (below kLeastThickness roundings) to decide. Throws std::bad_alloc.
std::unique_ptr<const ConvexPolyhedron> buildConvexPolyhedron(const TriMesh& mesh);
inline constexpr double kLeastThickness = 1000;

}  // namespace otg
