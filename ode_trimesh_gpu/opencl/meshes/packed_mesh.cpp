// SPDX-License-Identifier: BSD-3-Clause
#include "opencl/meshes/packed_mesh.h"

namespace otg::opencl {

MeshUnit nodeCenter(const Vec3f& center, std::uint32_t first) {
  return {center.x, center.y, center.z, first};
}

MeshUnit nodeExtent(const Vec3f& extent, std::int32_t count) {
  return {extent.x, extent.y, extent.z, static_cast<std::uint32_t>(count)};
}

MeshUnit triangleCorner(const TriMesh& mesh, std::uint32_t triangle, std::uint32_t corner) {
  const std::uint32_t w[3] = {triangle, mesh.isDegenerate(triangle) ? 1u : 0u, 0u};
  const Vec3f& v = mesh.vertices()[mesh.triangles()[triangle].v[corner]];
  return {v.x, v.y, v.z, w[corner]};
}

otg_device_mesh PackedMesh::placeAt(std::uint32_t begin) const {
  otg_device_mesh moved = place;
  moved.nodes += begin;
  moved.soup += begin;
  moved.cut += begin;
  moved.rings += begin;
  return moved;
}

}  // namespace otg::opencl
