// SPDX-License-Identifier: BSD-3-Clause
// What CGAL answers about points, rays and distances. Its headers are seen by cgal_queries.cpp alone.
#pragma once

#include <memory>
#include <vector>

#include "mesh/tri_mesh.h"

namespace otg::test {

/// A closed mesh placed by p -> R p + t, in CGAL's AABB tree. Predicates are exact; distances are in double.
class CgalSurface {
 public:
  CgalSurface(const TriMesh& mesh, const Transformd& pose);
  ~CgalSurface();
  CgalSurface(const CgalSurface&) = delete;
  CgalSurface& operator=(const CgalSurface&) = delete;

  double distance(const Vec3d& point) const;
  bool isInside(const Vec3d& point) const;
  /// Distances from the origin, in lengths of the direction, at which the ray goes through the surface; ascending.
  std::vector<double> hits(const Vec3d& origin, const Vec3d& direction) const;
  /// The least distance of all pairs of triangles; 0 where two intersect.
  double distance(const CgalSurface& other) const;

 private:
  struct Tree;
  std::unique_ptr<Tree> tree_;
};

}  // namespace otg::test
