// SPDX-License-Identifier: BSD-3-Clause
// The collider function of two geoms of our class.
#pragma once

#include <ode/collision.h>

#include "ode/pairs/pair_task.h"

namespace otg {

/// dColliderFn. ODE calls it with its space locked. For two geoms of one class the order is opposite to dCollide's: ODE
/// exchanges the sides of the contacts afterwards.
int collideMeshMesh(dGeomID o1, dGeomID o2, int flags, dContactGeom* contact, int skip) noexcept;

/// The same, with the data of each contact if they go somewhere.
int collideMeshes(dGeomID o1, dGeomID o2, int flags, const ContactArray& to) noexcept;
/// The same, of geoms that are known already.
int collideSides(MeshSide&& side1, MeshSide&& side2, int flags, const ContactArray& to) noexcept;
}  // namespace otg
