// SPDX-License-Identifier: BSD-3-Clause
// Reading triangle meshes from files, exactly as they are written there.
#pragma once

#include <memory>
#include <stdexcept>
#include <string>

#include "mesh_io/file_content.h"

namespace otg::mesh_io {

/// The file cannot be read; what() names the file and says what is wrong with it.
class LoadError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// PLY (text and binary of both byte orders), OFF, STL (text and binary), OBJ through readers of our own; cooked
/// meshes, whose trees are built again; everything else (glTF first of all, which is checked before: gltf_check.h)
/// through Assimp. Formats without shared vertices (STL, and what Assimp expands) get equal positions joined, in the
/// order of first appearance. Throws LoadError.
///
/// Why own readers for four simple formats: measured with Assimp 5.2, a PLY cut off in its faces loads without an
/// error. Joining reads past the vertex array for an index out of range, and merges NaN vertices. OBJ loses its vertex
/// sharing, and decimal numbers are not rounded correctly.
MeshFile loadMeshFile(const std::string& path);

/// loadMeshFile, then buildTriMesh; throws LoadError with the report's error when the mesh is refused.
std::shared_ptr<const TriMesh> loadTriMesh(const std::string& path, const RepairOptions& repair = {},
                                           MeshOrder order = MeshOrder::kInput);

}  // namespace otg::mesh_io
