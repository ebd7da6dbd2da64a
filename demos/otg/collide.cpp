// SPDX-License-Identifier: BSD-3-Clause
// `otg collide A B --pose P`: one query, its contacts, counters and times.
#include <fmt/format.h>

#include <algorithm>

#include "collide/contact_id.h"
#include "otg/bench_scene.h"
#include "otg/pose.h"
#include "otg/query_options.h"

namespace otg::cli {
namespace {

struct CollideOptions {
  QueryOptions query;
  int repeat = 1;
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

struct Times {
  std::vector<double> top, middle, near, contacts, readBack, host, reduction, total;
};

Times measure(const Query& query, Workspace& workspace, int repeat) {
  Times times;
  collide(query, workspace);  // warm-up: memory is allocated, layouts other than the standard one are made
  for (int i = 0; i < repeat; ++i) {
    times.total.push_back(timeOnce([&] { collide(query, workspace); }));
    times.middle.push_back(workspace.stats.middleMs);
    times.near.push_back(workspace.stats.nearMs);
    times.contacts.push_back(workspace.stats.contactsMs);
    times.reduction.push_back(workspace.stats.reductionMs);
  }
  return times;
}

/// The whole is timed without taking times of its stages, which costs some; these in further runs.
Times measure(opencl::Backend& backend, const Query& query, Workspace& workspace, int repeat) {
  Times times;
  opencl::StageTimes stages;
  backend.collide(query, workspace);
  backend.collideProfiled(query, workspace, stages);
  for (int i = 0; i < repeat; ++i) {
    times.total.push_back(timeOnce([&] { backend.collide(query, workspace); }));
    backend.collideProfiled(query, workspace, stages);
    times.top.push_back(stages.top);
    times.middle.push_back(stages.top + stages.main);
    times.contacts.push_back(stages.contacts);
    times.readBack.push_back(stages.readBack);
    times.host.push_back(stages.host);
    times.reduction.push_back(stages.reduction);
  }
  return times;
}

int runCollide(const CollideOptions& options) {
  Query query;
  query.bInA = parsePose(options.query.pose);
  query.options = options.query.collideOptions();
  query.options.timings = true;
  const LoadedPair pair = loadPair(options.query, std::min(options.repeat, 5));
  query.a = pair.a.get();
  query.b = pair.b.get();
  Workspace workspace;
  const std::shared_ptr<opencl::Backend> backend = options.query.openBackend();
  const Times times =
      backend ? measure(*backend, query, workspace, options.repeat) : measure(query, workspace, options.repeat);
  const CollideStats& stats = workspace.stats;

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
                            {"middle", median(times.middle)},
                            {"near", median(times.near)},
                            {"contacts", median(times.contacts)},
                            {"reduction", median(times.reduction)},
                            {"transfer", median(times.readBack)},  // on the CPU nothing moves between memories
                            {"total", median(times.total)}};
  if (backend) {
    document["timings_ms"]["top"] = median(times.top);  // of the middle phase: where the traversal begins
    document["timings_ms"]["host"] = median(times.host);
  }
  document["backend"] = backend ? "opencl" : "cpu";
  document["device"] = backend ? backend->device().name : "host CPU, 1 thread";
  document["midphase"] = backend ? "opencl" : nameOf(query.options.middle.traversal);
  if (backend && backend->counts().onHost > 0) progress("note: the OpenCL device failed; the CPU finished the query");
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
    fmt::print("{:<26} {:>12.4f} ms\n", entry.key(), entry.value().get<double>());
  }
  fmt::print("{:<26} {} ({})\n", "backend", document["backend"].get<std::string>(),
             document["device"].get<std::string>());
  fmt::print("{:<26} {}\n\n", "hash", document["hash"].get<std::string>());
  std::vector<std::vector<std::string>> rows;
  for (const Contact& c : workspace.reduced) {
    rows.push_back({fmt::format("{:.6g} {:.6g} {:.6g}", c.position.x, c.position.y, c.position.z),
                    fmt::format("{:.4f} {:.4f} {:.4f}", c.normal.x, c.normal.y, c.normal.z),
                    fmt::format("{:.6g}", c.depth), std::to_string(c.triangleA), std::to_string(c.triangleB)});
  }
  printTable({"position (frame A)", "normal", "depth", "triangle A", "triangle B"}, rows);
  return kOk;
}

}  // namespace

void addCollideCommand(CLI::App& app, Action& action) {
  CLI::App* command = app.add_subcommand("collide", "Collide mesh A with mesh B: contacts, counters, times");
  auto options = std::make_shared<CollideOptions>();
  options->query.addInputOptions(*command);
  options->query.addContactOptions(*command);
  command->add_option("--repeat", options->repeat, "Times are medians over this many queries, after one to warm up")
      ->check(CLI::Range(1, 1000000));
  command->add_flag("--json", options->json, "One JSON document on stdout");
  command->callback([options, &action] { action = [options] { return runCollide(*options); }; });
}

}  // namespace otg::cli
