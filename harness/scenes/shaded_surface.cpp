// SPDX-License-Identifier: BSD-3-Clause
#include "scenes/shaded_surface.h"

#include <map>
#include <tuple>

#include "base/vectors.h"

namespace otg::scenes {
namespace {

/// Faces that meet under a smaller angle than this shade as one smooth surface.
constexpr double kCosCrease = 0.7660444431;  // 40 degrees

Vec3d faceNormal(const TriMesh& mesh, const Triangle& t) {
  const auto corner = [&](int k) {
    const Vec3f v = mesh.vertices()[t.v[k]];
    return Vec3d{v.x, v.y, v.z};
  };
  return otgCross(corner(1) - corner(0), corner(2) - corner(0));  // length is twice the area
}

Vec3d unitOrUp(const Vec3d& v) {
  const double length = norm(v);
  return length > 0 ? v * (1 / length) : Vec3d{0, 0, 1};
}

}  // namespace

ShadedSurface shade(const TriMesh& mesh) {
  const auto triangles = mesh.triangles();
  const auto& weld = mesh.topology().weld;
  std::vector<Vec3d> faces;
  std::vector<std::uint32_t> start(mesh.vertices().size() + 1, 0), around;
  for (const Triangle& t : triangles) {
    faces.push_back(faceNormal(mesh, t));
    for (const std::uint32_t v : t.v) ++start[weld[v] + 1];
  }
  for (std::size_t i = 1; i < start.size(); ++i) start[i] += start[i - 1];
  around.resize(start.back());
  std::vector<std::uint32_t> fill(start.begin(), start.end() - 1);
  for (std::uint32_t t = 0; t < triangles.size(); ++t) {
    for (const std::uint32_t v : triangles[t].v) around[fill[weld[v]]++] = t;
  }
  ShadedSurface result;
  std::map<std::tuple<std::uint32_t, float, float, float>, std::uint32_t> seen;
  for (std::uint32_t t = 0; t < triangles.size(); ++t) {
    const Vec3d own = unitOrUp(faces[t]);
    for (const std::uint32_t vertex : triangles[t].v) {
      const std::uint32_t v = weld[vertex];
      Vec3d sum{0, 0, 0};
      for (std::uint32_t i = start[v]; i < start[v + 1]; ++i) {
        if (otgDot(unitOrUp(faces[around[i]]), own) >= kCosCrease) sum = sum + faces[around[i]];
      }
      const Vec3d n = unitOrUp(sum);
      const float x = float(n.x), y = float(n.y), z = float(n.z);
      const auto [entry, isNew] =
          seen.try_emplace({v, x, y, z}, static_cast<std::uint32_t>(result.positions.size() / 3));
      if (isNew) {
        const Vec3f p = mesh.vertices()[v];
        result.positions.insert(result.positions.end(), {p.x, p.y, p.z});
        result.normals.insert(result.normals.end(), {x, y, z});
      }
      result.indices.push_back(entry->second);
    }
  }
  return result;
}

}  // namespace otg::scenes
