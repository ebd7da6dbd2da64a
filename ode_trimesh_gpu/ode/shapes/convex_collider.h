// SPDX-License-Identifier: BSD-3-Clause
// Box, capsule, cylinder and convex geoms of ODE against a mesh.
#pragma once

#include <span>

#include "collide/query.h"
#include "ode/shapes/primitive_task.h"
#include "primitives/convex_shape.h"

namespace otg {

/// The shape of a box, capsule, cylinder or convex; null if it has no volume. May throw std::bad_alloc.
std::shared_ptr<const ConvexShape> shapeOfGeom(dGeomID geom);

/// The contacts, in the mesh's frame, in the workspace. Reads and writes what the mesh remembers of the pair. May throw
/// std::bad_alloc.
std::span<const Contact> convexGeomContacts(const PrimitiveTask& task, int most, Workspace& workspace);

}  // namespace otg
