// SPDX-License-Identifier: BSD-3-Clause
// `otg bench contours`: how often overlaps give the model `solid` anything that it cannot work with, and how often
// bodies touch the rim of their terrain.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "cli/progress.h"
#include "otg_bench/bench.h"
#include "scenes/generated_meshes.h"
#include "truth/contact_families.h"
#include "truth/contour_audit.h"

namespace otg::cli {
namespace {

struct BenchContoursOptions {
  BenchOptions bench;
  int poses = 40;
  std::uint32_t seed = 1;
};

using MeshPointer = std::shared_ptr<const CollisionMesh>;

MeshPointer treeOf(const scenes::MeshArrays& arrays) {
  return std::make_shared<CollisionMesh>(scenes::build(arrays), BuildStrategy::kSah);
}

struct Pairing {
  std::string name;
  MeshPointer a, b;
};

std::vector<Pairing> generatedPairings() {
  const MeshPointer box = treeOf(scenes::makeBox({1, 1, 1}, 4)), ball = treeOf(scenes::makeSphere(0.6, 3));
  const MeshPointer ring = treeOf(scenes::makeTorus(1, 0.3, 48, 24));
  const MeshPointer gear = treeOf(scenes::makeGear(16, 1, 0.2, 0.4, 0.3));
  const MeshPointer lump = treeOf(scenes::makeLump(0.8, 4, 0.4, 1)), otherLump = treeOf(scenes::makeLump(1, 3, 0.6, 2));
  return {{"box, box", box, box},
          {"box, ball", box, ball},
          {"ball, ball", ball, ball},
          {"ring, ring", ring, ring},
          {"cylinder, box", treeOf(scenes::makeCylinder(0.4, 1.5, 32, 4)), box},
          {"gear, gear", gear, gear},
          {"bowl, lump", treeOf(scenes::makeBowl(1, 0.2, 32, 8)), lump},
          {"lump, lump", lump, otherLump},
          {"block with a hole, peg", treeOf(scenes::makeBlockWithHole({3, 3, 4}, 1)),
           treeOf(scenes::makeBox({0.99, 0.99, 2}, 2))},
          {"bolt, nut", treeOf(scenes::makeBolt(0.5, 0.2, 2, 24)), treeOf(scenes::makeNut(0.5, 0.2, 0.6, 0.02, 24))}};
}

/// One of the 24 turns that map the axes onto each other.
Transformd rightTurn(truth::Random& random) {
  const int first = random.below(3), second = (first + 1 + random.below(2)) % 3;
  const double s = random.sign(), t = random.sign();
  double x[3] = {0, 0, 0}, y[3] = {0, 0, 0};
  x[first] = s;
  y[second] = t;
  const Vec3d u{x[0], x[1], x[2]}, v{y[0], y[1], y[2]}, w = otgCross(u, v);
  return {{u.x, v.x, w.x, u.y, v.y, w.y, u.z, v.z, w.z}, {0, 0, 0}};
}

/// Anyhow, or with `exact` so that faces, edges and vertices coincide: turned by right angles, moved by eighths of the
/// first mesh's bounds.
Transformd randomPose(truth::Random& random, const Pairing& pairing, bool exact) {
  const double reach = static_cast<double>(pairing.a->mesh().radius() + pairing.b->mesh().radius());
  Transformd pose = exact ? rightTurn(random) : random.rotation();
  if (exact) {
    const auto step = [&] { return 0.125 * (random.below(33) - 16); };
    const double x = step(), y = step(), z = step();
    pose.t = {x, y, z};
  } else {
    pose.t = otgScale(random.direction(), random.uniform(0, reach));
  }
  return pose;
}

struct Totals {
  int overlaps = 0, open = 0, anomalous = 0, bad = 0, fallbacks = 0, silent = 0;
  std::size_t crossings = 0, regions = 0;
  void add(const truth::ContourAudit& audit) {
    ++overlaps;
    crossings += audit.crossings;
    regions += audit.regions;
    open += audit.openEnds > 0;
    anomalous += audit.anomalies > 0;
    bad += audit.badRegions > 0;
    fallbacks += audit.fallsBack;
    silent += !audit.fallsBack && audit.contacts == 0;
  }
  void add(const Totals& other) {
    overlaps += other.overlaps;
    open += other.open;
    anomalous += other.anomalous;
    bad += other.bad;
    fallbacks += other.fallbacks;
    silent += other.silent;
    crossings += other.crossings;
    regions += other.regions;
  }
  Json row(const std::string& name, const char* poses) const {
    Json r;
    r["bodies"] = name;
    r["placed"] = poses;
    r["overlaps"] = overlaps;
    r["crossings"] = crossings;
    r["regions"] = regions;
    r["open_contours"] = open;
    r["with_anomalies"] = anomalous;
    r["bad_regions"] = bad;
    r["fallbacks"] = fallbacks;
    r["without_contacts"] = silent;
    return r;
  }
};

Totals auditPairing(const Pairing& pairing, const BenchContoursOptions& options, bool exact) {
  truth::Random random(options.seed);
  Totals totals;
  Progress found(static_cast<std::size_t>(options.poses));
  // Placements that do not cross (apart, or one inside the other) say nothing about contours and are drawn again.
  for (int tries = 0; totals.overlaps < options.poses && tries < 100 * options.poses; ++tries) {
    const auto audit = truth::auditContour(*pairing.a, *pairing.b, randomPose(random, pairing, exact));
    if (audit.crossings == 0) continue;
    totals.add(audit);
    found.step();
  }
  return totals;
}

Json solidsTable(const BenchContoursOptions& options) {
  std::vector<Pairing> pairings = generatedPairings();
  if (!options.bench.files.empty()) {
    for (const BenchMesh& mesh : benchMeshes(options.bench)) {
      if (mesh.mesh->meshClass() != MeshClass::kSolid) throw InputError(mesh.name + ": the mesh is not a closed solid");
      const auto tree = std::make_shared<CollisionMesh>(mesh.mesh, BuildStrategy::kSah);
      pairings.push_back({mesh.name, tree, tree});
    }
  }
  Json rows = Json::array();
  Totals all;
  Progress parts(2 * pairings.size());
  for (const Pairing& pairing : pairings) {
    progress(pairing.name);
    for (const bool exact : {false, true}) {
      const Totals totals = auditPairing(pairing, options, exact);
      rows.push_back(totals.row(pairing.name, exact ? "on a grid" : "anyhow"));
      all.add(totals);
      parts.step();
    }
  }
  rows.push_back(all.row("all", ""));
  return rows;
}

/// Boxes set down anywhere on a hilly terrain of 10 m, sunk in by a twentieth of their side.
Json rimsTable(const BenchContoursOptions& options) {
  constexpr double kTerrain = 10;
  constexpr int kCells = 40;
  const auto height = [](double x, double y) { return 0.3 * std::sin(1.3 * x) * std::cos(0.9 * y); };
  scenes::MeshArrays ground = scenes::makeGround(kTerrain, 1, kCells, height);
  ground.triangles.resize(2 * kCells * kCells);  // its upper side alone
  const MeshPointer terrain = treeOf(ground);
  Json rows = Json::array();
  for (const double side : {0.25, 0.5, 1.0, 2.0, 4.0}) {
    const MeshPointer box = treeOf(scenes::makeBox({side, side, side}, 2));
    truth::Random random(options.seed);
    int touching = 0, open = 0, elsewhere = 0, fallbacks = 0;
    for (int i = 0; i < 10 * options.poses; ++i) {
      Transformd pose = random.rotation();
      const double x = random.uniform(-0.5, 0.5) * kTerrain, y = random.uniform(-0.5, 0.5) * kTerrain;
      const double half = 0.5 * side * (std::fabs(pose.r[6]) + std::fabs(pose.r[7]) + std::fabs(pose.r[8]));
      pose.t = {x, y, height(x, y) + half - 0.05 * side};
      const auto audit = truth::auditContour(*terrain, *box, pose);
      if (audit.crossings == 0) continue;
      ++touching;
      open += audit.openEnds > 0;
      elsewhere += audit.openEnds > audit.openOnRims;
      fallbacks += audit.fallsBack;
    }
    rows.push_back({{"box_side_m", side},
                    {"touching", touching},
                    {"open_contours", open},
                    {"open_off_the_rim", elsewhere},
                    {"fallbacks", fallbacks},
                    {"share_at_rim", touching ? static_cast<double>(open) / touching : 0.0}});
  }
  return rows;
}

int run(const BenchContoursOptions& options) {
  Json document;
  document["bench"] = "contours";
  document["seed"] = options.seed;
  document["tables"] = {{"Overlaps of solids", solidsTable(options)},
                        {"Boxes on a terrain of 10 m", rimsTable(options)}};
  printBench(document, options.bench.json);
  return kOk;
}

}  // namespace

void addBenchContours(CLI::App& bench, Action& action) {
  CLI::App* command = bench.add_subcommand(
      "contours", "Random overlaps: open contours, contradictions, fallbacks of the model solid; rims of terrains");
  auto options = std::make_shared<BenchContoursOptions>();
  command->add_option("MESH", options->bench.files, "Closed meshes, each against its copy, beside the generated ones");
  command->add_option("--poses", options->poses, "Overlaps for each pair of bodies, and as many again on a grid")
      ->check(CLI::Range(1, 100000));
  command->add_option("--seed", options->seed, "Of the random poses");
  command->add_flag("--json", options->bench.json, "One JSON document on stdout");
  command->callback([options, &action] { action = [options] { return run(*options); }; });
}

}  // namespace otg::cli
