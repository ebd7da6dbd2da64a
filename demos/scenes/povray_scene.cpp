// SPDX-License-Identifier: BSD-3-Clause
#include "scenes/povray_scene.h"

#include <fmt/format.h>
#include <fmt/os.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>
#include <stdexcept>

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
  return otgCross(otgSub(b, a), otgSub(c, a));
}

double length(const Vec3d& v) {
  return std::sqrt(otgDot(v, v));
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
        if (otgDot(faces[t], faces[other]) >= kSmoothCosine * length(faces[t]) * length(faces[other])) {
          sum = otgAdd(sum, faces[other]);
        }
      }
      const double size = length(sum);
      corners[3 * t + k] = size > 0 ? otgScale(sum, 1 / size) : Vec3d{0, 0, 1};
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

void writeMesh(fmt::ostream& out, std::size_t number, const TriMesh& mesh) {
  const auto vertices = mesh.vertices();
  const auto triangles = mesh.triangles();
  const std::vector<Vec3d> normals = cornerNormals(mesh);
  // Equal normals of one vertex are written once: three for each triangle would be six times as many.
  std::vector<Vec3d> distinct;
  std::vector<std::size_t> normalOf(normals.size());
  std::map<std::array<double, 4>, std::size_t> seen;
  for (std::size_t i = 0; i < normals.size(); ++i) {
    const Vec3d& n = normals[i];
    const std::array<double, 4> key{double(triangles[i / 3].v[i % 3]), n.x, n.y, n.z};
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

template <class T>
const T& at(const std::vector<T>& poses, std::size_t frame) {
  return poses[std::min(frame, poses.size() - 1)];
}

struct Stage {
  Vec3d center{0, 0, 0};
  double radius = 1;
};

/// Around the places of the moving bodies in the second half of the time, where things have come together, with their
/// size added: one that flew in from far away shall not make all of them small.
Stage findStage(const std::vector<AnimatedBody>& bodies) {
  Vec3d low{1e300, 1e300, 1e300}, high{-1e300, -1e300, -1e300};
  for (const AnimatedBody& body : bodies) {
    if (body.positions.size() < 2) continue;
    const double r = body.surface->radius();
    for (std::size_t i = body.positions.size() / 2; i < body.positions.size(); ++i) {
      const Vec3d& p = body.positions[i];
      low = {std::min(low.x, p.x - r), std::min(low.y, p.y - r), std::min(low.z, p.z - r)};
      high = {std::max(high.x, p.x + r), std::max(high.y, p.y + r), std::max(high.z, p.z + r)};
    }
  }
  if (low.x > high.x) return {};
  return {otgScale(otgAdd(low, high), 0.5), 0.5 * length(otgSub(high, low))};
}

/// Columns of the rotation matrix and the position, as POV-Ray's `matrix` takes them.
std::string matrix(const std::array<double, 4>& q, const Vec3d& p) {
  const auto [w, x, y, z] = q;
  return fmt::format("matrix <{:.9g},{:.9g},{:.9g}, {:.9g},{:.9g},{:.9g}, {:.9g},{:.9g},{:.9g}, {:.9g},{:.9g},{:.9g}>",
                     1 - 2 * (y * y + z * z), 2 * (x * y + w * z), 2 * (x * z - w * y),  //
                     2 * (x * y - w * z), 1 - 2 * (x * x + z * z), 2 * (y * z + w * x),  //
                     2 * (x * z + w * y), 2 * (y * z - w * x), 1 - 2 * (x * x + y * y), p.x, p.y, p.z);
}

fmt::ostream open(const std::filesystem::path& path) {
  try {
    return fmt::output_file(path.string());
  } catch (const std::system_error& error) {
    throw std::runtime_error(path.string() + ": cannot be written: " + error.code().message());
  }
}

}  // namespace

std::vector<std::string> writePovrayFrames(const std::string& folder, const std::vector<AnimatedBody>& bodies,
                                           const std::vector<double>& times, const std::vector<std::size_t>& frames) {
  const std::filesystem::path root(folder);
  std::error_code error;
  std::filesystem::create_directories(root, error);
  if (error) throw std::runtime_error(folder + ": cannot be made: " + error.message());

  std::map<const TriMesh*, std::size_t> surfaces;
  fmt::ostream meshes = open(root / "meshes.inc");
  for (const AnimatedBody& body : bodies) {
    const auto [place, isNew] = surfaces.try_emplace(body.surface.get(), surfaces.size());
    if (isNew) writeMesh(meshes, place->second, *body.surface);
  }
  meshes.close();

  const Stage stage = findStage(bodies);
  std::vector<std::string> paths;
  for (std::size_t i = 0; i < frames.size(); ++i) {
    const std::filesystem::path path = root / fmt::format("frame_{:03}.pov", i);
    fmt::ostream out = open(path);
    out.print("#version 3.7;\n#declare FrameTime = {:.9g};\n", times[frames[i]]);
    out.print("#declare StageCenter = <{:.9g},{:.9g},{:.9g}>;\n#declare StageRadius = {:.9g};\n", stage.center.x,
              stage.center.y, stage.center.z, stage.radius);
    out.print("#include \"look.inc\"\n#include \"meshes.inc\"\n");
    for (const AnimatedBody& body : bodies) {
      out.print("object {{ Surface_{} {}(<{:.4g},{:.4g},{:.4g}>) {} }}\n", surfaces[body.surface.get()],
                body.positions.size() < 2 ? "StillBody" : "MovingBody", body.color.x, body.color.y, body.color.z,
                matrix(at(body.rotations, frames[i]), at(body.positions, frames[i])));
    }
    out.close();
    paths.push_back(path.string());
  }
  return paths;
}

}  // namespace otg::scenes
