// SPDX-License-Identifier: BSD-3-Clause
// A convex body: what it is exactly, and a closed mesh that stands for it where triangles are needed.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "bvh/collision_mesh.h"

namespace otg {

/// In a frame of its own, in which capsules and cylinders lie along z about the origin. Immutable.
struct ConvexShape {
  enum class Kind { kBox, kCapsule, kCylinder, kPolyhedron };
  Kind kind = Kind::kBox;
  Vec3d half{0, 0, 0};                ///< box: half its sides
  double radius = 0;                  ///< capsule, cylinder
  double length = 0;                  ///< half the cylinder's height, half the capsule's without its caps
  std::vector<Vec3d> vertices;        ///< polyhedron, box
  std::vector<Vec3d> faceNormals;     ///< unit, outward, of flat faces: of a cylinder its two ends
  std::vector<double> faceOffsets;    ///< normal . x on the face
  std::vector<Vec3d> edgeDirections;  ///< unit, of a box or polyhedron, each once
  /// Exact (to the rounding of its vertices) for boxes and polyhedra. Around curved shapes: its facets touch them.
  std::shared_ptr<const CollisionMesh> mesh;

  bool isCurved() const { return kind == Kind::kCapsule || kind == Kind::kCylinder; }
  /// The farthest point along a direction.
  Vec3d support(const Vec3d& direction) const;
  /// How far a point inside is from the surface along a unit direction; negative for a point outside.
  double exitDistance(const Vec3d& point, const Vec3d& direction) const;
  /// Whether a point of a segment is in the shape, each of whose surfaces is moved outward by `slack`. Not of capsules.
  bool isNearSegment(const Vec3d& from, const Vec3d& to, double slack) const;
};

/// These keep the shapes requested last, so that requesting the same again costs a look-up. Any number of threads. Null
/// for shapes without volume, and where lengths are too large for single precision. May throw std::bad_alloc.
std::shared_ptr<const ConvexShape> boxShape(const Vec3d& half);
std::shared_ptr<const ConvexShape> capsuleShape(double radius, double halfLength);
std::shared_ptr<const ConvexShape> cylinderShape(double radius, double halfHeight);
/// The convex hull of points.
std::shared_ptr<const ConvexShape> polyhedronShape(std::span<const Vec3d> points);

}  // namespace otg
