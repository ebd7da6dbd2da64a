// SPDX-License-Identifier: BSD-3-Clause
// The collider function of two geoms of our class.
#pragma once

#include <ode/collision.h>

#include "collide/query.h"
#include "ode/pairs/pair_task.h"
#include "ode_trimesh_gpu/contact_data.h"
#include "ode_trimesh_gpu/params.h"

namespace otg {

/// dColliderFn. ODE calls it with its space locked and, for two geoms of one class, in the order opposite to dCollide's
/// (it exchanges the sides of the contacts afterwards).
int collideMeshMesh(dGeomID o1, dGeomID o2, int flags, dContactGeom* contact, int skip) noexcept;

/// The same, with the data of each contact if they go somewhere.
int collideMeshes(dGeomID o1, dGeomID o2, int flags, const ContactArray& to) noexcept;
/// The same, of geoms that are known already.
int collideSides(MeshSide&& side1, MeshSide&& side2, int flags, const ContactArray& to) noexcept;
/// What `contact` says to a caller of dGpuTriMeshCollideEx; `first` says whether mesh A is o1.
dGpuTriMeshContactData contactData(const Query& query, const Contact& contact, bool first);

/// Where b's frame lies in a's: R = Ra^T Rb, t = Ra^T (xb - xa), in double.
Transformd relativePose(const Transformd& a, const Transformd& b);

/// The choices for a pair out of those of its geoms; symmetric but for the traversal, which is `first`'s.
CollideOptions pairOptions(const dGpuTriMeshParams& first, const dGpuTriMeshParams& second);

}  // namespace otg
