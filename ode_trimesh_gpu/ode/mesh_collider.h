// SPDX-License-Identifier: BSD-3-Clause
// The collider function of two geoms of our class.
#pragma once

#include <ode/collision.h>

#include "collide/query.h"
#include "ode_trimesh_gpu/params.h"

namespace otg {

/// dColliderFn. ODE calls it with its space locked and, for two geoms of one class, in the order opposite to dCollide's
/// (it exchanges the sides of the contacts afterwards).
int collideMeshMesh(dGeomID o1, dGeomID o2, int flags, dContactGeom* contact, int skip) noexcept;

/// Where b's frame lies in a's: R = Ra^T Rb, t = Ra^T (xb - xa), in double.
Transformd relativePose(const Transformd& a, const Transformd& b);

/// The choices for a pair out of those of its geoms; symmetric but for the traversal, which is `first`'s.
CollideOptions pairOptions(const dGpuTriMeshParams& first, const dGpuTriMeshParams& second);

/// Frees what the calling thread keeps between collisions.
void freeThreadScratch() noexcept;

}  // namespace otg
