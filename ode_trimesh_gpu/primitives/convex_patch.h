// SPDX-License-Identifier: BSD-3-Clause
// The part of a mesh's surface inside a convex shape, where that part is convex itself; and the shortest way for the
// shape to leave it.
#pragma once

#include <memory_resource>
#include <span>
#include <vector>

#include "base/vectors.h"
#include "collide/solid/regions.h"
#include "collide/surface/placed_body.h"
#include "primitives/convex_shape.h"

namespace otg {

/// PlacedBody of a shape of ODE's.
class PlacedShape : public PlacedBody {
 public:
  PlacedShape(const ConvexShape& shape, const Transformd& pose, const Vec3d& origin)
      : PlacedBody(shape, pose, origin), shape_(&shape) {}
  const ConvexShape& shape() const { return *shape_; }

 private:
  const ConvexShape* shape_;
};

/// How a shape leaves a patch.
struct WayOut {
  Vec3d direction{0, 0, 0};                   ///< unit; the shape moves along it
  double depth = 0;                           ///< by this much; not more than zero: they do not overlap
  bool overEdges = false;                     ///< the shape slides over an edge of the mesh
  Vec3d onMesh{0, 0, 0}, alongMesh{0, 0, 0};  ///< overEdges: a point of the mesh's edge, and its direction
  Vec3d alongShape{0, 0, 0};  ///< overEdges: direction of the shape's straight edge or side; zero: it meets at a point
};

/// Out of a curved shape from a point, through the nearest point of its round side; zero on the axis.
Vec3d wayToRoundSide(const PlacedShape& shape, const Vec3d& point);
/// How far in front of a plane of the patch a point of it may lie.
double toleranceOf(const PlacedMeshes& meshes, const Region& region);

class ConvexPatch {
 public:
  /// A region of more pieces is a dense one.
  static constexpr std::uint32_t kMostPieces = 256;

  explicit ConvexPatch(std::pmr::memory_resource* memory)
      : memory_(memory),
        planes_(memory),
        edges_(memory),
        points_(memory),
        corners_(memory),
        triangles_(memory),
        vertices_(memory) {}

  /// Reads the surface of mesh A in the region. Returns whether it is convex: no point of the region lies in front of
  /// any of its planes, to within the rounding of its vertices.
  bool read(const PlacedMeshes& meshes, const OverlapRegions& all, const Region& region);

  /// The same of a region that is described by cells, or has too many pieces: reads its triangles from the mesh. Those
  /// whose corners are all outside of the shape count only if they are large.
  bool readDense(const PlacedMeshes& meshes, const OverlapRegions& all, const Region& region, const PlacedShape& shape);
  bool isDense() const { return dense_ != nullptr; }

  /// Of mesh A, where there are too many for planes of their own; else none.
  std::span<const std::uint32_t> triangles() const { return triangles_; }

  /// The least translation that takes the shape out of the half spaces behind the patch. It is over all directions in
  /// which the patch has a supporting plane: its faces, the arcs between the normals of two faces at an edge, and the
  /// cones at corners. For boxes and polyhedra these are the separating axes: normals of faces of either and products
  /// of edges; for curved shapes the least over an arc is searched for, and corners leave through the nearest point of
  /// the surface. `out` says roughly where out is; zero if unknown. Of a dense patch only the edges and corners of the
  /// faces with the shortest ways are tried.
  WayOut leave(const PlacedShape& shape, const Vec3d& out) const;

  /// A triangle of the patch.
  std::uint32_t anyTriangle() const { return anyTriangle_; }

  /// How far a point behind the planes is from leaving along d.
  double wayOut(const Vec3d& point, const Vec3d& d) const;

 private:
  struct Plane {
    Vec3d normal;
    double offset;
  };
  struct Edge {
    Vec3d point, direction, normal1, normal2;
  };
  void readEdges(const PlacedMeshes& meshes, const std::pmr::vector<std::pair<std::uint32_t, std::uint32_t>>& planeOf);
  bool hasSupport(const Vec3d& d, double& height) const;
  bool isInCone(const Vec3d& d, const Vec3d& at) const;
  bool isConvexDense() const;
  std::uint32_t keptNumber(std::uint32_t triangle) const;
  bool isWhole(std::uint32_t vertex) const;
  bool isSupport(std::uint32_t vertex, const Vec3d& d) const;
  void tryAround(const PlacedShape& shape, std::uint32_t triangle, const Vec3d& out, WayOut& best) const;
  WayOut leaveDense(const PlacedShape& shape, const Vec3d& out) const;
  void offer(const PlacedShape& shape, const Vec3d& d, double height, double handicap, WayOut& best) const;
  void tryEdge(const PlacedShape& shape, const Edge& edge, WayOut& best) const;

  std::pmr::memory_resource* memory_;
  Vec3d origin_{};
  double tolerance_ = 0;
  std::uint32_t anyTriangle_ = kNone;
  std::pmr::vector<Plane> planes_;
  std::pmr::vector<Edge> edges_;
  std::pmr::vector<Vec3d> points_;   ///< of mesh A's surface in the region
  std::pmr::vector<Vec3d> corners_;  ///< those of them that are vertices
  // Dense patches have a plane for each triangle instead.
  const CollisionMesh* dense_ = nullptr;
  std::pmr::vector<std::uint32_t> triangles_;  ///< ascending; triangle i has plane i
  std::pmr::vector<std::uint32_t> vertices_;   ///< welded, of these triangles, ascending
};

}  // namespace otg
