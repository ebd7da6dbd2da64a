// SPDX-License-Identifier: BSD-3-Clause
// The area of a triangle as a vector, whose direction is the normal.
#pragma once

#include "mesh/tri_mesh.h"

namespace otg {

/// (p1 - p0) x (p2 - p0), in the mesh's own frame. Its direction is right to nine digits however thin the triangle is.
/// Zero for degenerate triangles alone.
Vec3d areaVector2(const TriMesh& mesh, std::uint32_t triangle);

}  // namespace otg
