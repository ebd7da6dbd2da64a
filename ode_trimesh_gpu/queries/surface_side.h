// SPDX-License-Identifier: BSD-3-Clause
// On which side of a surface a point lies.
#pragma once

#include "queries/closest_point.h"

namespace otg {

/// What a mesh has of an inside: a solid's own; of a sheet (an open mesh whose triangles agree in their winding and
/// share edges by twos at most) what lies behind it; nothing.
enum class SurfaceKind { kSolid, kSheet, kShell };
SurfaceKind surfaceKind(const TriMesh& mesh);

/// Unit outward normal at a point of the surface: of the face, of an edge the mean of its faces, of a corner the mean
/// of its faces weighted by their angles. The side of a nearby point is the sign of its product with this normal.
/// Source: J. A. Baerentzen and H. Aanaes, "Signed Distance Computation Using the Angle Weighted Pseudonormal", 2005.
Vec3d outwardNormal(const CollisionMesh& mesh, const SurfacePoint& at);

/// Whether the point lies inside (on the surface: either result). `nearest` is the surface's nearest point. Of a solid
/// the parity along rays decides; of a sheet the normal at the nearest point, where a point nearest to the rim counts
/// as outside; a shell has no inside.
bool isInside(const CollisionMesh& mesh, const Vec3d& point, const SurfacePoint& nearest);

}  // namespace otg
