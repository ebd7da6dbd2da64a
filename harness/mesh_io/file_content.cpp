// SPDX-License-Identifier: BSD-3-Clause
#include "mesh_io/file_content.h"

#include <array>
#include <bit>
#include <unordered_map>

#include "base/hash.h"

namespace otg::mesh_io {
namespace {

struct PositionHash {
  std::size_t operator()(const std::array<std::uint64_t, 3>& key) const {
    std::uint64_t h = 0;
    for (const std::uint64_t part : key) {
      h = otg::spreadBits(h ^ part);
    }
    return h;
  }
};

}  // namespace

MeshInput MeshFile::input() const {
  MeshInput result;
  result.vertices = vertices.data();
  result.scalar = MeshInput::Scalar::kDouble;
  result.vertexCount = vertices.size();
  result.indices = triangles.data();
  result.triangleCount = triangles.size();
  return result;
}

void joinEqualVertices(MeshFile& mesh) {
  std::unordered_map<std::array<std::uint64_t, 3>, std::uint32_t, PositionHash> seen;
  seen.reserve(mesh.vertices.size());
  std::vector<std::uint32_t> newIndex(mesh.vertices.size());
  std::vector<Vec3d> kept;
  for (std::size_t i = 0; i < mesh.vertices.size(); ++i) {
    const Vec3d& p = mesh.vertices[i];
    const auto bits = [](double x) { return std::bit_cast<std::uint64_t>(x == 0 ? 0.0 : x); };
    const auto [entry, isNew] = seen.try_emplace({bits(p.x), bits(p.y), bits(p.z)}, std::uint32_t(kept.size()));
    if (isNew) kept.push_back(p);
    newIndex[i] = entry->second;
  }
  mesh.vertices = std::move(kept);
  for (Triangle& triangle : mesh.triangles) {
    for (std::uint32_t& v : triangle.v) v = v < newIndex.size() ? newIndex[v] : kNone;
  }
}

}  // namespace otg::mesh_io
