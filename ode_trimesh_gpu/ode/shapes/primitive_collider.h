// SPDX-License-Identifier: BSD-3-Clause
// The collider function of a geom of our class with one of ODE's own.
#pragma once

#include <ode/collision.h>

#include "ode/shapes/primitive_task.h"

namespace otg {

/// dColliderFn: o1 is the mesh, of our class or a dTriMesh, whatever the order of the call (ODE exchanges the sides
/// afterwards).
int collideMeshPrimitive(dGeomID o1, dGeomID o2, int flags, dContactGeom* contact, int skip) noexcept;

/// Reads the poses. False if the pair can have no contacts; a status in `failure` if that is because of a bad pose.
bool preparePrimitive(PrimitiveTask& task, int& failure);

}  // namespace otg
