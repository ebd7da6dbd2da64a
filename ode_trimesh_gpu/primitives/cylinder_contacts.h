// SPDX-License-Identifier: BSD-3-Clause
// Contacts between a convex mesh and a cylinder, without triangles.
#pragma once

#include "collide/query.h"
#include "primitives/convex_shape.h"
#include "primitives/cylinder_separation.h"

namespace otg {

/// Numbers of a cylinder's points (Contact::element). Those of its two ends differ by 16.
enum CylinderElement : std::uint32_t {
  kCylinderRim = 0,
  kCylinderLowest = 8,
  kCylinderSideEnd = 32,
  kCylinderSide = 40
};

/// Of the overlap: a place that is so deep is the deepest one.
inline constexpr double kCylinderAsDeep = 0.99;

PlacedCylinder placedCylinder(const Transformd& pose, const ConvexShape& shape);

/// The rim of an end, in the frame that the pose takes the cylinder to.
struct CylinderRim {
  CylinderRim(const Transformd& pose, const Vec3d& centre, double radius);
  static constexpr std::uint32_t kPoints = 8;
  /// Fixed on the body, so that they stay while it trembles.
  Vec3d point(std::uint32_t k) const;

  Vec3d centre, u, v;  ///< u and v: from the centre to points of the rim, at right angles
};

/// As collideConvexPair(), with the round cylinder in place of query.b, whose mesh is only remembered: the direction of
/// the least overlap is the normal of all contacts. Their depths are those of the round body. False for other shapes
/// and pairs, and where the stages for any solids have more to say.
bool collideCylinder(const Query& query, const ConvexShape& shape, Workspace& workspace);

}  // namespace otg
