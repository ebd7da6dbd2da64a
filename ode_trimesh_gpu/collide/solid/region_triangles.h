// SPDX-License-Identifier: BSD-3-Clause
// The triangles on which a region's pieces lie, for regions whose points must each be measured on the surface itself.
#pragma once

#include <cstdint>
#include <vector>

#include "collide/placed_meshes.h"
#include "collide/solid/overlap_regions.h"

namespace otg {

/// One triangle of a mesh, whole: the piece is the part of it that lies inside the other mesh.
struct RegionTriangle {
  Vec3d normal;     ///< unit, outward
  double offset;    ///< normal . x on its plane, relative to OverlapRegions::origin
  Vec3d inward[3];  ///< unit, in its plane, from each edge to the inside
  double edge[3];   ///< inward . x on each edge
  std::uint8_t mesh;
  /// How far a point of its plane lies beside it; 0 or less if it lies in it.
  double beside(const Vec3d& p) const;
};

class RegionTriangles {
 public:
  /// Only for regions whose pieces are parts of single triangles: none of cells.
  void collect(const PlacedMeshes& meshes, const OverlapRegions& all, const Region& region);
  const std::vector<RegionTriangle>& all() const { return triangles_; }
  /// Way along a unit direction through the nearest triangle of mesh m that faces along it; infinity if none is met.
  /// What lies behind counts as met at once. `slack`: how far beside a triangle still counts as on it.
  double wayOut(int m, const Vec3d& from, const Vec3d& direction, double slack) const;

 private:
  std::vector<RegionTriangle> triangles_;
};

}  // namespace otg
