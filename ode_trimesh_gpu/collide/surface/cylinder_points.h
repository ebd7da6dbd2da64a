// SPDX-License-Identifier: BSD-3-Clause
// A round cylinder in the frame of the mesh that it meets, and the points of it that become contacts.
#pragma once

#include <cstdint>

#include "base/vectors.h"
#include "mesh/convex_geometry.h"

namespace otg {

/// In a mesh's frame.
struct PlacedCylinder {
  Vec3d middle, axis;   ///< the axis of unit length
  double radius, half;  ///< half its height

  /// The part of a vector that is across the axis.
  Vec3d across(const Vec3d& v) const { return v - axis * otgDot(axis, v); }
  /// The point that is farthest against a unit vector m. Of a line or an end across m it is the middle along the axis,
  /// or the centre.
  Vec3d rear(const Vec3d& m) const {
    constexpr double kShort = 1e-4, kNothing = 1e-12;
    const double along = otgDot(axis, m);
    const Vec3d end = middle - axis * (along == 0 ? 0 : std::copysign(half, along));
    Vec3d aside = m - axis * along;
    double length = norm(aside);
    if (length < kShort) {  // what rounding has left along the axis would count
      aside = across(aside);
      length = norm(aside);
      if (length < kNothing) return end;
    }
    return end - aside * (radius / length);
  }
  /// How far it reaches against a unit vector m, from the origin.
  double reachBack(const Vec3d& m) const {
    const double along = otgDot(axis, m);
    return radius * norm(m - axis * along) + half * std::fabs(along) - otgDot(m, middle);
  }
  double widthAlong(const Vec3d& m) const { return 2 * (radius * norm(across(m)) + half * std::fabs(otgDot(axis, m))); }
};

/// Numbers of a cylinder's points (Contact::element). Those of its two ends differ by 16.
enum CylinderElement : std::uint32_t {
  kCylinderRim = 0,
  kCylinderLowest = 8,
  kCylinderSideEnd = 32,
  kCylinderSide = 40
};

/// Of the overlap: a place that is so deep is the deepest one.
inline constexpr double kCylinderAsDeep = 0.99;

PlacedCylinder placedCylinder(const Transformd& pose, const ConvexGeometry& body);

/// The rim of an end, in the frame that the pose takes the cylinder to.
struct CylinderRim {
  CylinderRim(const Transformd& pose, const Vec3d& centre, double radius);
  static constexpr std::uint32_t kPoints = 8;
  /// Fixed on the body, so that they stay while it trembles.
  Vec3d point(std::uint32_t k) const;

  Vec3d centre, u, v;  ///< u and v: from the centre to points of the rim, at right angles
};

}  // namespace otg
