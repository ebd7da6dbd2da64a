// SPDX-License-Identifier: BSD-3-Clause
// What can be put right in a mesh on request.
#pragma once

#include <cstdint>
#include <vector>

#include "mesh/topology.h"
#include "mesh/validation.h"

namespace otg {

/// Which repairs buildTriMesh may do. All off by default: triangle numbers stay the caller's.
struct RepairOptions {
  bool weldVertices = false;        ///< merge vertices with equal positions (bitwise, -0 equal to +0)
  bool dropDegenerate = false;      ///< remove zero-area triangles (those that close the surface: by edge flips)
  bool dropDuplicates = false;      ///< remove all but the first of triangles with the same three vertices
  bool orientConsistently = false;  ///< flip triangles so that neighbours agree and closed components face outward
  static RepairOptions all() { return {true, true, true, true}; }
};

/// Does what `options` request, in the order of its members, and reports it. Where vertices are merged, `inputVertexOf`
/// becomes the given vertex that each remaining one is; otherwise it is left alone. Vertices that lose their last
/// triangle stay.
void repairMesh(const RepairOptions& options, std::vector<Vec3f>& vertices, std::vector<Triangle>& triangles,
                std::vector<std::uint32_t>& inputVertexOf, RepairReport& report);

}  // namespace otg
