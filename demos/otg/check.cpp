// SPDX-License-Identifier: BSD-3-Clause
// `otg check MESH...`: loads and validates meshes.
#include <fmt/format.h>

#include "cli/cooked_file.h"
#include "cli/input_file.h"
#include "mesh_io/mesh_file.h"
#include "otg/commands.h"

namespace otg::cli {
namespace {

struct CheckOptions {
  std::vector<std::string> files;
  bool repair = false;
  bool json = false;
};

Json toJson(const Eigen::Vector3d& v) {
  return Json::array({v.x(), v.y(), v.z()});
}

Json describe(const std::string& file, const mesh_io::MeshFile& input, const MeshResult& result) {
  const ValidationReport& report = result.report;
  Json row;
  row["file"] = file;
  // A refused mesh is described by what the file holds.
  row["vertices"] = report.accepted ? report.vertices : input.vertices.size();
  row["triangles"] = report.accepted ? report.triangles : input.triangles.size();
  row["edges"] = report.edges;
  row["closed"] = report.closed;
  row["manifold"] = report.manifold;
  row["oriented"] = report.oriented;
  row["degenerate_triangles"] = report.degenerateTriangles;
  row["duplicate_triangles"] = report.duplicateTriangles;
  row["nonfinite_vertices"] = report.nonfiniteVertices;
  row["volume"] = nullptr;
  row["center_of_mass"] = nullptr;
  row["inertia"] = nullptr;
  if (result.mesh) {
    // At density 1; signed sums for a shell. A shell's centre and inertia mean nothing and may not be finite: then
    // null.
    const MassProperties& mass = result.mesh->massProperties();
    row["volume"] = mass.volume;
    if (mass.centerOfMass.allFinite()) row["center_of_mass"] = toJson(mass.centerOfMass);
    if (mass.inertia.allFinite()) {
      row["inertia"] = Json::array();
      for (int i = 0; i < 3; ++i) row["inertia"].push_back(toJson(mass.inertia.row(i)));
    }
  }
  row["valid"] = report.valid();
  row["problems"] = Json::array();
  for (const Problem& problem : report.problems) {
    row["problems"].push_back({{"kind", problemName(problem.kind)},
                               {"count", problem.count},
                               {"elements", problem.elements},
                               {"message", problem.message}});
  }
  row["accepted"] = report.accepted;
  row["error"] = report.error;
  row["class"] = !result.mesh ? "refused" : report.solid ? "solid" : "shell";
  row["outward"] = report.outward;
  row["components"] = report.components;
  row["boundary_edges"] = report.boundaryEdges;
  row["nonmanifold_edges"] = report.nonManifoldEdges;
  row["nonmanifold_vertices"] = report.nonManifoldVertices;
  row["inconsistent_edges"] = report.inconsistentEdges;
  row["bounds"] = nullptr;
  row["area"] = nullptr;
  if (result.mesh && result.mesh->triangleCount() > 0) {
    const Vec3f lo = result.mesh->boundsMin(), hi = result.mesh->boundsMax();
    row["bounds"] = {{lo.x, lo.y, lo.z}, {hi.x, hi.y, hi.z}};
    row["area"] = result.mesh->massProperties().area;
  }
  const RepairReport& repair = report.repair;
  row["repair"] = {{"welded_vertices", repair.weldedVertices},
                   {"dropped_degenerate", repair.droppedDegenerate},
                   {"dropped_duplicates", repair.droppedDuplicates},
                   {"flipped_triangles", repair.flippedTriangles},
                   {"messages", repair.messages}};
  return row;
}

void printReadable(const Json& row) {
  const auto yes = [&](const char* key) { return row[key].get<bool>() ? "yes" : "no"; };
  fmt::print("{}\n", row["file"].get<std::string>());
  fmt::print("  {} vertices, {} triangles, {} edges, {} component(s): {}{}\n", row["vertices"].get<std::size_t>(),
             row["triangles"].get<std::size_t>(), row["edges"].get<std::size_t>(), row["components"].get<std::size_t>(),
             row["class"].get<std::string>(), row["valid"].get<bool>() ? ", valid" : "");
  fmt::print("  closed {}, manifold {}, oriented {}, outward {}\n", yes("closed"), yes("manifold"), yes("oriented"),
             yes("outward"));
  if (row["accepted"].get<bool>()) {
    fmt::print("  volume {:.9g}{}", row["volume"].get<double>(),
               row["class"] == "solid" ? "" : " (signed sum: the mesh bounds no solid)");
    if (!row["center_of_mass"].is_null()) {
      const auto c = row["center_of_mass"].get<std::vector<double>>();
      fmt::print(", centre of mass ({:.9g}, {:.9g}, {:.9g})", c[0], c[1], c[2]);
    }
    fmt::print("\n");
  }
  for (const Json& message : row["repair"]["messages"]) fmt::print("  repaired: {}\n", message.get<std::string>());
  for (const Json& problem : row["problems"]) {
    fmt::print("  {}: {}\n", problem["kind"].get<std::string>(), problem["message"].get<std::string>());
  }
}

int check(const CheckOptions& options) {
  Json files = Json::array();
  int status = kOk;
  for (const std::string& file : options.files) {
    // Every file gets its result, also those after one that cannot be read.
    try {
      mesh_io::MeshFile input;
      MeshResult result;
      if (isCookedFile(file)) {  // it was built already: its report is in it
        const UncookedMesh cooked = loadCookedFile(file);
        if (cooked.mesh != nullptr) {
          result = {cooked.mesh->meshPtr(), cooked.mesh->mesh().report()};
        } else {
          result.report.error = cooked.error;
        }
      } else {
        input = mesh_io::loadMeshFile(findInput(file));
        result = buildTriMesh(input.input(), options.repair ? RepairOptions::all() : RepairOptions{});
      }
      if (!result.mesh) {
        fmt::print(stderr, "otg: {}: {}\n", file, result.report.error);
        status = kBadInput;
      }
      files.push_back(describe(file, input, result));
    } catch (const mesh_io::LoadError& error) {
      fmt::print(stderr, "otg: {}\n", error.what());
      status = kBadInput;
      files.push_back({{"file", file}, {"valid", false}, {"error", error.what()}});
      continue;
    }
    if (!options.json) printReadable(files.back());
  }
  if (options.json) {
    // With one file its keys also stand at the top level.
    Json document = files.size() == 1 ? files.front() : Json::object();
    document["files"] = files;
    printJson(document);
  }
  return status;
}

}  // namespace

void addCheckCommand(CLI::App& app, Action& action) {
  CLI::App* command =
      app.add_subcommand("check", "Load meshes (PLY, OBJ, STL, OFF, glTF, cooked) and say what is wrong with them");
  auto options = std::make_shared<CheckOptions>();
  command->add_option("MESH", options->files, "Mesh files")->required();
  command->add_flag("--repair", options->repair,
                    "Weld equal positions, drop degenerate and duplicate triangles, make the winding consistent and "
                    "outward, then judge");
  command->add_flag("--json", options->json, "One JSON document on stdout");
  command->callback([options, &action] { action = [options] { return check(*options); }; });
}

}  // namespace otg::cli
