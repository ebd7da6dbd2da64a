// SPDX-License-Identifier: BSD-3-Clause
// Reads the OFF files that Debian's libcgal-demo ships.
#pragma once

#include <string>

#include "scenes/generated_meshes.h"

namespace otg::test {

/// Polygons become fans. Throws std::runtime_error naming the file if it is not an OFF file.
scenes::MeshArrays readOff(const std::string& path);

}  // namespace otg::test
