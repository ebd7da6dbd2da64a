// SPDX-License-Identifier: BSD-3-Clause
// `otg bench thesis`: the tables of the published work, and what they are for the defaults of today.
#include <fmt/format.h>

#include "collide/query.h"
#include "otg/bench.h"
#include "otg/query_options.h"

namespace otg::cli {
namespace {

constexpr BuildStrategy kBuilds[] = {BuildStrategy::kMeanSplit, BuildStrategy::kSah};
constexpr Traversal kTraversals[] = {Traversal::kStandard, Traversal::kQuantized, Traversal::kNoLeaf, Traversal::kWide};
constexpr DescentRule kDescents[] = {DescentRule::kFirstTreeFirst, DescentRule::kLargerFirst, DescentRule::kAlternating,
                                     DescentRule::kBoth};

struct Measured {
  double middle = 0, near = 0, contacts = 0, reduction = 0, total = 0;
};

Measured measure(const Query& query, Workspace& workspace, int repeat) {
  std::vector<double> middle, near, contacts, reduction;
  collide(query, workspace);  // memory, and layouts that are made on first use
  const std::vector<double> total = repeatTimes(repeat, [&] {
    const double ms = timeOnce([&] { collide(query, workspace); });
    middle.push_back(workspace.stats.middleMs);
    near.push_back(workspace.stats.nearMs);
    contacts.push_back(workspace.stats.contactsMs);
    reduction.push_back(workspace.stats.reductionMs);
    return ms;
  });
  return {median(middle), median(near), median(contacts), median(reduction), median(total)};
}

Json pipelineRow(const std::string& name, const CollisionMesh& mesh, const Workspace& workspace, const Measured& time) {
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
  row["middle_ms"] = time.middle;
  row["near_ms"] = time.near;
  row["contacts_ms"] = time.contacts;
  row["reduction_ms"] = time.reduction;
  row["total_ms"] = time.total;
  const double sum = time.middle + time.near + time.contacts + time.reduction;
  const auto percent = [&](double ms) { return sum > 0 ? 100 * ms / sum : 0.0; };
  row["middle_percent"] = percent(time.middle);
  row["near_percent"] = percent(time.near);
  row["contacts_percent"] = percent(time.contacts);
  row["reduction_percent"] = percent(time.reduction);
  row["hash"] = hashOf(workspace.reduced);
  return row;
}

std::string hashOfPairs(const std::vector<TrianglePair>& pairs) {
  Fnv1a hash;
  for (const TrianglePair& pair : pairs) hash.add(pair);
  return hash.hex();
}

Json combinationRow(const std::string& name, const Query& query, const Workspace& workspace, const Measured& time) {
  const CollideStats& stats = workspace.stats;
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
  row["middle_ms"] = time.middle;
  row["near_ms"] = time.near;
  row["intersecting_pairs"] = stats.intersectingPairs;
  row["pairs_hash"] = hashOfPairs(pairsOfCaller(query, workspace.intersecting));
  return row;
}

}  // namespace

int benchThesis(const BenchOptions& options) {
  Json pipeline = Json::array(), depths = Json::array(), combinations = Json::array();
  Workspace workspace;
  for (const BenchMesh& entry : benchMeshes(options)) {
    Transformd pose{};
    for (const BuildStrategy build : kBuilds) {
      progress(fmt::format("{}: {} triangles, tree {}", entry.name, entry.mesh->triangleCount(), nameOf(build)));
      const CollisionMesh mesh(sortedInSpace(*entry.mesh), build);
      if (build == kBuilds[0]) pose = benchPose(options, mesh);
      Query query;
      query.a = query.b = &mesh;
      query.bInA = pose;
      query.options.timings = true;
      const Measured whole = measure(query, workspace, options.repeat);
      pipeline.push_back(pipelineRow(entry.name, mesh, workspace, whole));
      query.options.countPerDepth = true;
      collide(query, workspace);
      for (std::size_t depth = 0; depth < workspace.stats.boxTestsPerDepth.size(); ++depth) {
        depths.push_back({{"mesh", entry.name},
                          {"build", nameOf(build)},
                          {"depth", depth},
                          {"box_tests", workspace.stats.boxTestsPerDepth[depth]}});
      }
      query.options.countPerDepth = false;
      for (const Traversal traversal : kTraversals) {
        for (const DescentRule descent : kDescents) {
          query.options.middle = {traversal, descent, 6};
          const Measured time = measure(query, workspace, options.repeat);
          combinations.push_back(combinationRow(entry.name, query, workspace, time));
        }
      }
    }
  }
  printBench({{"bench", "thesis"},
              {"scene", options.scene},
              {"tables", {{"pipeline", pipeline}, {"box_tests_per_depth", depths}, {"combinations", combinations}}}},
             options.json);
  return kOk;
}

}  // namespace otg::cli
