// SPDX-License-Identifier: BSD-3-Clause
// Files of cooked meshes.
#pragma once

#include <string>

#include "bvh/cooked_mesh.h"

namespace otg::cli {

/// Whether the file begins as a cooked mesh does.
bool isCookedFile(const std::string& path);
/// As uncookMesh(); a file that cannot be read is refused, too.
UncookedMesh loadCookedFile(const std::string& path);

}  // namespace otg::cli
