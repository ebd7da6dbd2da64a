// SPDX-License-Identifier: BSD-3-Clause
// A convex body by what is exact of it: its vertices and planes, or its radius and length.
#pragma once

#include <vector>

#include "shared/math/vec3.h"

namespace otg {

/// In a frame of its own, in which capsules and cylinders lie along z about the origin.
struct ConvexGeometry {
  enum class Kind { kBox, kCapsule, kCylinder, kPolyhedron };
  Kind kind = Kind::kBox;
  Vec3d half{0, 0, 0};                ///< box: half its sides
  double radius = 0;                  ///< capsule, cylinder
  double length = 0;                  ///< half the cylinder's height, half the capsule's without its caps
  std::vector<Vec3d> vertices;        ///< polyhedron, box
  std::vector<Vec3d> faceNormals;     ///< unit, outward, of flat faces: of a cylinder its two ends
  std::vector<double> faceOffsets;    ///< normal . x on the face
  Vec3d low{0, 0, 0}, high{0, 0, 0};  ///< corners of a box around it
  Vec3d middle{0, 0, 0};              ///< a point well inside: of a polyhedron the mean of its vertices

  double reach = 0;  ///< of the ball about the middle that holds all of it

  /// Sets the box, the middle and the reach from the vertices.
  void bound();
  bool isCurved() const { return kind == Kind::kCapsule || kind == Kind::kCylinder; }
  /// The farthest point along a direction.
  Vec3d support(const Vec3d& direction) const;
  /// How far a point inside is from the surface along a unit direction; negative for a point outside.
  double exitDistance(const Vec3d& point, const Vec3d& direction) const;
  /// Whether a point of a segment is in the body, each of whose surfaces is moved outward by `slack`. Not of capsules.
  bool isNearSegment(const Vec3d& from, const Vec3d& to, double slack) const;
};

}  // namespace otg
