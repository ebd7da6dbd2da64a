// SPDX-License-Identifier: BSD-3-Clause
// `otg collide A B --pose P`: one query, its contacts, counters and times.
#include <fmt/format.h>

#include <algorithm>

#include "cli/levels_rows.h"
#include "cli/mixture.h"
#include "cli/pose.h"
#include "cli/query_options.h"
#include "cli/query_profile.h"
#include "cli/times.h"
#include "collide/contact_id.h"
#include "collide/stages.h"
#include "opencl/published/published_design.h"
#include "otg/collide_heightfield.h"
#include "otg/commands.h"
#include "scenes/height_grid_file.h"

namespace otg::cli {
namespace {

struct CollideOptions {
  QueryOptions query;
  int repeat = 1;
  bool profile = false;
  bool json = false;
};

Json toJson(const Vec3d& v) {
  return Json::array({v.x, v.y, v.z});
}

struct FeatureName {
  const char* feature;
  const char* mesh;  ///< whose it is; null for neither
};

FeatureName featureName(ContactFeature feature) {
  switch (feature) {
    case ContactFeature::kFaceA:
      return {"face", "a"};
    case ContactFeature::kFaceB:
      return {"face", "b"};
    case ContactFeature::kCoplanar:
      return {"coplanar", nullptr};
    case ContactFeature::kVertexA:
      return {"vertex", "a"};
    case ContactFeature::kVertexB:
      return {"vertex", "b"};
    case ContactFeature::kCrossingA:
      return {"crossing", "a"};
    case ContactFeature::kCrossingB:
      return {"crossing", "b"};
    case ContactFeature::kMiddleA:
      return {"middle", "a"};
    case ContactFeature::kMiddleB:
      return {"middle", "b"};
    case ContactFeature::kNone:
      break;
  }
  return {"region", nullptr};
}

/// What sets a contact apart from others: its depth is not that of its place, or was cut.
std::string remarksOn(const Contact& contact) {
  std::string text = (contact.flags & kContactContained) != 0 ? "contained" : "";
  if ((contact.flags & kContactClamped) != 0) text += text.empty() ? "clamped" : ", clamped";
  return text;
}

Json describe(const Contact& contact, const Query& query) {
  const FeatureName name = featureName(contact.feature);
  Json vertices = Json::array();
  if (contact.feature == ContactFeature::kVertexA || contact.feature == ContactFeature::kVertexB) {
    vertices.push_back((name.mesh[0] == 'a' ? query.a : query.b)->mesh().callerVertex(contact.element));
  } else if (contact.element != kNone) {
    const TriMesh& mesh = (name.mesh[0] == 'a' ? query.a : query.b)->mesh();
    const Topology::Edge& edge = mesh.topology().edges[contact.element];
    vertices = {mesh.callerVertex(edge.a), mesh.callerVertex(edge.b)};
  }
  return {{"position", toJson(contact.position)},
          {"normal", toJson(contact.normal)},
          {"depth", contact.depth},
          {"triangle_a", contact.triangleA},
          {"triangle_b", contact.triangleB},
          {"region", contact.region},
          {"coherence", contact.coherence < 0 ? Json() : Json(contact.coherence)},
          {"feature", name.feature},
          {"feature_mesh", name.mesh ? Json(name.mesh) : Json()},
          {"vertices", vertices},
          {"inside", (contact.flags & kContactInside) != 0},
          {"contained", (contact.flags & kContactContained) != 0},
          {"clamped", (contact.flags & kContactClamped) != 0},
          {"id", fmt::format("{:016x}", contactId(contact))}};
}

/// As measureQuery(), by the traversal `levels`. `report` is that of the last run, with medians of the times.
QueryTimes measure(opencl::Backend& backend, const Query& query, Workspace& workspace, int repeat,
                   const opencl::LevelsOptions& how, opencl::LevelsReport& report) {
  QueryTimes times;
  std::vector<opencl::LevelsTimes> all;
  const auto run = [&] { backend.published().collideByLevels(query, workspace, how); };
  const double first = timeOnce(run);
  times.uploadOnce = std::max(0.0, first - timeOnce(run));
  backend.published().collideByLevels(query, workspace, how, &report, true);
  for (int i = 0; i < repeat; ++i) {
    times.total.push_back(timeOnce(run));
    backend.published().collideByLevels(query, workspace, how, &report, true);
    const opencl::LevelsTimes& t = report.times;
    all.push_back(t);
    times.profiled.push_back(t.total);
    times.upload.push_back(t.upload);
    times.top.push_back(t.start);
    times.main.push_back(t.test + t.scan + t.compaction + t.split + t.spawn);
    times.near.push_back(t.near);
    times.contacts.push_back(t.contacts);
    times.reduction.push_back(t.regions + t.choose + t.reduction);
    times.readBack.push_back(t.readBack);
    times.host.push_back(t.host);
  }
  report.times = medianOf(all);
  return times;
}

/// Phases chosen one by one.
QueryTimes measure(opencl::Backend& backend, const Query& query, Workspace& workspace, int repeat,
                   const Mixture& mixture, MixtureRun& run, opencl::LevelsReport& report) {
  run = measureMixed(backend, query, mixture, workspace, repeat);
  report = run.levels;
  return timesOf(run);
}

/// Phases on different sides, or wherever it is expected to be faster.
QueryTimes measure(Dispatcher& dispatcher, const PairJob& job, Workspace& workspace, int repeat, Dispatcher::Ran& ran) {
  QueryTimes times;
  dispatcher.collide(job, workspace, ran);
  for (int i = 0; i < repeat; ++i) {
    ran = {};
    times.total.push_back(timeOnce([&] { dispatcher.collide(job, workspace, ran); }));
    times.main.push_back(workspace.stats.middleMs);
    times.near.push_back(workspace.stats.nearMs);
    times.contacts.push_back(workspace.stats.contactsMs);
    times.reduction.push_back(workspace.stats.reductionMs);
  }
  return times;
}

Json stepsOf(const std::vector<QueryStage>& stages) {
  Json rows = Json::array();
  for (const QueryStage& stage : stages) {
    rows.push_back({{"step", stage.name}, {"ms", stage.ms}, {"percent", stage.percent}});
  }
  return rows;
}

/// The steps of the traversal `levels`.
Json stepsOf(const opencl::LevelsTimes& times, double total) {
  return stepsOf(stagesOf(times, total));
}

int runCollide(const CollideOptions& options) {
  if (scenes::namesHeightGrid(options.query.fileB) || scenes::namesHeightGrid(options.query.fileA)) {
    if (options.profile) throw UsageError("--profile is of two meshes");
    return collideWithHeightfield(options.query, options.repeat, options.json);
  }
  Query query;
  query.bInA = parsePose(options.query.pose);
  query.options = options.query.collideOptions();
  query.options.timings = true;
  const LoadedPair pair = loadPair(options.query, std::min(options.repeat, 5));
  query.a = pair.a.get();
  query.b = pair.b.get();
  Workspace workspace;
  constexpr Placement kCpu{Place::kCpu, Place::kCpu}, kDevice{Place::kOpencl, Place::kOpencl};
  Placement place = options.query.placement();
  std::shared_ptr<opencl::Backend> backend = options.query.openBackend();
  const std::optional<Mixture> mixture = options.query.mixture();
  const std::unique_ptr<Dispatcher> dispatcher =
      place != kCpu && place != kDevice && !mixture ? options.query.openDispatcher() : nullptr;
  // Without a device it is the CPU, by its own traversal.
  if (!backend && (!dispatcher || !dispatcher->hasDevices())) place = kCpu;
  Dispatcher::Ran ran{backend != nullptr, false};
  bool isLevels = options.query.isLevels() && backend, isMixed = mixture && backend;
  const opencl::LevelsOptions how = options.query.levelsOptions();
  opencl::LevelsReport report;
  MixtureRun mixed;
  QueryTimes times = mixture && backend ? measure(*backend, query, workspace, options.repeat, *mixture, mixed, report)
                     : isLevels         ? measure(*backend, query, workspace, options.repeat, how, report)
                     : backend          ? measureQuery(*backend, query, workspace, options.repeat)
                     : dispatcher       ? measure(*dispatcher, {query, false, place}, workspace, options.repeat, ran)
                                        : measureQuery(query, workspace, options.repeat);
  if (backend) ran.deviceFailed = backend->counts().onHost > 0;
  if (backend && backend->counts().onHost == backend->counts().queries) {  // nothing was done there
    backend.reset();
    ran.onDevice = isLevels = false;
    isMixed = false;
    times = measureQuery(query, workspace, options.repeat);
  }
  if (!ran.onDevice) place = kCpu;
  const CollideStats stats = countsOf(query, workspace.stats);

  Json document;
  document["a"] = options.query.fileA;
  document["b"] = options.query.fileB;
  document["candidate_pairs"] = stats.candidatePairs;
  document["box_tests"] = stats.boxTests;
  document["triangle_box_tests"] = stats.triangleBoxTests;
  document["intersecting_pairs"] = stats.intersectingPairs;
  document["decided_by_double"] = stats.decidedByDouble;
  document["decided_exactly"] = stats.decidedExactly;
  document["contacts_before_reduction"] = stats.contactsBeforeReduction;
  document["contacts"] = Json::array();
  for (const Contact& contact : workspace.reduced) {
    document["contacts"].push_back(describe(contact, query));
  }
  document["timings_ms"] = {{"build", pair.buildMs},
                            {"middle", median(times.top) + median(times.main)},
                            {"near", median(times.near)},
                            {"contacts", median(times.contacts)},
                            {"reduction", median(times.reduction)},
                            {"transfer", median(times.readBack)},  // on the CPU nothing moves between memories
                            {"total", median(times.total)}};
  if (backend && !isMixed) {
    document["timings_ms"]["top"] = median(times.top);  // of the mid phase: where the traversal begins
    document["timings_ms"]["host"] = median(times.host);
  }
  // Of phases that run on different sides each is named; a query as a whole has the backend that a device is part of.
  const bool isAuto = place == Placement{};
  const auto sideOf = [&](Place phase) {
    return (isAuto ? ran.onDevice : phase == Place::kOpencl) ? std::string("opencl") : std::string("cpu");
  };
  const std::string device = backend        ? backend->device().name
                             : ran.onDevice ? dispatcher->devices().front()->backend->device().name
                                            : std::string();
  document["backend"] = ran.onDevice ? "opencl" : "cpu";
  document["device"] = device.empty() ? "host CPU, 1 thread" : device;
  document["midphase"] = isLevels                           ? "levels"
                         : sideOf(place.middle) == "opencl" ? "opencl"
                                                            : nameOf(query.options.middle.traversal);
  document["nearphase"] = isMixed ? nameOf(mixture->near) : sideOf(place.near);
  if (ran.deviceFailed) progress("note: the OpenCL device failed; the CPU finished the query");
  if (isLevels) {
    document["levels"] = {{"start_depth", how.startDepth},
                          {"trees", how.sendTrees ? "sent" : "resident"},
                          {"near", isMixed         ? "apart"
                                   : how.fusedNear ? "fused"
                                                   : "split"},
                          {"prefix_sums", nameOf(how.prefixSums)},
                          {"bytes_sent", report.bytesSent},
                          {"per_depth", depthRows(report.steps)}};
  }
  if (isMixed && mixture->near != Mixture::Near::kCpu) {
    document["gathered"] = {{"pairs", mixed.nearPhase.candidates},
                            {"triangles", mixed.nearPhase.triangles},
                            {"records", mixed.nearPhase.records},
                            {"bytes_sent", mixed.nearPhase.bytesSent}};
  }
  if (options.profile) {
    const bool middleOnDevice = sideOf(place.middle) == "opencl", nearOnDevice = sideOf(place.near) == "opencl";
    document["profile"] =
        profileRows(times, isMixed                          ? mixedStageTexts(middleOnDevice, nearOnDevice)
                           : isLevels                       ? kStagesByLevels
                           : backend                        ? (!isPairwise(query) ? solidStageTexts() : kStagesOnDevice)
                           : middleOnDevice || nearOnDevice ? mixedStageTexts(middleOnDevice, nearOnDevice)
                                                            : kStagesOnCpu);
    if (isLevels) document["levels"]["profile"] = stepsOf(report.times, isMixed ? mixed.middle : median(times.total));
    if (isMixed && document.contains("gathered")) {
      document["gathered"]["profile"] = stepsOf(stagesOf(mixed.nearPhase.times));
    }
    if (backend && !isMixed) {
      document["profiled_ms"] = median(times.profiled);
      document["first_query_extra_ms"] = times.uploadOnce;
    }
  }
  document["repeat"] = options.repeat;
  document["hash"] = hashOf(workspace.reduced);
  if (options.json) {
    printJson(document);
    return kOk;
  }
  for (const char* key : {"box_tests", "candidate_pairs", "intersecting_pairs", "contacts_before_reduction"}) {
    fmt::print("{:<26} {:>12}\n", key, document[key].get<std::uint64_t>());
  }
  fmt::print("{:<26} {:>12}\n", "contacts", workspace.reduced.size());
  for (const auto& entry : document["timings_ms"].items()) {
    const std::string& key = entry.key();
    if (key == "top" || key == "host") continue;  // stages, which --profile shows
    fmt::print("{:<26} {:>12.4f} ms\n", key, entry.value().get<double>());
  }
  fmt::print("{:<26} {} ({})\n", "backend", document["backend"].get<std::string>(),
             document["device"].get<std::string>());
  fmt::print("{:<26} {}\n", "hash", document["hash"].get<std::string>());
  if (options.profile) {
    printTable("profile (medians)", document["profile"]);
    if (isMixed && document.contains("gathered")) {
      printTable("gathered narrow phase, step by step (medians)", document["gathered"]["profile"]);
    }
    if (backend && !isMixed) {
      fmt::print(
          "Stages on the device are timed by its clock, in queries of their own, which take {:.4f} ms as a whole.\n"
          "Host is what is left of the queries that take no times: {:.4f} ms.\n"
          "The first query took {:.4f} ms more than the second: upload of both meshes, programs, lists.\n",
          median(times.profiled), median(times.total), times.uploadOnce);
    }
  }
  if (isLevels) {
    if (options.profile) printTable("levels, step by step (medians)", document["levels"]["profile"]);
    printTable("levels, pairs of nodes by depth", document["levels"]["per_depth"]);
  }
  fmt::print("\n");
  // Most contacts have nothing to remark, and then the column is missing.
  std::vector<std::string> head{"position (frame A)", "normal", "depth", "triangle A", "triangle B"};
  const bool remarks = std::any_of(workspace.reduced.begin(), workspace.reduced.end(),
                                   [](const Contact& c) { return !remarksOn(c).empty(); });
  if (remarks) head.push_back("remarks");
  std::vector<std::vector<std::string>> rows;
  for (const Contact& c : workspace.reduced) {
    rows.push_back({fmt::format("{:.6g} {:.6g} {:.6g}", c.position.x, c.position.y, c.position.z),
                    fmt::format("{:.4f} {:.4f} {:.4f}", c.normal.x, c.normal.y, c.normal.z),
                    fmt::format("{:.6g}", c.depth), std::to_string(c.triangleA), std::to_string(c.triangleB)});
    if (remarks) rows.back().push_back(remarksOn(c));
  }
  printTable(head, rows);
  return kOk;
}

}  // namespace

void addCollideCommand(CLI::App& app, Action& action) {
  CLI::App* command = app.add_subcommand(
      "collide", "Collide mesh A with mesh B, or with the heightfield B.json: contacts, counters, times");
  auto options = std::make_shared<CollideOptions>();
  options->query.addInputOptions(*command);
  options->query.addContactOptions(*command);
  command->add_option("--repeat", options->repeat, "Times are medians over this many queries, after one to warm up")
      ->check(CLI::Range(1, 1000000));
  command->add_flag("--profile", options->profile, "Where the time goes, stage by stage");
  command->add_flag("--json", options->json, "One JSON document on stdout");
  command->callback([options, &action] { action = [options] { return runCollide(*options); }; });
}

}  // namespace otg::cli
