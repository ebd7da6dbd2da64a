// SPDX-License-Identifier: BSD-3-Clause
// How far one convex body has to go to be clear of another one, by their support functions alone.
#pragma once

#include <vector>

#include "shared/math/vec3.h"

namespace otg::truth {

/// Bodies lie about the origin of their own frames, capsules and cylinders along z.
struct ConvexBody {
  enum class Kind { kSphere, kBox, kCapsule, kCylinder, kPolyhedron };
  Kind kind = Kind::kSphere;
  Vec3d half{0, 0, 0};            ///< box: half its sides
  double radius = 0, length = 0;  ///< the others; half the height, of a capsule without its caps
  std::vector<Vec3d> vertices;    ///< polyhedron
  std::vector<Vec3d> normals;     ///< unit, of a polyhedron's faces: where the search for its ways out begins
  Transformd pose{};

  /// How far it reaches along a unit direction.
  double reach(const Vec3d& direction) const;
};

/// How far b has to go along d until it is clear of a.
double separation(const ConvexBody& a, const ConvexBody& b, const Vec3d& d);

/// The least of it over all directions; not positive for bodies that are apart. Many starts, the bodies' axes and their
/// products among them, each improved by ever smaller steps sideways: to about 1e-7 of the bodies' size.
double leastSeparation(const ConvexBody& a, const ConvexBody& b);

/// The least over the directions with which the search begins: no less than that, mostly near to it, and quick.
double roughSeparation(const ConvexBody& a, const ConvexBody& b);

/// How b gets clear of a.
struct WaysApart {
  Vec3d direction{0, 0, 0};  ///< unit: of the shortest way
  double least = 0;          ///< and its length
  double other = 0;          ///< length of the shortest way whose direction is at least so many degrees from that one
};
/// The same search; `degrees` is less than 90.
WaysApart waysApart(const ConvexBody& a, const ConvexBody& b, double degrees);

}  // namespace otg::truth
