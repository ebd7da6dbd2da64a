// SPDX-License-Identifier: BSD-3-Clause
#include "scenes/mesh_arrays.h"

#include <stdexcept>

namespace otg::scenes {

MeshInput MeshArrays::input() const {
  MeshInput input;
  input.vertices = vertices.data();
  input.vertexCount = vertices.size();
  input.indices = triangles.data();
  input.triangleCount = triangles.size();
  return input;
}

MeshArrays merge(const std::vector<MeshArrays>& parts) {
  MeshArrays all;
  for (const MeshArrays& part : parts) {
    const std::uint32_t base = static_cast<std::uint32_t>(all.vertices.size());
    all.vertices.insert(all.vertices.end(), part.vertices.begin(), part.vertices.end());
    for (const Triangle& t : part.triangles) all.triangles.push_back({{t.v[0] + base, t.v[1] + base, t.v[2] + base}});
  }
  return all;
}

MeshArrays broughtToOrigin(const TriMesh& mesh, float radius) {
  MeshArrays arrays;
  arrays.triangles.assign(mesh.triangles().begin(), mesh.triangles().end());
  const Vec3f center = mesh.center();
  const float scale = radius / mesh.radius();
  for (const Vec3f& v : mesh.vertices()) {
    arrays.vertices.push_back({scale * (v.x - center.x), scale * (v.y - center.y), scale * (v.z - center.z)});
  }
  return arrays;
}

MeshArrays transformed(const MeshArrays& mesh, const Transformd& pose) {
  MeshArrays moved = mesh;
  for (Vec3f& p : moved.vertices) p = toFloat(otgTransform(pose, Vec3d{p.x, p.y, p.z}));
  return moved;
}

std::shared_ptr<const TriMesh> build(const MeshArrays& mesh) {
  const MeshResult result = buildTriMesh(mesh.input());
  if (!result.mesh) throw std::runtime_error(result.report.error);
  return result.mesh;
}

}  // namespace otg::scenes
