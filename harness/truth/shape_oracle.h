// SPDX-License-Identifier: BSD-3-Clause
// A mesh and one of ODE's shapes, triangle by triangle and without any of the library's collision code.
#pragma once

#include "truth/pair_body.h"
#include "truth/triangle_distance.h"

namespace otg::truth {

class ShapeOracle : public PairOracle {
 public:
  /// `meshMoves`: 1 where the mesh is the pair's A, -1 where the shape is.
  ShapeOracle(const PairBody& mesh, const PairBody& shape, double meshMoves, double grain);
  bool overlapped(const Vec3d& translation) override;
  std::optional<double> volume(const Vec3d&) override { return {}; }
  std::vector<Vec3d> faceDirections() override;

 private:
  bool meets(const Corners& inShape) const;
  /// Whether the shape, which meets no triangle, is inside the mesh. `by`: of the mesh.
  bool isWithin(const Vec3d& by) const;

  ConvexBody shape_;
  std::vector<double> offsets_;  ///< of a polyhedron's faces
  Transformd shapePose_;
  std::vector<Corners> triangles_;  ///< in the shape's frame
  Vec3d middle_{0, 0, 0};           ///< a point within the shape
  double bound_ = 0;                ///< radius of the shape about its origin
  double meshMoves_, grain_;
};

}  // namespace otg::truth
