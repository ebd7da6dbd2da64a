// SPDX-License-Identifier: BSD-3-Clause
// What the contact model `solid` looks at of a mesh, as it lies on a device.
#pragma once

#include "opencl/packed_mesh.h"

namespace otg::opencl {

/// Appends the section that shared/solid_layout.h describes, and sets OTG_MESH_SOLID, if the mesh is a solid of one
/// component. The rings come right before it.
void addSolid(PackedMesh& out, const CollisionMesh& collisionMesh);

}  // namespace otg::opencl
