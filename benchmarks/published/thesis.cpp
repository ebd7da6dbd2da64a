// SPDX-License-Identifier: BSD-3-Clause
// `otg bench thesis`: the tables of the published work, and what they are for the defaults of today.
#include <fmt/format.h>

#include <algorithm>

#include "cli/progress.h"
#include "cli/query_options.h"
#include "cli/query_profile.h"
#include "collide/query.h"
#include "otg_bench/bench.h"
#include "published/levels.h"
#include "published/tables.h"

namespace otg::cli {
namespace {

constexpr BuildStrategy kBuilds[] = {BuildStrategy::kMeanSplit, BuildStrategy::kSah};
constexpr Traversal kTraversals[] = {Traversal::kStandard, Traversal::kQuantized, Traversal::kNoLeaf, Traversal::kWide};
constexpr DescentRule kDescents[] = {DescentRule::kFirstTreeFirst, DescentRule::kLargerFirst, DescentRule::kAlternating,
                                     DescentRule::kBoth};
/// Without --repeat, the combinations of one mesh take about this long together, if 3 to 50 rounds do.
constexpr double kCombinationsMs = 10000;

Json pipelineRow(const std::string& name, const CollisionMesh& mesh, const Workspace& workspace,
                 const QueryTimes& times) {
  const CollideStats& stats = workspace.stats;
  Json row;
  row["mesh"] = name;
  row["triangles_a"] = mesh.mesh().triangleCount();
  row["triangles_b"] = mesh.mesh().triangleCount();
  row["build"] = nameOf(mesh.tree().strategy);
  row["box_tests"] = stats.boxTests;
  row["candidate_pairs"] = stats.candidatePairs;
  row["intersecting_pairs"] = stats.intersectingPairs;
  row["contacts_before_reduction"] = stats.contactsBeforeReduction;
  row["contacts"] = workspace.reduced.size();
  const double middle = median(times.main), near = median(times.near), contacts = median(times.contacts);
  const double reduction = median(times.reduction);
  row["middle_ms"] = middle;
  row["near_ms"] = near;
  row["contacts_ms"] = contacts;
  row["reduction_ms"] = reduction;
  row["total_ms"] = median(times.total);
  const double sum = middle + near + contacts + reduction;
  const auto percent = [&](double ms) { return sum > 0 ? 100 * ms / sum : 0.0; };
  row["middle_percent"] = percent(middle);
  row["near_percent"] = percent(near);
  row["contacts_percent"] = percent(contacts);
  row["reduction_percent"] = percent(reduction);
  row["hash"] = hashOf(workspace.reduced);
  return row;
}

/// The whole query, stage by stage as `collide --profile` shows it.
Json profileRow(const std::string& name, const Query& query, const Workspace& workspace, const QueryTimes& times) {
  Json row = {{"mesh", name},
              {"triangles", query.a->mesh().triangleCount()},
              {"build", nameOf(query.a->tree().strategy)},
              {"contacts", query.options.contacts == ContactModel::kSolid ? "solid" : "pairwise"},
              {"backend", "cpu"},
              {"total_ms", median(times.total)}};
  const std::vector<QueryStage> stages = stagesOf(times);
  const auto key = [](const QueryStage& stage, const char* unit) {
    std::string text = fmt::format("{}_{}", stage.name, unit);
    std::replace(text.begin(), text.end(), '-', '_');
    return text;
  };
  for (const QueryStage& stage : stages) row[key(stage, "ms")] = stage.ms;
  for (const QueryStage& stage : stages) row[key(stage, "percent")] = stage.percent;
  row["hash"] = hashOf(workspace.reduced);
  row["answers"] = "same";
  return row;
}

/// The same by the device's own traversal, after the row of the CPU with which it is compared. Nothing without a
/// device.
void addDeviceProfile(const std::string& name, const Query& query, opencl::Backend* backend, int repeat, Json& rows) {
  if (backend == nullptr) return;
  Workspace workspace;
  const std::uint64_t failed = backend->counts().onHost;
  const QueryTimes times = measureQuery(*backend, query, workspace, repeat);
  Json row = profileRow(name, query, workspace, times);
  row["backend"] = "opencl";
  row["answers"] = backend->counts().onHost > failed    ? "device failed"
                   : row["hash"] == rows.back()["hash"] ? "same"
                                                        : "DIFFERENT";
  rows.push_back(row);
}

std::string hashOfPairs(const std::vector<TrianglePair>& pairs) {
  Fnv1a hash;
  for (const TrianglePair& pair : pairs) hash.add(pair);
  return hash.hex();
}

/// One way to find the pairs: a tree, a traversal, a descent rule.
struct Combination {
  Query query;
  Workspace workspace;
  std::vector<double> middle, near;

