// SPDX-License-Identifier: BSD-3-Clause
// Convex hulls as meshes, and ODE's vectors as ours.
#pragma once

#include <ode/ode.h>

#include <vector>

#include "primitives/convex_hull.h"
#include "scenes/mesh_arrays.h"

namespace otg::test {

inline Vec3d toVec(const dReal* p) {
  return {p[0], p[1], p[2]};
}

/// The convex hull of the points as a closed mesh. Points inside it are no vertices.
inline scenes::MeshArrays hullOf(const std::vector<Vec3d>& points) {
  scenes::MeshArrays mesh;
  std::vector<std::uint32_t> number(points.size(), 0);
  for (const auto& face : convexHull(points)) {
    Triangle& t = mesh.triangles.emplace_back();
    for (std::size_t k = 0; k < 3; ++k) {
      std::uint32_t& n = number[face[k]];
      if (n == 0) {
        mesh.vertices.push_back(scenes::toFloat(points[face[k]]));
        n = static_cast<std::uint32_t>(mesh.vertices.size());
      }
      t.v[k] = n - 1;
    }
  }
  return mesh;
}

}  // namespace otg::test
