// SPDX-License-Identifier: BSD-3-Clause
// Mirror images of scenes.
#pragma once

#include <utility>

#include "scenes/generated_meshes.h"

namespace otg::test {

/// Through the plane x = z, or through x = 0.
enum class Mirror { kDiagonal, kAcross };

inline Vec3d image(Mirror mirror, const Vec3d& v) {
  return mirror == Mirror::kDiagonal ? Vec3d{v.z, v.y, v.x} : Vec3d{-v.x, v.y, v.z};
}
inline scenes::MeshArrays image(Mirror mirror, scenes::MeshArrays mesh) {
  for (Vec3f& v : mesh.vertices) {
    if (mirror == Mirror::kDiagonal) {
      std::swap(v.x, v.z);
    } else {
      v.x = -v.x;
    }
  }
  for (Triangle& t : mesh.triangles) std::swap(t.v[1], t.v[2]);
  return mesh;
}
/// S R S, S t: what maps the mirrored local frame to the mirrored world.
inline Transformd image(Mirror mirror, const Transformd& pose) {
  Transformd result{{}, image(mirror, pose.t)};
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column) {
      result.r[3 * row + column] = mirror == Mirror::kDiagonal
                                       ? pose.r[3 * (2 - row) + 2 - column]
                                       : pose.r[3 * row + column] * ((row == 0) == (column == 0) ? 1 : -1);
    }
  }
  return result;
}

/// The image through x = 0.
template <class T>
T mirror(const T& of) {
  return image(Mirror::kAcross, of);
}

}  // namespace otg::test