  void run() {
    findIntersectingPairs(query, workspace);
    middle.push_back(workspace.stats.middleMs);
    near.push_back(workspace.stats.nearMs);
  }
};

/// Every combination for the given trees, run in turns, so that a busy moment of the machine hits all of them.
std::vector<Combination> measureCombinations(const std::vector<std::shared_ptr<const CollisionMesh>>& meshes,
                                             const Query& common, int repeat) {
  std::vector<Combination> all;
  for (const auto& mesh : meshes) {
    for (const Traversal traversal : kTraversals) {
      for (const DescentRule descent : kDescents) {
        Combination& combination = all.emplace_back();
        combination.query = common;
        combination.query.a = combination.query.b = mesh.get();
        combination.query.options.middle = {traversal, descent, 6};
      }
    }
  }
  const auto round = [&] {
    for (Combination& combination : all) combination.run();
  };
  round();  // memory, and layouts that are made on first use
  const double roundMs = timeOnce(round);
  for (Combination& combination : all) {
    combination.middle.clear();
    combination.near.clear();
  }
  const int rounds = repeat > 0 ? repeat : std::clamp(static_cast<int>(kCombinationsMs / roundMs), 3, 50);
  progress(fmt::format("  {} combinations, {} rounds of about {:.3g} ms", all.size(), rounds, roundMs));
  Progress parts(static_cast<std::size_t>(rounds));
  for (int i = 0; i < rounds; ++i, parts.step()) round();
  return all;
}

Json combinationRow(const std::string& name, const Combination& combination) {
  const Query& query = combination.query;
  const CollideStats& stats = combination.workspace.stats;
  const double candidates = double(stats.candidatePairs);
  Json row;
  row["mesh"] = name;
  row["build"] = nameOf(query.a->tree().strategy);
  row["traversal"] = nameOf(query.options.middle.traversal);
  row["descent"] = nameOf(query.options.middle.descent);
  row["box_tests"] = stats.boxTests;
  row["triangle_box_tests"] = stats.triangleBoxTests;
  row["candidate_pairs"] = stats.candidatePairs;
  row["tests_per_candidate"] =
      candidates > 0 ? Json(double(stats.boxTests + stats.triangleBoxTests) / candidates) : Json();
  row["middle_ms"] = median(combination.middle);
  row["middle_fastest_ms"] = *std::min_element(combination.middle.begin(), combination.middle.end());
  row["near_ms"] = median(combination.near);
  row["intersecting_pairs"] = stats.intersectingPairs;
  row["pairs_hash"] = hashOfPairs(pairsOfCaller(query, combination.workspace.intersecting));
  return row;
}

}  // namespace

int benchThesis(const BenchOptions& options) {
  Json pipeline = Json::array(), profile = Json::array(), depths = Json::array(), combinations = Json::array();
  Workspace workspace;
  LevelsBench levels;
  PublishedTables published(levels.backend(), options.repeat);
  const std::vector<BenchMesh> entries = benchMeshes(options);
  Progress all(3 * entries.size());  // of each mesh the tables, the combinations, and the traversal of a device
  for (const BenchMesh& entry : entries) {
    progress(fmt::format("{}: {} triangles", entry.name, entry.mesh->triangleCount()));
    const std::shared_ptr<const TriMesh> sorted = sortedForLocality(*entry.mesh);
    std::vector<std::shared_ptr<const CollisionMesh>> meshes;
    for (const BuildStrategy build : kBuilds) {
      progress(fmt::format("  building the tree by {}", nameOf(build)));
      meshes.push_back(std::make_shared<CollisionMesh>(sorted, build));
    }
    Query query;
    query.bInA = benchPose(options, *meshes[0]);
    query.options.timings = true;
    progress("  the published tables");
    published.add(entry.name, *meshes[0], query.bInA);
    for (const auto& mesh : meshes) {
      query.a = query.b = mesh.get();
      query.options.countPerDepth = false;
      const QueryTimes whole = measureQuery(query, workspace, options.repeat);
      pipeline.push_back(pipelineRow(entry.name, *mesh, workspace, whole));
      profile.push_back(profileRow(entry.name, query, workspace, whole));
      addDeviceProfile(entry.name, query, levels.backend(), options.repeat, profile);
      Query solid = query;
      solid.options.contacts = ContactModel::kSolid;
      const QueryTimes asSolid = measureQuery(solid, workspace, options.repeat);
      profile.push_back(profileRow(entry.name, solid, workspace, asSolid));
      addDeviceProfile(entry.name, solid, levels.backend(), options.repeat, profile);
      query.options.countPerDepth = true;
      collide(query, workspace);
      for (std::size_t depth = 0; depth < workspace.stats.boxTestsPerDepth.size(); ++depth) {
        depths.push_back({{"mesh", entry.name},
                          {"build", nameOf(mesh->tree().strategy)},
                          {"depth", depth},
                          {"box_tests", workspace.stats.boxTestsPerDepth[depth]}});
      }
    }
    all.step();
    query.options.countPerDepth = false;
    for (const Combination& combination : measureCombinations(meshes, query, options.repeat)) {
      combinations.push_back(combinationRow(entry.name, combination));
    }
    all.step();
    levels.add(options, entry.name, meshes);
    all.step();
  }
  Json document = {{"bench", "thesis"},
                   {"scene", options.scene},
                   {"tables",
                    {{"pipeline", pipeline},
                     {"profile", profile},
                     {"box_tests_per_depth", depths},
                     {"combinations", combinations}}}};
  levels.addTablesTo(document);
  published.addTo(document, options.figures);
  printBench(document, options.json);
  return kOk;
}

}  // namespace otg::cli
