// SPDX-License-Identifier: BSD-3-Clause
#include "scenes/povray_surface.h"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <map>
#include <stdexcept>
#include <vector>

#include "base/vectors.h"

namespace otg::scenes {
namespace {

// Faces that meet at less than this angle are drawn as one smooth surface.
const double kSmoothCosine = std::cos(40.0 / 180.0 * 3.14159265358979323846);

Vec3d toDouble(const Vec3f& v) {
  return {v.x, v.y, v.z};
}

/// Twice the area long, along the outward normal.
Vec3d faceNormal(const TriMesh& mesh, std::size_t triangle) {
  const Triangle& t = mesh.triangles()[triangle];
  const Vec3d a = toDouble(mesh.vertices()[t.v[0]]), b = toDouble(mesh.vertices()[t.v[1]]);
  const Vec3d c = toDouble(mesh.vertices()[t.v[2]]);
  return otgCross(b - a, c - a);
}

/// For each corner of each triangle the sum of the normals of the faces around its vertex that are nearly parallel to
/// it.
std::vector<Vec3d> cornerNormals(const TriMesh& mesh) {
  const std::size_t count = mesh.triangleCount();
  std::vector<Vec3d> faces(count);
  std::vector<std::vector<std::uint32_t>> around(mesh.vertices().size());
  for (std::size_t t = 0; t < count; ++t) {
    faces[t] = faceNormal(mesh, t);
    for (const std::uint32_t v : mesh.triangles()[t].v) around[v].push_back(static_cast<std::uint32_t>(t));
  }
  std::vector<Vec3d> corners(3 * count);
  for (std::size_t t = 0; t < count; ++t) {
    for (std::size_t k = 0; k < 3; ++k) {
      Vec3d sum{0, 0, 0};
      for (const std::uint32_t other : around[mesh.triangles()[t].v[k]]) {
        if (otgDot(faces[t], faces[other]) >= kSmoothCosine * norm(faces[t]) * norm(faces[other])) {
          sum = sum + faces[other];
        }
      }
      const double size = norm(sum);
      corners[3 * t + k] = size > 0 ? sum * (1 / size) : Vec3d{0, 0, 1};
    }
  }
  return corners;
}

void writeVectors(fmt::ostream& out, const char* name, std::size_t count, const auto& get) {
  out.print("  {} {{ {}", name, count);
  for (std::size_t i = 0; i < count; ++i) {
    const Vec3d v = get(i);
    out.print(",\n<{:.7g},{:.7g},{:.7g}>", v.x, v.y, v.z);
  }
  out.print(" }}\n");
}

}  // namespace

void writePovraySurface(fmt::ostream& out, std::size_t number, const TriMesh& mesh) {
  const auto vertices = mesh.vertices();
  const auto triangles = mesh.triangles();
  const std::vector<Vec3d> normals = cornerNormals(mesh);
  // Equal normals of one vertex are written once: three for each triangle would be six times as many.
  std::vector<Vec3d> distinct;
  std::vector<std::size_t> normalOf(normals.size());
  std::map<std::array<double, 4>, std::size_t> seen;
  for (std::size_t i = 0; i < normals.size(); ++i) {
    const Vec3d& n = normals[i];
    const std::uint32_t vertex = triangles[i / 3].v[i % 3];
    const std::array<double, 4> key{double(vertex), n.x, n.y, n.z};
    const auto [place, isNew] = seen.try_emplace(key, distinct.size());
    if (isNew) distinct.push_back(n);
    normalOf[i] = place->second;
  }
  out.print("#declare Surface_{} = mesh2 {{\n", number);
  writeVectors(out, "vertex_vectors", vertices.size(), [&](std::size_t i) { return toDouble(vertices[i]); });
  writeVectors(out, "normal_vectors", distinct.size(), [&](std::size_t i) { return distinct[i]; });
  out.print("  face_indices {{ {}", triangles.size());
  for (const Triangle& t : triangles) out.print(",\n<{},{},{}>", t.v[0], t.v[1], t.v[2]);
  out.print(" }}\n  normal_indices {{ {}", triangles.size());
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    out.print(",\n<{},{},{}>", normalOf[3 * t], normalOf[3 * t + 1], normalOf[3 * t + 2]);
  }
  out.print(" }}\n}}\n");
}

fmt::ostream openPovrayFile(const std::filesystem::path& path) {
  try {
    return fmt::output_file(path.string());
  } catch (const std::system_error& error) {
    throw std::runtime_error(path.string() + ": cannot be written: " + error.code().message());
  }
}

}  // namespace otg::scenes
