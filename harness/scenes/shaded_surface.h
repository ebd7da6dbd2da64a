// SPDX-License-Identifier: BSD-3-Clause
// A mesh as graphics cards take it: a normal for each vertex.
#pragma once

#include <cstdint>
#include <vector>

#include "mesh/tri_mesh.h"

namespace otg::scenes {

/// Three numbers for each vertex and three indices for each triangle. A vertex at a sharp edge is there once for each
/// side.
struct ShadedSurface {
  std::vector<float> positions, normals;
  std::vector<std::uint32_t> indices;
};

/// Normals are the area-weighted mean over the faces around the (welded) vertex that lie within 40 degrees.
ShadedSurface shade(const TriMesh& mesh);

}  // namespace otg::scenes
