// SPDX-License-Identifier: BSD-3-Clause
// A mesh as plain arrays.
#pragma once

#include <memory>
#include <vector>

#include "mesh/tri_mesh.h"

namespace otg::scenes {

inline Vec3f toFloat(const Vec3d& p) {
  return {static_cast<float>(p.x), static_cast<float>(p.y), static_cast<float>(p.z)};
}

/// Plain arrays; convert with build().
struct MeshArrays {
  std::vector<Vec3f> vertices;
  std::vector<Triangle> triangles;
  MeshInput input() const;
};

/// All of `parts` as one mesh (vertices and triangles appended).
MeshArrays merge(const std::vector<MeshArrays>& parts);
/// A mesh about the origin, scaled to a radius.
MeshArrays broughtToOrigin(const TriMesh& mesh, float radius);
/// Rotated and moved copy.
MeshArrays transformed(const MeshArrays& mesh, const Transformd& pose);

/// Validated mesh of the arrays; throws std::runtime_error with the report's error if refused.
std::shared_ptr<const TriMesh> build(const MeshArrays& mesh);

}  // namespace otg::scenes
