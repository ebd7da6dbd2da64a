// SPDX-License-Identifier: BSD-3-Clause
// What the contact model `solid` looks at of a mesh, as it lies on a device.
#pragma once

#include "opencl/packed_mesh.h"

namespace otg::opencl {

/// Sets OTG_MESH_CLOSED or OTG_MESH_SHEET of solids and sheets, and appends the section that shared/solid_layout.h
/// describes (OTG_MESH_LISTED, OTG_MESH_SOLID) unless the mesh is too odd for devices. The rings come right before it.
void addSolid(PackedMesh& out, const CollisionMesh& collisionMesh);

}  // namespace otg::opencl
