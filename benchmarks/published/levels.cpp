// SPDX-License-Identifier: BSD-3-Clause
// The part of `otg bench thesis` that runs on an OpenCL device: the published traversal `levels` beside the CPU and the
// traversal that is used.
#include "published/levels.h"

#include <fmt/format.h>

#include <functional>

#include "cli/levels_rows.h"
#include "cli/query_options.h"
#include "collide/query.h"
#include "opencl/published/published_design.h"

namespace otg::cli {
namespace {

struct Timed {
  double ms = 0;
  std::string hash;
};

Timed timeOf(int repeat, const Workspace& workspace, const std::function<void()>& run) {
  run();  // memory, programs, layouts that are made on first use
  const double ms = median(repeatTimes(repeat, [&] { return timeOnce(run); }));
  return {ms, hashOf(workspace.reduced)};
}

double quotient(double a, double b) {
  return b > 0 ? a / b : 0;
}

}  // namespace

LevelsBench::LevelsBench() {
  const int index = opencl::defaultDevice(findDevices());
  if (index >= 0) backend_ = opencl::Backend::open(index);
  if (!backend_) progress("note: no OpenCL device; the tables of the traversal `levels` are left out");
}

void LevelsBench::add(const BenchOptions& options, const std::string& name,
                      const std::vector<std::shared_ptr<const CollisionMesh>>& meshes) {
  if (!backend_) return;
  std::vector<std::string> scenes = options.scenes;
  if (scenes.empty() && !options.poses.empty()) scenes = {options.scene};
  if (scenes.empty()) scenes = {"touch", "deep", "deep10", "nearmiss"};
  for (const std::string& scene : scenes) {
    BenchOptions posed = options;
    posed.scene = scene;
    const Transformd pose = benchPose(posed, *meshes[0]);
    for (const auto& mesh : meshes) {
      progress(fmt::format("  levels: {}, {}", scene, nameOf(mesh->tree().strategy)));
      addScene(options.repeat, name, scene, *mesh, pose, scene == scenes[0]);
    }
  }
}

void LevelsBench::addScene(int repeat, const std::string& name, const std::string& scene, const CollisionMesh& mesh,
                           const Transformd& pose, bool withDepths) {
  Query query;
  query.a = query.b = &mesh;
  query.bInA = pose;
  Workspace workspace;
  const Timed cpu = timeOf(repeat, workspace, [&] { collide(query, workspace); });
  query.options.middle.traversal = Traversal::kStandard;
  const Timed standard = timeOf(repeat, workspace, [&] { collide(query, workspace); });
  const Timed fast = timeOf(repeat, workspace, [&] { backend_->collide(query, workspace); });
  const std::uint64_t failed = backend_->counts().onHost;
  for (const bool sent : {true, false}) {
    const opencl::LevelsOptions how{6, sent, true};
    opencl::LevelsReport report;
    const Timed levels =
        timeOf(repeat, workspace, [&] { backend_->published().collideByLevels(query, workspace, how, &report); });
    const bool same = levels.hash == cpu.hash && standard.hash == cpu.hash && fast.hash == cpu.hash;
    const CollideStats& stats = workspace.stats;
    Json key = {{"mesh", name},
                {"build", nameOf(mesh.tree().strategy)},
                {"scene", scene},
                {"trees", sent ? "sent" : "resident"}};
    Json row = key;
    row["triangles"] = mesh.mesh().triangleCount();
    row["start_depth"] = how.startDepth;
    row["iterations"] = report.steps.size();
    row["box_tests"] = stats.boxTests;
    row["candidate_pairs"] = stats.candidatePairs;
    row["intersecting_pairs"] = stats.intersectingPairs;
    row["contacts"] = workspace.reduced.size();
    row["bytes_sent"] = report.bytesSent;
    row["levels_ms"] = levels.ms;
    row["cpu_standard_ms"] = standard.ms;
    row["cpu_ms"] = cpu.ms;
    row["device_ms"] = fast.ms;
    row["speed_up_over_cpu_standard"] = quotient(standard.ms, levels.ms);
    row["speed_up_over_cpu"] = quotient(cpu.ms, levels.ms);
    row["hash"] = levels.hash;
    row["answers"] = backend_->counts().onHost > failed ? "device failed" : same ? "same" : "DIFFERENT";
    queries_.push_back(row);

    std::vector<opencl::LevelsTimes> times;
    const auto profiled = [&] {
      backend_->published().collideByLevels(query, workspace, how, &report, true);
      times.push_back(report.times);
    };
    profiled();
    times.clear();
    repeatTimes(repeat, [&] { return timeOnce(profiled); });
    const opencl::LevelsTimes middle = medianOf(times);
    row = key;
    row["levels_ms"] = levels.ms;
    for (const QueryStage& stage : stagesOf(middle, levels.ms)) {
      row[fmt::format("{}_percent", stage.name)] = stage.percent;
    }
    shares_.push_back(row);
    if (withDepths && !sent) {
      key.erase("trees");
      for (const Json& depth : depthRows(report.steps, key)) depths_.push_back(depth);
    }
  }
}

void LevelsBench::addTablesTo(Json& document) const {
  if (!backend_) return;
  document["device"] = backend_->device().name;
  document["tables"]["levels"] = queries_;
  document["tables"]["levels_shares"] = shares_;
  document["tables"]["levels_per_depth"] = depths_;
}

}  // namespace otg::cli
