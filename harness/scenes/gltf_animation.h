// SPDX-License-Identifier: BSD-3-Clause
// A moving scene as one binary glTF file, for any viewer.
#pragma once

#include <array>
#include <memory>
#include <string>
#include <vector>

#include "mesh/tri_mesh.h"

namespace otg::scenes {

struct AnimatedBody {
  std::string name;
  std::shared_ptr<const TriMesh> surface;
  Vec3d color{0.7, 0.7, 0.7};  ///< linear RGB
  /// One entry for each frame; a single entry for a body that stands still.
  std::vector<Vec3d> positions;                  ///< of the mesh's origin, world
  std::vector<std::array<double, 4>> rotations;  ///< quaternions w, x, y, z
};

/// `times` in seconds, ascending, one for each frame. z is up in our worlds and y in glTF: the root node turns the
/// scene. Bodies with the same surface share it in the file. Throws std::runtime_error if the file cannot be written.
void writeGlb(const std::string& path, const std::vector<AnimatedBody>& bodies, const std::vector<double>& times);

}  // namespace otg::scenes
