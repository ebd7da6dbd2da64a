// SPDX-License-Identifier: BSD-3-Clause
// What a mesh file holds, before anybody has judged it.
#pragma once

#include <vector>

#include "mesh/tri_mesh.h"

namespace otg::mesh_io {

/// What a file holds. Nothing is dropped, reordered or checked beyond what the format itself needs: vertices keep the
/// file's numbers (NaN included), triangles the file's face order. A polygon becomes a fan that starts at its first
/// corner; indices may be out of range. Judging the mesh is buildTriMesh's job.
struct MeshFile {
  std::vector<Vec3d> vertices;      ///< in the file's own units
  std::vector<Triangle> triangles;  ///< a negative index of the file appears as a huge one
  MeshInput input() const;          ///< points into this object
};

/// Merges vertices with bitwise equal positions (-0 equal to +0), keeping the order of first appearance.
void joinEqualVertices(MeshFile& mesh);

}  // namespace otg::mesh_io
