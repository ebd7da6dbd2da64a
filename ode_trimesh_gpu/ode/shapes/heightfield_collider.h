// SPDX-License-Identifier: BSD-3-Clause
// A heightfield of ODE's against a mesh: the ground under the mesh is a mesh, too.
#pragma once

#include <span>
#include <vector>

#include "collide/query.h"
#include "ode/shapes/primitive_task.h"

namespace otg {

/// The pose of a heightfield, placeable or not: ODE aborts if the position of one that is not is read, and has no
/// function that shows which it is.
WorldPose readHeightfieldPose(dGeomID field) noexcept;

/// The contacts, in the mesh's frame, in the workspace, as convexGeomContacts() has them. `status` says why there are
/// none, if that is for a reason. May throw std::bad_alloc.
std::span<const Contact> heightfieldContacts(const PrimitiveTask& task, int most, Workspace& workspace, int& status);

/// The triangles of the mesh that intersect the ground, in its own numbers, ascending.
std::vector<std::uint32_t> trianglesOnHeightfield(const PrimitiveTask& task, Workspace& workspace, int& status);

}  // namespace otg
