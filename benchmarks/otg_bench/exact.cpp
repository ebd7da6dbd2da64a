// SPDX-License-Identifier: BSD-3-Clause
// `otg bench exact`: hard pairs of triangles by the million, in all four traversals, against exact arithmetic that
// shares nothing with the library.
#include <fmt/format.h>

#include <algorithm>
#include <iterator>

#include "cli/progress.h"
#include "cli/query_options.h"
#include "collide/query.h"
#include "otg_bench/bench.h"
#include "otg_bench/exact_families.h"
#include "truth/exact_pairs.h"

namespace otg::cli {
namespace {

struct BenchExactOptions {
  std::int64_t pairs = 10'000'000;
  std::uint32_t seed = 1;
  std::string judge;
  std::vector<std::string> families;
  bool json = false;
};

constexpr Traversal kJudged[] = {Traversal::kStandard, Traversal::kQuantized, Traversal::kNoLeaf, Traversal::kWide};
constexpr std::int64_t kPairsOfScene = std::int64_t{kExactTriangles} * kExactTriangles;
/// Powers of two from 1e-15 to 1e15.
constexpr int kMostExponent = 50;

struct ExactTotals {
  std::int64_t pairs = 0, meeting = 0, differences = 0;
  double seconds = 0;
  Json row(const char* name) const {
    return {
        {"family", name}, {"pairs", pairs}, {"meeting", meeting}, {"differences", differences}, {"seconds", seconds}};
  }
};

class ExactRun {
 public:
  ExactRun(const BenchExactOptions& options, bool byCgal) : options_(options), byCgal_(byCgal) {}

  ExactTotals family(const ExactFamily& family, std::uint32_t number, std::int64_t scenes) {
    ExactTotals totals;
    Progress parts(static_cast<std::size_t>(scenes));
    totals.seconds = 1e-3 * timeOnce([&] {
                       for (std::int64_t i = 0; i < scenes; ++i, parts.step()) scene(family, number, i, totals);
                     });
    return totals;
  }

 private:
  /// Each scene has a number of its own, with which it comes again.
  void scene(const ExactFamily& family, std::uint32_t number, std::int64_t i, ExactTotals& totals) {
    truth::Random random(options_.seed * 0x9e3779b9U ^
                         (number * 0x85ebca6bU + static_cast<std::uint32_t>(i) * 0xc2b2ae35U));
    ExactScene scene = family.make(random);
    if (random.below(2) == 0) scaleScene(scene, random.below(2 * kMostExponent + 1) - kMostExponent);
    const BuildStrategy strategy = random.below(2) == 0 ? BuildStrategy::kSah : BuildStrategy::kMeanSplit;
    const CollisionMesh a(scenes::build(scene.a), strategy), b(scenes::build(scene.b), strategy);
    const std::vector<truth::ExactTriangle> first = truth::exactTriangles(a.mesh()),
                                            second = truth::exactTriangles(b.mesh(), scene.bInA);
    const std::vector<TrianglePair> expected =
        byCgal_ ? truth::pairsByCgal(first, second) : truth::pairsBySeparation(first, second);
    totals.pairs += kPairsOfScene;
    totals.meeting += static_cast<std::int64_t>(expected.size());
    Query query;
    query.a = &a;
    query.b = &b;
    query.bInA = scene.bInA;
    query.options.middle.descent = static_cast<DescentRule>(random.below(4));
    query.options.middle.axes = random.below(2) == 0 ? 6 : 15;
    for (const Traversal traversal : kJudged) {
      query.options.middle.traversal = traversal;
      findIntersectingPairs(query, workspace_);
      if (workspace_.intersecting != expected) report(family, i, traversal, expected, totals);
    }
  }

  void report(const ExactFamily& family, std::int64_t i, Traversal traversal, const std::vector<TrianglePair>& expected,
              ExactTotals& totals) {
    std::vector<TrianglePair> wrong;
    std::set_symmetric_difference(workspace_.intersecting.begin(), workspace_.intersecting.end(), expected.begin(),
                                  expected.end(), std::back_inserter(wrong));
    totals.differences += static_cast<std::int64_t>(wrong.size());
    constexpr int kMostReported = 10;
    if (reported_++ >= kMostReported) return;
    const bool isLost = std::binary_search(expected.begin(), expected.end(), wrong.front());
    fmt::print(stderr, "{}, scene {}, {}: pair {} {} {}\n", family.name, i, nameOf(traversal), wrong.front().a,
               wrong.front().b, isLost ? "is lost" : "does not meet");
  }

  const BenchExactOptions& options_;
  const bool byCgal_;
  Workspace workspace_;
  int reported_ = 0;
};

int runExact(const BenchExactOptions& options) {
  const bool byCgal = options.judge.empty() ? truth::isBuiltWithCgal() : options.judge == "cgal";
  if (byCgal && !truth::isBuiltWithCgal()) throw InputError("built without CGAL; --judge separation needs none");
  std::vector<const ExactFamily*> chosen;
  for (const ExactFamily& family : exactFamilies()) {
    const auto isNamed = [&](const std::string& name) { return name == family.name; };
    if (options.families.empty() || std::any_of(options.families.begin(), options.families.end(), isNamed)) {
      chosen.push_back(&family);
    }
  }
  if (chosen.size() < options.families.size()) throw UsageError("--families: there is no such family");
  const auto count = static_cast<std::int64_t>(chosen.size());
  const std::int64_t scenes = std::max<std::int64_t>(1, options.pairs / (count * kPairsOfScene));
  ExactRun all(options, byCgal);
  ExactTotals sum;
  Json rows = Json::array();
  Progress parts(chosen.size());
  for (const ExactFamily* family : chosen) {
    progress(family->name);
    const ExactTotals totals = all.family(*family, static_cast<std::uint32_t>(family - exactFamilies().data()), scenes);
    rows.push_back(totals.row(family->name));
    sum.pairs += totals.pairs;
    sum.meeting += totals.meeting;
    sum.differences += totals.differences;
    sum.seconds += totals.seconds;
    parts.step();
  }
  rows.push_back(sum.row("all"));
  Json document;
  document["bench"] = "exact";
  document["judge"] = byCgal ? "cgal" : "separation";
  document["seed"] = options.seed;
  document["tables"] = {{"exact", rows}};
  printBench(document, options.json);
  return sum.differences == 0 ? kOk : kBadInput;
}

}  // namespace

void addBenchExact(CLI::App& bench, Action& action) {
  CLI::App* command = bench.add_subcommand(
      "exact", "Hard pairs of triangles in four traversals, against exact arithmetic; exit status 1 for a difference");
  auto options = std::make_shared<BenchExactOptions>();
  command->add_option("--pairs", options->pairs, "Pairs of triangles, over all families together")
      ->check(CLI::Range(std::int64_t{1}, std::int64_t{1'000'000'000'000}));
  command->add_option("--families", options->families, "Only these (default: all)")->delimiter(',');
  command->add_option("--judge", options->judge, "Default: cgal, where the program was built with it")
      ->check(CLI::IsMember({"cgal", "separation"}));
  command->add_option("--seed", options->seed, "Of the random triangles");
  command->add_flag("--json", options->json, "One JSON document on stdout");
  command->callback([options, &action] { action = [options] { return runExact(*options); }; });
}

}  // namespace otg::cli
