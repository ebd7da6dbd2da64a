// SPDX-License-Identifier: BSD-3-Clause
// The shortest way out of an overlap, where there is a formula for it.
#pragma once

#include "mesh/tri_mesh.h"

namespace otg::truth {

/// Moving A by `depth` along `direction` (unit, A's frame, out of B) just separates the bodies; no shorter move does.
/// A depth below 0 is the distance of bodies that are apart, as far as a single axis shows it.
struct Separation {
  Vec3d direction{0, 0, 0};
  double depth = 0;
};

/// Boxes of half side lengths, centred in their frames: the separating-axis theorem, 15 axes. Exact.
Separation boxBox(const Vec3d& halfA, const Vec3d& halfB, const Transformd& bInA);

/// A body A whose signed distance is known, and a ball B: outward along the gradient of the distance at its centre.
/// Exact while the nearest point of A's surface is unique.
Separation ballAndDistance(double distance, const Vec3d& outward, double radius);

/// Signed distance of a point and its gradient (unit). Box: half side lengths; cylinder and torus: around z.
struct Distance {
  double value = 0;
  Vec3d outward{0, 0, 0};
};
Distance distanceToBall(double radius, const Vec3d& p);
Distance distanceToBox(const Vec3d& half, const Vec3d& p);
Distance distanceToCylinder(double radius, double halfHeight, const Vec3d& p);
Distance distanceToTorus(double major, double minor, const Vec3d& p);

/// How far A must move along `direction` until the two meshes' extents along it only touch: exact for convex meshes,
/// facets included.
double extentDepth(const TriMesh& a, const TriMesh& b, const Transformd& bInA, const Vec3d& direction);

}  // namespace otg::truth
