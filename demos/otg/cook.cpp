// SPDX-License-Identifier: BSD-3-Clause
// `otg cook MESH -o FILE`: a mesh with its tree as a file that the library loads at once.
#include <fmt/format.h>

#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <stdexcept>

#include "bvh/cooked_mesh.h"
#include "cli/cooked_file.h"
#include "cli/input_file.h"
#include "mesh_io/mesh_file.h"
#include "otg/commands.h"

namespace otg::cli {
namespace {

struct CookOptions {
  std::string mesh, file;
  bool repair = false, fresh = false, json = false;
  int repeat = 1;
};

double timeMs(const std::function<void()>& work) {
  const auto start = std::chrono::steady_clock::now();
  work();
  return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
}

/// The same in a process of its own, which has to get its memory from the system first.
double freshTimeMs(const std::function<void()>& work) {
  int ends[2];
  if (pipe(ends) != 0) throw std::runtime_error("no pipe");
  const pid_t child = fork();
  if (child == 0) {
    double ms = -1;
    try {
      ms = timeMs(work);
    } catch (...) {  // the parent sees that there is no time
    }
    const bool sent = write(ends[1], &ms, sizeof ms) == sizeof ms;
    _exit(sent ? 0 : 1);
  }
  double ms = -1;
  const bool heard = child > 0 && read(ends[0], &ms, sizeof ms) == sizeof ms;
  close(ends[0]);
  close(ends[1]);
  if (child > 0) waitpid(child, nullptr, 0);
  if (!heard || ms < 0) throw std::runtime_error("a process of its own failed");
  return ms;
}

int cook(const CookOptions& options) {
  const mesh_io::MeshFile input = mesh_io::loadMeshFile(findInput(options.mesh));
  std::shared_ptr<const CollisionMesh> mesh;
  const auto build = [&] {
    const MeshResult result =
        buildTriMesh(input.input(), options.repair ? RepairOptions::all() : RepairOptions{}, MeshOrder::kBySize);
    if (result.mesh == nullptr) throw InputError(options.mesh + ": " + result.report.error);
    mesh = std::make_shared<const CollisionMesh>(result.mesh, BuildStrategy::kSah);
  };
  UncookedMesh loaded;
  const auto load = [&] {
    loaded = loadCookedFile(options.file);
    if (loaded.mesh == nullptr) throw InputError(options.file + ": " + loaded.error);
  };
  std::vector<double> buildMs, loadMs;
  const auto writeFile = [&] {
    build();
    const std::vector<unsigned char> bytes = cookMesh(*mesh);
    std::ofstream out(options.file, std::ios::binary);
    out.write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
    out.close();
    if (!out) throw InputError(options.file + ": cannot be written");
  };
  if (options.fresh) {
    freshTimeMs(writeFile);
    // In turns, so that both meet the same machine.
    for (int i = 0; i < options.repeat; ++i) {
      buildMs.push_back(freshTimeMs(build));
      loadMs.push_back(freshTimeMs(load));
    }
    load();
  } else {
    writeFile();
    for (int i = 0; i < options.repeat; ++i) {
      mesh.reset();
      buildMs.push_back(timeMs(build));
    }
    for (int i = 0; i < options.repeat; ++i) {
      loaded = {};
      loadMs.push_back(timeMs(load));
    }
  }
  const Json row = {{"file", options.file},
                    {"bytes", std::filesystem::file_size(options.file)},
                    {"triangles", loaded.mesh->mesh().triangleCount()},
                    {"valid", loaded.mesh->mesh().report().valid()},
                    {"build_ms", median(buildMs)},
                    {"load_ms", median(loadMs)}};
  if (options.json) {
    printJson(row);
  } else {
    fmt::print("{}: {} triangles, {} bytes; built in {:.3f} ms, loaded in {:.3f} ms, {:.1f} times as fast\n",
               options.file, loaded.mesh->mesh().triangleCount(), std::filesystem::file_size(options.file),
               median(buildMs), median(loadMs), median(buildMs) / median(loadMs));
  }
  return kOk;
}

}  // namespace

void addCookCommand(CLI::App& app, Action& action) {
  CLI::App* command = app.add_subcommand(
      "cook", "Write a mesh with its tree as a file that dGpuTriMeshDataLoad() and all commands read");
  auto options = std::make_shared<CookOptions>();
  command->add_option("MESH", options->mesh, "Mesh file")->required();
  command->add_option("-o,--output", options->file, "The cooked file")->required();
  command->add_flag("--repair", options->repair, "As in check");
  command->add_option("--repeat", options->repeat, "Times to build and to load; medians are printed")
      ->check(CLI::Range(1, 1000));
  command->add_flag("--fresh", options->fresh, "Each time in a process of its own, which has no memory yet");
  command->add_flag("--json", options->json, "One JSON document on stdout");
  command->callback([options, &action] { action = [options] { return cook(*options); }; });
}

}  // namespace otg::cli
