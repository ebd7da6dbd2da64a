// SPDX-License-Identifier: BSD-3-Clause
// Collecting and welding of triangles given by positions.
#include "scenes/mesh_builder.h"

namespace otg::scenes {

void MeshBuilder::triangle(const Vec3d& a, const Vec3d& b, const Vec3d& c) {
  const Vec3f p = toFloat(a), q = toFloat(b), r = toFloat(c);
  if (p == q || q == r || r == p) return;
  corners_.insert(corners_.end(), {p, q, r});
}

MeshArrays MeshBuilder::finish() const {
  const std::vector<std::uint32_t> weld = weldByPosition(corners_);
  MeshArrays mesh;
  std::vector<std::uint32_t> number(corners_.size());
  for (std::uint32_t i = 0; i < corners_.size(); ++i) {
    if (weld[i] != i) {
      number[i] = number[weld[i]];
      continue;
    }
    number[i] = static_cast<std::uint32_t>(mesh.vertices.size());
    mesh.vertices.push_back(corners_[i]);
  }
  mesh.triangles.resize(corners_.size() / 3);
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
    mesh.triangles[t] = {{number[3 * t], number[3 * t + 1], number[3 * t + 2]}};
  return mesh;
}

}  // namespace otg::scenes
