// SPDX-License-Identifier: BSD-3-Clause
// `otg bench peers`: the whole query beside other libraries, in turns, so that a busy moment of the machine
// hits all of them.
#include <fmt/format.h>

#include <algorithm>

#include "cli/progress.h"
#include "cli/query_options.h"
#include "collide/query.h"
#include "otg_bench/bench.h"
#include "peers/peer.h"
#include "scenes/simulation.h"

namespace otg::cli {
namespace {

/// This library's query without ODE around it.
class OwnPeer final : public peers::Peer {
 public:
  OwnPeer(const peers::PeerScene& scene, ContactModel model) {
    a_ = std::make_shared<CollisionMesh>(sortedForLocality(*scene.a), BuildStrategy::kSah);
    b_ = std::make_shared<CollisionMesh>(sortedForLocality(*scene.b), BuildStrategy::kSah);
    query_.a = a_.get();
    query_.b = b_.get();
    query_.bInA = scene.bInA;
    query_.options.contacts = model;
  }
  void query() override { collide(query_, workspace_); }
  std::size_t resultCount() const override { return workspace_.reduced.size(); }
  std::vector<double> resultNumbers() const override {
    std::vector<double> numbers;
    for (const Contact& c : workspace_.reduced) {
      numbers.insert(numbers.end(), {c.position.x, c.position.y, c.position.z, c.normal.x, c.normal.y, c.normal.z,
                                     c.depth, double(c.triangleA), double(c.triangleB)});
    }
    return numbers;
  }

 private:
  std::shared_ptr<const CollisionMesh> a_, b_;
  Query query_;
  Workspace workspace_;
};

struct Contestant {
  std::string name, unit, skipped;
  double buildMs = 0;
  std::unique_ptr<peers::Peer> peer;
  std::vector<double> times;
};

std::vector<Contestant> makeContestants(const peers::PeerScene& scene) {
  std::vector<Contestant> all;
  std::vector<peers::PeerEntry> entries = peers::allPeers();
  const auto own = [](ContactModel model) {
    return [model](const peers::PeerScene& s) { return std::make_unique<OwnPeer>(s, model); };
  };
  entries.insert(entries.begin() + 2,
                 {{"ode_trimesh_gpu, pairwise, 64 contacts", "contacts", "", own(ContactModel::kPairwise)},
                  {"ode_trimesh_gpu, solid, 64 contacts", "contacts", "", own(ContactModel::kSolid)}});
  for (const peers::PeerEntry& entry : entries) {
    Contestant& contestant = all.emplace_back();
    contestant.name = entry.name;
    contestant.unit = entry.unit;
    contestant.skipped = entry.unavailable;
    if (!entry.make) continue;
    progress("  building for " + entry.name);
    contestant.buildMs = timeOnce([&] { contestant.peer = entry.make(scene); });
    contestant.peer->query();  // warm-up
  }
  return all;
}

Json describe(const std::string& mesh, const Contestant& contestant, double stockMs) {
  Json row;
  row["mesh"] = mesh;
  row["library"] = contestant.name;
  if (!contestant.peer) {
    for (const char* key : {"query_ms", "fastest_ms", "ratio_to_stock_ode", "build_ms", "results"}) row[key] = nullptr;
    row["unit"] = contestant.unit;
    row["hash"] = "skipped: " + contestant.skipped;
    return row;
  }
  const double ms = median(contestant.times);
  row["query_ms"] = ms;
  row["fastest_ms"] = *std::min_element(contestant.times.begin(), contestant.times.end());
  row["ratio_to_stock_ode"] = stockMs > 0 ? Json(ms / stockMs) : Json();
  row["build_ms"] = contestant.buildMs;
  row["results"] = contestant.peer->resultCount();
  row["unit"] = contestant.unit;
  Fnv1a hash;
  for (const double number : contestant.peer->resultNumbers()) hash.add(number);
  row["hash"] = hash.hex();
  return row;
}

}  // namespace

int benchPeers(const BenchOptions& options) {
  Json rows = Json::array();
  const scenes::OdeSession session;
  const std::vector<BenchMesh> meshes = benchMeshes(options);
  Progress all(meshes.size());
  for (const BenchMesh& entry : meshes) {
    progress(fmt::format("{}: {} triangles", entry.name, entry.mesh->triangleCount()));
    peers::PeerScene scene{entry.mesh.get(), entry.mesh.get(), {}};
    scene.bInA = benchPose(options, CollisionMesh(entry.mesh, BuildStrategy::kSah));
    std::vector<Contestant> contestants = makeContestants(scene);
    const int rounds = options.repeat > 0 ? options.repeat : 15;
    progress(fmt::format("  {} rounds of one query each", rounds));
    Progress parts(static_cast<std::size_t>(rounds));
    for (int round = 0; round < rounds; ++round, parts.step()) {
      for (Contestant& contestant : contestants) {
        if (contestant.peer) contestant.times.push_back(timeOnce([&] { contestant.peer->query(); }));
      }
    }
    const double stockMs = median(contestants.front().times);
    for (const Contestant& contestant : contestants) rows.push_back(describe(entry.name, contestant, stockMs));
    all.step();
  }
  printBench({{"bench", "peers"}, {"scene", options.scene}, {"tables", {{"peers", rows}}}}, options.json);
  return kOk;
}

}  // namespace otg::cli
