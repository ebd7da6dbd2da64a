// SPDX-License-Identifier: BSD-3-Clause
// `otg pairs A B --pose P --out FILE`: the exact set of intersecting triangle pairs.
#include <fmt/format.h>

#include <cstdio>

#include "cli/pose.h"
#include "cli/query_options.h"
#include "opencl/published/published_design.h"
#include "otg/commands.h"

namespace otg::cli {
namespace {

struct PairsOptions {
  QueryOptions query;
  std::string out;
  bool json = false;
};

void writePairs(const std::string& path, const std::vector<TrianglePair>& pairs) {
  std::string text;
  for (const TrianglePair& pair : pairs) fmt::format_to(std::back_inserter(text), "{} {}\n", pair.a, pair.b);
  if (path == "-") {
    std::fwrite(text.data(), 1, text.size(), stdout);
    return;
  }
  std::FILE* file = std::fopen(path.c_str(), "wb");
  if (file == nullptr) throw InputError(path + ": cannot be written");
  const bool written = std::fwrite(text.data(), 1, text.size(), file) == text.size();
  if ((std::fclose(file) != 0) || !written) throw InputError(path + ": writing failed");
}

int runPairs(const PairsOptions& options) {
  if (options.json && options.out == "-") throw UsageError("--json and --out - both want stdout");
  Query query;
  query.bInA = parsePose(options.query.pose);
  query.options = options.query.collideOptions();
  const LoadedPair pair = loadPair(options.query, 1);
  query.a = pair.a.get();
  query.b = pair.b.get();
  Workspace workspace;
  query.options.contacts = ContactModel::kPairwise;
  const std::optional<Mixture> mixture = options.query.mixture();
  const std::shared_ptr<opencl::Backend> levels =
      options.query.isLevels() || mixture ? options.query.openBackend() : nullptr;
  if (levels && mixture) {
    findPairsMixed(*levels, query, *mixture, workspace);
  } else if (levels) {
    levels->published().findPairsByLevels(query, workspace, options.query.levelsOptions());
  } else if (options.query.isLevels() || mixture) {  // without a device
    findIntersectingPairs(query, workspace);
  } else {
    // The pairs are left in the workspace by a query for any contacts, wherever its phases run.
    const std::unique_ptr<Dispatcher> dispatcher = options.query.openDispatcher();
    Dispatcher::Ran ran;
    dispatcher->collide({query, true, options.query.placement()}, workspace, ran);
  }
  if (!options.out.empty()) writePairs(options.out, pairsOfCaller(query, workspace.intersecting));
  const CollideStats& stats = workspace.stats;
  if (options.json) {
    printJson({{"candidate_pairs", stats.candidatePairs},
               {"intersecting_pairs", stats.intersectingPairs},
               {"box_tests", stats.boxTests},
               {"decided_by_double", stats.decidedByDouble},
               {"decided_exactly", stats.decidedExactly},
               {"out", options.out.empty() ? Json() : Json(options.out)}});
  } else if (options.out != "-") {
    fmt::print("{} candidate pairs, {} intersecting pairs\n", stats.candidatePairs, stats.intersectingPairs);
  }
  return kOk;
}

}  // namespace

void addPairsCommand(CLI::App& app, Action& action) {
  CLI::App* command =
      app.add_subcommand("pairs", "The exact set of intersecting triangle pairs, sorted, as lines `a b`");
  auto options = std::make_shared<PairsOptions>();
  options->query.addInputOptions(*command);
  command->add_option("--out", options->out, "File for the pairs, - for stdout");
  command->add_flag("--json", options->json, "One JSON document on stdout");
  command->callback([options, &action] { action = [options] { return runPairs(*options); }; });
}

}  // namespace otg::cli
