// SPDX-License-Identifier: BSD-3-Clause
// The readers behind loadMeshFile, one per format. Each takes the whole file and throws std::runtime_error that says
// what is wrong and where (the file's name is added by loadMeshFile).
#pragma once

#include <string>
#include <string_view>

#include "mesh_io/file_content.h"

namespace otg::mesh_io {

MeshFile readPly(std::string_view bytes);
MeshFile readOff(std::string_view bytes);
MeshFile readStl(std::string_view bytes);
MeshFile readObj(std::string_view bytes);
/// Whether the name is that of a glTF file.
bool isGltf(const std::string& path);
/// Any format that Assimp knows; `path` because glTF refers to files beside it. Of glTF what checkGltf() has let pass.
MeshFile readWithAssimp(const std::string& path);

}  // namespace otg::mesh_io
