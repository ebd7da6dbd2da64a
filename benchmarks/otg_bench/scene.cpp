// SPDX-License-Identifier: BSD-3-Clause
#include "otg_bench/scene.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>

#include "base/environment.h"
#include "cli/input_file.h"
#include "cli/pose.h"
#include "collide/query.h"
#include "mesh_io/mesh_file.h"
#include "scenes/generated_meshes.h"

namespace otg::cli {
namespace {

namespace fs = std::filesystem;

std::vector<std::string> filesOfMeshFolder() {
  const std::string folder = readEnvironment().meshFolder;
  std::vector<std::string> files;
  if (folder.empty()) return files;
  std::error_code error;
  for (const auto& entry : fs::directory_iterator(folder, error)) {
    const std::string extension = entry.path().extension().string();
    const bool isMesh = extension == ".ply" || extension == ".off" || extension == ".obj" || extension == ".stl";
    if (isMesh && entry.path().filename().string().starts_with("armadillo")) files.push_back(entry.path().string());
  }
  if (error) throw InputError(fmt::format("OTG_MESH_DIR: the folder {} cannot be read", folder));
  if (files.empty())
    progress(fmt::format("note: OTG_MESH_DIR ({}) holds no armadillo*; using generated meshes", folder));
  return files;
}

bool intersects(const CollisionMesh& mesh, const Transformd& pose, Workspace& workspace) {
  Query query;
  query.a = query.b = &mesh;
  query.bInA = pose;
  findIntersectingPairs(query, workspace);
  return !workspace.intersecting.empty();
}

/// Rotation by `angle` about a unit axis.
Transformd rotation(Vec3d axis, double angle) {
  const double c = std::cos(angle), s = std::sin(angle), k = 1 - c;
  const double x = axis.x, y = axis.y, z = axis.z;
  return {{c + x * x * k, x * y * k - z * s, x * z * k + y * s, y * x * k + z * s, c + y * y * k, y * z * k - x * s,
           z * x * k - y * s, z * y * k + x * s, c + z * z * k},
          {0, 0, 0}};
}

/// The pose that turns the mesh about its centre and moves that centre by `move`.
Transformd aboutCenter(const TriMesh& mesh, Transformd turn, Vec3d move) {
  const Vec3f c = mesh.center();
  const Vec3d center{c.x, c.y, c.z};
  turn.t = otgAdd(otgSub(center, otgRotate(turn, center)), move);
  return turn;
}

Transformd computedPose(const std::string& scene, const CollisionMesh& collisionMesh) {
  const TriMesh& mesh = collisionMesh.mesh();
  const double width = double(mesh.boundsMax().x) - mesh.boundsMin().x;
  const Vec3d axis{0.3, 0.6, 0.741619848709566};  // unit; no axis of symmetry of anything
  if (scene == "deep10") return aboutCenter(mesh, rotation(axis, 0.1745329251994), {0.02 * width, 0, 0});
  const double fraction = scene == "touch" ? -0.05 : scene == "deep" ? -0.35 : 0.002;
  const Transformd turn = rotation(axis, 0.6);
  Workspace workspace;
  double inside = 0, outside = 2.0 * mesh.radius();
  // Touching means within a thousandth of the width; the scene's own fractions are larger.
  while (outside - inside > 1e-4 * width) {
    const double middle = 0.5 * (inside + outside);
    (intersects(collisionMesh, aboutCenter(mesh, turn, {middle, 0, 0}), workspace) ? inside : outside) = middle;
  }
  return aboutCenter(mesh, turn, {outside + fraction * width, 0, 0});
}

}  // namespace

void BenchOptions::addTo(CLI::App& command, bool withScene) {
  command.add_option("MESH", files,
                     "Mesh files (default: armadillo* in the folder OTG_MESH_DIR, else generated lumps)");
  command
      .add_option("--lumps", lumps,
                  "Generated lumps of 20 * 4^N triangles in place of files: N,N,... (default without files: 7 to 3)")
      ->delimiter(',')
      ->check(CLI::Range(0, 8));
  if (withScene) {
    command.add_option("--scene", scene, "How the mesh and its copy lie")
        ->check(CLI::IsMember({"touch", "deep", "deep10", "nearmiss"}));
    command.add_option("--poses", poses, "JSON file with a pose matrix for each scene (default: computed)");
  }
  command.add_option("--repeat", repeat, "Times are medians over this many runs (default: what fits in half a second)")
      ->check(CLI::Range(1, 100000));
  if (command.get_name() == "thesis") {
    command.add_option("--figures", figures, "Folder for the figures 6.2 and 6.3 (SVG)");
    command
        .add_option("--scenes", scenes,
                    "Scenes of the traversal `levels` on an OpenCL device (default: all; with --poses that of --scene)")
        ->delimiter(',')
        ->check(CLI::IsMember({"touch", "deep", "deep10", "nearmiss"}));
  }
  if (command.get_name() == "batch") {
    scenes = {"touch", "deep", "deep10", "nearmiss"};
    command.add_option("--pairs", pairs, "Pairs in the batch")->check(CLI::Range(1, 1000000));
    command
        .add_option(
            "--bodies", batches,
            "Batches: bodies, boxes in stacks, bodies on a terrain, large overlaps, dense pairs of up to 20,000 "
            "triangles, nuts on bolts (default: bodies, and for the model 'solid' stacks)")
        ->delimiter(',')
        ->check(CLI::IsMember({"bodies", "stacks", "terrain", "overlaps", "dense", "nut_bolt"}));
    command.add_option("--poses", poses, "JSON file with a pose matrix for each scene (default: computed)");
    command.add_option("--scenes", scenes, "How the mesh and its copy lie; 'none' for the batch alone")
        ->delimiter(',')
        ->check(CLI::IsMember({"touch", "deep", "deep10", "nearmiss", "none"}));
    command.add_option("--contacts", contacts, "Contact model")->check(CLI::IsMember({"pairwise", "solid"}));
    command.add_option("--body-files", bodyFiles,
                       "Mesh files of 200 to 6,000 triangles, scaled to radius 1, beside the generated bodies");
    command.add_flag("!--no-cpu", cpu, "Leave out the CPU (answers are compared all the same)");
    command.add_option("--tune", tune, "KEY=VALUE of the OpenCL launches; KEY=V1,V2,... repeats all for each value");
  }
  command.add_flag("--json", json, "One JSON document on stdout");
}

std::vector<BenchMesh> benchMeshes(const BenchOptions& options) {
  std::vector<std::string> files = options.files;
  if (files.empty() && options.lumps.empty()) files = filesOfMeshFolder();
  std::vector<BenchMesh> meshes;
  for (const std::string& file : files) {
    progress("reading " + file);
    meshes.push_back({fs::path(file).stem().string(), mesh_io::loadTriMesh(findInput(file))});
    if (meshes.back().mesh->triangleCount() == 0) throw InputError(file + ": the mesh has no triangles");
  }
  if (files.empty()) {
    const std::vector<int> all{7, 6, 5, 4, 3};
    for (const int level : options.lumps.empty() ? all : options.lumps) {
      meshes.push_back({fmt::format("lump_{}", level), scenes::build(scenes::makeLump(0.5, level, 0.35, 7))});
    }
  }
  std::stable_sort(meshes.begin(), meshes.end(), [](const BenchMesh& a, const BenchMesh& b) {
    return a.mesh->triangleCount() > b.mesh->triangleCount();
  });
  return meshes;
}

std::vector<BenchMesh> bodyMeshes(const BenchOptions& options) {
  constexpr std::size_t kLeast = 200, kMost = 6000;
  std::vector<BenchMesh> bodies;
  for (const std::string& file : options.bodyFiles) {
    const std::shared_ptr<const TriMesh> mesh = mesh_io::loadTriMesh(findInput(file));
    if (mesh->triangleCount() < kLeast || mesh->triangleCount() > kMost) {
      progress(fmt::format("note: {} has {} triangles and is left out; bodies have {} to {}", file,
                           mesh->triangleCount(), kLeast, kMost));
      continue;
    }
    bodies.push_back({fs::path(file).stem().string(), scenes::build(scenes::broughtToOrigin(*mesh, 1))});
  }
  if (bodies.empty() && !options.bodyFiles.empty()) {
    throw InputError(fmt::format("--body-files: none of the files has {} to {} triangles", kLeast, kMost));
  }
  return bodies;
}

std::shared_ptr<const TriMesh> sortedForLocality(const TriMesh& mesh) {
  MeshInput input;
  input.vertices = mesh.vertices().data();
  input.vertexCount = mesh.vertices().size();
  input.indices = mesh.triangles().data();
  input.triangleCount = mesh.triangleCount();
  return buildTriMesh(input, {}, MeshOrder::kBySize).mesh;
}

Transformd benchPose(const BenchOptions& options, const CollisionMesh& mesh) {
  if (!options.poses.empty()) return parsePose(options.poses + "#" + options.scene);
  return computedPose(options.scene, mesh);
}

}  // namespace otg::cli
