// SPDX-License-Identifier: BSD-3-Clause
// Making what is sent of a mesh.
#pragma once

#include <cstdint>
#include <memory>

#include "opencl/meshes/packed_mesh.h"

namespace otg::opencl {

class PackedPlaces;

/// For kEightWide: `leafTriangles`, the most triangles of a leaf; `cutOrder` as in Tuning; `places`, if requested,
/// receives what is needed to send changes of the mesh later.
PackedMesh packMesh(const CollisionMesh& mesh, MeshLayout layout, std::uint32_t leafTriangles,
                    std::uint32_t cutOrder = 0, std::shared_ptr<const PackedPlaces>* places = nullptr);

}  // namespace otg::opencl
