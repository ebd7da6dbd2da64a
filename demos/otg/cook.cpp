// SPDX-License-Identifier: BSD-3-Clause
// `otg cook MESH -o FILE`: a mesh with its tree as a file that the library loads at once.
#include <fmt/format.h>

#include <chrono>
#include <cstdio>
#include <fstream>

#include "bvh/cooked_mesh.h"
#include "mesh_io/mesh_file.h"
#include "otg/command.h"
#include "otg/cooked_file.h"

namespace otg::cli {
namespace {

struct CookOptions {
  std::string mesh, file;
  bool repair = false, json = false;
  int repeat = 1;
};

double timeMs(const std::function<void()>& work) {
  const auto start = std::chrono::steady_clock::now();
  work();
  return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
}

int cook(const CookOptions& options) {
  const mesh_io::MeshFile input = mesh_io::loadMeshFile(options.mesh);
  std::shared_ptr<const CollisionMesh> mesh;
  std::vector<double> build, load;
  for (int i = 0; i < options.repeat; ++i) {
    mesh.reset();
    build.push_back(timeMs([&] {
      const MeshResult result =
          buildTriMesh(input.input(), options.repair ? RepairOptions::all() : RepairOptions{}, MeshOrder::kSpatial);
      if (result.mesh == nullptr) throw InputError(options.mesh + ": " + result.report.error);
      mesh = std::make_shared<const CollisionMesh>(result.mesh, BuildStrategy::kSah);
    }));
  }
  const std::vector<unsigned char> bytes = cookMesh(*mesh);
  std::ofstream out(options.file, std::ios::binary);
  out.write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
  out.close();
  if (!out) throw InputError(options.file + ": cannot be written");
  UncookedMesh read;
  for (int i = 0; i < options.repeat; ++i) {
    read = {};
    load.push_back(timeMs([&] { read = loadCookedFile(options.file); }));
    if (read.mesh == nullptr) throw InputError(options.file + ": " + read.error);
  }
  const Json row = {{"file", options.file},
                    {"bytes", bytes.size()},
                    {"triangles", mesh->mesh().triangleCount()},
                    {"valid", mesh->mesh().report().valid()},
                    {"build_ms", median(build)},
                    {"load_ms", median(load)}};
  if (options.json) {
    printJson(row);
  } else {
    fmt::print("{}: {} triangles, {} bytes; built in {:.2f} ms, loaded in {:.2f} ms\n", options.file,
               mesh->mesh().triangleCount(), bytes.size(), median(build), median(load));
  }
  return kOk;
}

}  // namespace

void addCookCommand(CLI::App& app, Action& action) {
  CLI::App* command =
      app.add_subcommand("cook", "Write a mesh with its tree as a file that dGpuTriMeshDataLoad() and check read");
  auto options = std::make_shared<CookOptions>();
  command->add_option("MESH", options->mesh, "Mesh file")->required();
  command->add_option("-o,--output", options->file, "The cooked file")->required();
  command->add_flag("--repair", options->repair, "As in check");
  command->add_option("--repeat", options->repeat, "Times to build and to load; medians are told")
      ->check(CLI::Range(1, 1000));
  command->add_flag("--json", options->json, "One JSON document on stdout");
  command->callback([options, &action] { action = [options] { return cook(*options); }; });
}

}  // namespace otg::cli
