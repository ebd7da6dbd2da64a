// SPDX-License-Identifier: BSD-3-Clause
// Meshes in the language of the ray tracer POV-Ray.
#pragma once

#include <fmt/os.h>

#include <cstddef>
#include <filesystem>

#include "mesh/tri_mesh.h"

namespace otg::scenes {

/// Throws std::runtime_error if the file cannot be written.
fmt::ostream openPovrayFile(const std::filesystem::path& path);

/// `#declare Surface_NUMBER = mesh2 {...}`, smooth except across sharp edges.
void writePovraySurface(fmt::ostream& out, std::size_t number, const TriMesh& mesh);

}  // namespace otg::scenes
