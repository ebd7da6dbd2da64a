// SPDX-License-Identifier: BSD-3-Clause
// Where meshes and poses of the command line are looked for.
#pragma once

#include <string>

namespace otg::cli {

/// The path as it is; or, where there is no such file, that in the folder of the environment variable OTG_MESH_DIR, if
/// one is there.
std::string findInput(const std::string& path);

}  // namespace otg::cli
