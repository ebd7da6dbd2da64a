// SPDX-License-Identifier: BSD-3-Clause
// `otg bench build`: how long a mesh takes until it can collide.
#include <fmt/format.h>

#include "otg/bench.h"
#include "otg/query_options.h"

namespace otg::cli {
namespace {

double validateMs(const TriMesh& mesh, int repeat) {
  MeshInput input;
  input.vertices = mesh.vertices().data();
  input.vertexCount = mesh.vertices().size();
  input.indices = mesh.triangles().data();
  input.triangleCount = mesh.triangleCount();
  return median(repeatTimes(repeat, [&] { return timeOnce([&] { buildTriMesh(input, {}, MeshOrder::kSpatial); }); }));
}

std::string hashOfTree(const BinaryTree& tree) {
  Fnv1a hash;
  hash.add(tree.nodes.data(), tree.nodes.size() * sizeof(BvhNode));
  return hash.hex();
}

}  // namespace

int benchBuild(const BenchOptions& options) {
  Json rows = Json::array();
  for (const BenchMesh& entry : benchMeshes(options)) {
    progress(fmt::format("{}: {} triangles", entry.name, entry.mesh->triangleCount()));
    const double validate = validateMs(*entry.mesh, options.repeat);
    for (const BuildStrategy strategy : {BuildStrategy::kMeanSplit, BuildStrategy::kSah}) {
      BinaryTree tree;
      const auto times = [&](const std::function<void()>& body) {
        return median(repeatTimes(options.repeat, [&] { return timeOnce(body); }));
      };
      Json row;
      row["mesh"] = entry.name;
      row["triangles"] = entry.mesh->triangleCount();
      row["build"] = nameOf(strategy);
      row["validate_ms"] = validate;
      row["tree_ms"] = times([&] { tree = buildTree(*entry.mesh, strategy); });
      row["quantize_ms"] = times([&] { quantizeTree(tree); });
      row["noleaf_ms"] = times([&] { makeNoLeafTree(tree); });
      row["refit_ms"] = times([&] { refitTree(tree, *entry.mesh); });
      row["nodes"] = tree.nodes.size();
      row["depth"] = tree.depth;
      row["sah_cost"] = sahCost(tree);
      row["hash"] = hashOfTree(tree);
      rows.push_back(row);
    }
  }
  printBench({{"bench", "build"}, {"tables", {{"build", rows}}}}, options.json);
  return kOk;
}

}  // namespace otg::cli
