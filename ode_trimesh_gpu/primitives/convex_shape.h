// SPDX-License-Identifier: BSD-3-Clause
// A convex shape of ODE's: what it is exactly, and a closed mesh that stands for it where triangles are needed.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "bvh/collision_mesh.h"
#include "mesh/convex_geometry.h"

namespace otg {

/// Immutable.
struct ConvexShape : ConvexGeometry {
  std::vector<Vec3d> edgeDirections;  ///< unit, of a box or polyhedron, each once
  /// Exact (to the rounding of its vertices) for boxes and polyhedra. Around curved shapes: its facets touch them.
  std::shared_ptr<const CollisionMesh> mesh;
};

/// These keep the shapes requested last, so that requesting the same again costs a look-up. Any number of threads. Null
/// for shapes without volume, and where lengths are too large for single precision. May throw std::bad_alloc.
std::shared_ptr<const ConvexShape> boxShape(const Vec3d& half);
std::shared_ptr<const ConvexShape> capsuleShape(double radius, double halfLength);
std::shared_ptr<const ConvexShape> cylinderShape(double radius, double halfHeight);
/// The convex hull of points.
std::shared_ptr<const ConvexShape> polyhedronShape(std::span<const Vec3d> points);

}  // namespace otg
