// SPDX-License-Identifier: BSD-3-Clause
// Points of a surface that are near a point, by the tree. Everything is in the frame of the mesh, in double.
#pragma once

#include <cstdint>
#include <limits>
#include <memory_resource>
#include <vector>

#include "bvh/collision_mesh.h"

namespace otg {

/// The part of a triangle that a point of it lies on: edge k runs from corner k to corner (k + 1) % 3.
enum class TrianglePart : std::uint8_t { kFace, kEdge0, kEdge1, kEdge2, kCorner0, kCorner1, kCorner2 };

/// A point of a surface.
struct SurfacePoint {
  Vec3d point{};
  double distance = std::numeric_limits<double>::infinity();  ///< from the point that was queried
  std::uint32_t triangle = kNone;                             ///< kNone: there is no such point
  TrianglePart part = TrianglePart::kFace;
};

/// The nearest point of one triangle. Source: C. Ericson, Real-Time Collision Detection (2005), 5.1.5.
SurfacePoint closestOnTriangle(const Vec3d corners[3], const Vec3d& point);
/// The same of a triangle of a mesh.
SurfacePoint pointOnTriangle(const TriMesh& mesh, std::uint32_t triangle, const Vec3d& point);

/// The nearest point of the mesh if it is at most `limit` away; of equally near triangles the smallest number. A
/// triangle counts as no nearer than its box is (otgSearchDistance), so that the result is that of every tree.
SurfacePoint closestPoint(const CollisionMesh& mesh, const Vec3d& point,
                          double limit = std::numeric_limits<double>::infinity());

/// The nearest point of every triangle that is at most `radius` away -> out, in the order of the tree.
void trianglesWithin(const CollisionMesh& mesh, const Vec3d& point, double radius, std::pmr::vector<SurfacePoint>& out);

/// Corners of a triangle as doubles.
void cornersOf(const TriMesh& mesh, std::uint32_t triangle, Vec3d out[3]);
/// Unit outward normal of a triangle; zero for a degenerate one.
Vec3d faceNormal(const TriMesh& mesh, std::uint32_t triangle);

}  // namespace otg
