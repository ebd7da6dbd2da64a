// SPDX-License-Identifier: BSD-3-Clause
// `otg bench ...`: which benchmarks there are.
#include "otg_bench/bench.h"

#include <fmt/format.h>

namespace otg::cli {
namespace {

using Benchmark = int (*)(const BenchOptions&);

void add(CLI::App& bench, const char* name, const char* help, Benchmark run, bool withScene, Action& action) {
  CLI::App* command = bench.add_subcommand(name, help);
  auto options = std::make_shared<BenchOptions>();
  options->addTo(*command, withScene);
  command->callback([options, run, &action] { action = [options, run] { return run(*options); }; });
}

}  // namespace

void printBench(const Json& document, bool json) {
  if (json) {
    printJson(document);
    return;
  }
  for (const auto& table : document["tables"].items()) printTable(table.key(), table.value());
  if (document.contains("says")) {
    fmt::print("\n");
    for (const auto& sentence : document["says"]) fmt::print("{}\n", sentence.get<std::string>());
  }
}

void addBenchmarks(CLI::App& bench, Action& action) {
  add(bench, "thesis", "The published tables: each step of the query; traversals, descent rules, build strategies",
      &benchThesis, true, action);
  add(bench, "batch", "Single pairs and batches of pairs, an OpenCL device beside the CPU", &benchBatch, false, action);
  add(bench, "build", "Time to validate meshes and to build, derive and refit their trees", &benchBuild, false, action);
  add(bench, "peers", "The whole query beside stock ODE and other libraries", &benchPeers, true, action);
  addBenchThreads(bench, action);
  addBenchContacts(bench, action);
  addBenchPrimitives(bench, action);
  addBenchTessellations(bench, action);
  addBenchTerrain(bench, action);
  addBenchFloor(bench, action);
  addBenchSmall(bench, action);
  addBenchShapes(bench, action);
  addBenchWorld(bench, action);
  addBenchHeightfield(bench, action);
  addBenchQueries(bench, action);
  addBenchContours(bench, action);
  addBenchExact(bench, action);
  addBenchPhysics(bench, action);
}

}  // namespace otg::cli
