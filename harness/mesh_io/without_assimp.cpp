// SPDX-License-Identifier: BSD-3-Clause
// In place of assimp.cpp in builds without Assimp (OTG_WITH_ASSIMP).
#include <stdexcept>

#include "mesh_io/readers.h"

namespace otg::mesh_io {

MeshFile readWithAssimp(const std::string&) {
  throw std::runtime_error("is of a format that this build cannot read: it has PLY, OFF, STL, OBJ and cooked meshes");
}

}  // namespace otg::mesh_io
