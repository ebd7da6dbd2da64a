// SPDX-License-Identifier: BSD-3-Clause
// What can be put right in a mesh on request.
#pragma once

#include <cstdint>
#include <vector>

#include "mesh/topology.h"
#include "mesh/tri_mesh.h"
#include "mesh/validation.h"

namespace otg {

/// Does what `options` ask for, in the order of its members, and reports it. Where vertices are merged, `inputVertexOf`
/// becomes the given vertex that each remaining one is; otherwise it is left alone. Vertices that lose their last
/// triangle stay.
void repairMesh(const RepairOptions& options, std::vector<Vec3f>& vertices, std::vector<Triangle>& triangles,
                std::vector<std::uint32_t>& inputVertexOf, RepairReport& report);

}  // namespace otg
