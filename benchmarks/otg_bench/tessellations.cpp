// SPDX-License-Identifier: BSD-3-Clause
// `otg bench tessellations`: meshes of convex bodies against each other, as the contact model `solid` has it, against
// the bodies by formula.
#include <fmt/format.h>

#include "cli/progress.h"
#include "otg_bench/bench.h"
#include "otg_bench/error_quantiles.h"
#include "truth/tessellated_bodies.h"

namespace otg::cli {
namespace {

struct TessellationOptions {
  bool json = false, all = false;
  std::string a, b;
  truth::TessellatedRange range;
  double worst = 180;
};

void tellWorst(const truth::TessellatedPose& pose, const Contact& deepest, double degrees) {
  const double off = truth::angleBetween(otgScale(deepest.normal, -1.0), pose.ways.direction);
  if (off < degrees || pose.ambiguous) return;
  fmt::print(stderr, "  {:.1f} degrees off, depth {:.4g} of {:.4g}, next way {:.4g}, coherence {:.3g}, region {}: {}",
             off, deepest.depth, pose.ways.least, pose.ways.other, deepest.coherence, deepest.region,
             static_cast<int>(deepest.feature));
  for (const double x : pose.bInA.r) fmt::print(stderr, " {:.17g}", x);
  fmt::print(stderr, " {:.17g} {:.17g} {:.17g}\n", pose.bInA.t.x, pose.bInA.t.y, pose.bInA.t.z);
}

Json runPair(const truth::TessellatedBody& a, const truth::TessellatedBody& b, const TessellationOptions& options) {
  const auto look = [&](const truth::TessellatedPose& pose, const Contact& deepest) {
    tellWorst(pose, deepest, options.worst);
  };
  const truth::TessellatedErrors errors =
      truth::compareMeshes(a, b, options.range, options.worst < 180 ? truth::TessellatedLook(look) : nullptr);
  Json row;
  row["a"] = a.name;
  row["b"] = b.name;
  row["poses"] = errors.poses;
  row["missed"] = errors.missed;
  row["ambiguous"] = errors.ambiguous;
  addErrorQuantiles(row, "degrees", errors.degrees);
  addErrorQuantiles(row, "depth", errors.depth);
  addErrorQuantiles(row, "longer", errors.longer);
  addErrorQuantiles(row, "depth_beside", errors.depthBeside);
  return row;
}

int benchTessellations(const TessellationOptions& options) {
  Json rows = Json::array();
  const auto chosen = [](std::vector<truth::TessellatedBody> bodies, const std::string& name) {
    if (!name.empty()) std::erase_if(bodies, [&](const truth::TessellatedBody& body) { return name != body.name; });
    return bodies;
  };
  const auto first = chosen(truth::largeBodies(), options.a), second = chosen(truth::smallBodies(), options.b);
  Progress all(first.size() * second.size());
  for (const truth::TessellatedBody& a : first) {
    for (const truth::TessellatedBody& b : second) {
      if (options.worst < 180) fmt::print(stderr, "{} and {}\n", a.name, b.name);
      rows.push_back(runPair(a, b, options));
      all.step();
    }
  }
  if (options.json) {
    printJson({{"bench", "tessellations"}, {"tables", {{"pairs", rows}}}});
    return 0;
  }
  std::vector<std::vector<std::string>> lines;
  for (const Json& row : rows) {
    std::vector<std::string>& line = lines.emplace_back();
    for (const char* key : {"a", "b"}) line.push_back(row[key].get<std::string>());
    for (const char* key : {"missed", "ambiguous"}) line.push_back(std::to_string(row[key].get<int>()));
    for (const char* key : {"degrees", "depth", "longer", "depth_beside"})
      line.push_back(errorQuantilesInWords(row, key));
  }
  fmt::print("Deepest contacts of two meshes, {} overlaps of {} to {} (median / 99 % / largest)\n", options.range.poses,
             options.range.least, options.range.most);
  printTable({"mesh", "and mesh", "missed", "ambiguous", "degrees", "depth from the least way out",
              "way out longer than the least", "depth from the way out"},
             lines);
  return 0;
}

}  // namespace

void addBenchTessellations(CLI::App& bench, Action& action) {
  CLI::App* command =
      bench.add_subcommand("tessellations", "Two meshes of convex bodies against the bodies by formula");
  auto options = std::make_shared<TessellationOptions>();
  command->add_flag("--json", options->json, "One JSON document on stdout");
  command->add_option("--poses", options->range.poses, "Overlaps of each pair")->check(CLI::Range(1, 1000000));
  command->add_option("--seed", options->range.seed, "Of the random numbers");
  command->add_option("--least", options->range.least, "Shortest way apart: not less")->check(CLI::Range(1e-6, 1.0));
  command->add_option("--most", options->range.most, "Not more")->check(CLI::Range(1e-6, 1.0));
  command->add_option("--first", options->a, "Pairs with this as the first body alone");
  command->add_option("--second", options->b, "Pairs with this as the second body alone");
  command->add_option("--tell", options->worst, "Poses whose normal is farther off than so many degrees, on stderr");
  command->callback([options, &action] { action = [options] { return benchTessellations(*options); }; });
}

}  // namespace otg::cli
