// SPDX-License-Identifier: BSD-3-Clause
// Rays through a mesh's tree, in double: how far it is out of a mesh, and whether a point is inside.
#pragma once

#include "collide/placed_meshes.h"

namespace otg {

/// Distance from `origin` along the unit vector `direction` (both in A's frame) to where the ray leaves the solid
/// `mesh`. 0 when it starts outside (the next surface ahead faces against it); negative when there is no surface up to
/// `limit`. Surfaces nearer than `skin` that face against the ray are passed over: the origin is on them.
double exitDistance(const PlacedMeshes& meshes, int mesh, const Vec3d& origin, const Vec3d& direction, double limit,
                    double skin, std::uint32_t* triangle = nullptr);

/// Whether a vertex of the other mesh lies inside the solid `mesh`, by the signs of shared/tests/sos.h: A is thought to
/// be moved by (e, e^2, e^3), so that nothing lies on a surface, and the result is exact. It agrees with the contour.
bool vertexInside(const PlacedMeshes& meshes, int mesh, const Vec3d& vertex);

/// Parity of crossings along up to three rays in fixed skew directions: the first two that agree decide.
bool pointInside(const PlacedMeshes& meshes, int mesh, const Vec3d& point);
/// The same for a point in the frame of one mesh.
bool pointInMesh(const CollisionMesh& mesh, const Vec3d& point);

}  // namespace otg
