// SPDX-License-Identifier: BSD-3-Clause
// `otg bench contacts`: single queries against the truth. Directions and depths against formulas, net wrenches against
// the gradient of the overlap's volume, few contacts against all of the same model.
#include "otg_bench/contacts.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "cli/progress.h"
#include "otg_bench/bench.h"
#include "otg_bench/certificate.h"
#include "otg_bench/error_quantiles.h"
#include "scenes/simulation.h"
#include "truth/contact_families.h"

namespace otg::cli {
namespace {

using truth::ContactFamily;
using truth::Errors;
using truth::PlainContact;
using truth::Wrench;

struct BenchContactsOptions {
  BenchOptions bench;
  std::string pictures, only;
  int poses = 30;
  std::uint32_t seed = 1;
  bool certificate = false;
  CertificateOptions certificates;
};

/// Overlaps as parts of the family's size. Resting bodies overlap by far less than the first of them.
struct Tier {
  const char* name;
  double least, most;
};
constexpr Tier kTiers[] = {{"0.01-0.1", 0.01, 0.1}, {"0.1-0.5", 0.1, 0.5}};

/// What one method got wrong in one family and tier.
struct Tally {
  int poses = 0, missed = 0;
  Errors contacts, normal, depth, depthOfSize, force, arm, way, wayError;
};

void judge(Tally& tally, const std::vector<PlainContact>& contacts, const ContactFamily& family,
           const truth::Placement& placement, const truth::VolumeGradient& gradient, double wayAlongGradient) {
  ++tally.poses;
  double deepest = 0;
  Vec3d out{0, 0, 0};
  for (const PlainContact& c : contacts) {
    if (c.depth > deepest) out = c.normal;
    deepest = std::max(deepest, c.depth);
  }
  if (!(deepest > 0)) {
    ++tally.missed;
    return;
  }
  tally.contacts.add(static_cast<double>(contacts.size()));
  if (placement.truth) {
    for (const PlainContact& c : contacts) {
      tally.normal.add(truth::angleBetween(c.normal, placement.truth->direction));
    }
    const double error = std::fabs(deepest - placement.truth->depth);
    tally.depth.add(error / placement.truth->depth);
    tally.depthOfSize.add(error / family.size);
  }
  const Wrench ideal{gradient.push, gradient.moment};
  const Wrench wrench = truth::wrenchOf(contacts, gradient.overlap.centroid);
  tally.force.add(truth::angleBetween(wrench.force, ideal.force));
  tally.arm.add(truth::armError(wrench, ideal) / family.size);
  if (!placement.truth && wayAlongGradient > 0) {
    const double way = truth::wayOut(family, placement.bInA, out);
    tally.way.add(way / wayAlongGradient);
    tally.wayError.add(std::fabs(deepest - way) / way);
  }
}

/// Median, 95th percentile and largest.
void addQuantiles(Json& row, const std::string& name, const Errors& errors) {
  addErrorQuantiles(row, name, errors, 95);
}

Json head(const ContactFamily& family, const Tier& tier, const std::string& method, const Tally& tally) {
  Json row;
  row["bodies"] = family.name;
  row["overlap"] = tier.name;
  row["method"] = method;
  row["poses"] = tally.poses;
  row["missed"] = tally.missed;
  return row;
}

/// "median / 95 % / largest" in few digits: for people; JSON has the numbers.
std::string inWords(const Json& row, const std::string& name) {
  std::string words;
  for (const char* part : {"_median", "_p95", "_max"}) {
    const Json& value = row[name + part];
    if (value.is_null()) return "-";
    const auto x = value.get<double>();
    words += (words.empty() ? "" : " / ") + (x < 5e-5 ? "0" : fmt::format("{:.2g}", x < 100 ? x : std::round(x)));
  }
  return words;
}

void printErrors(const std::string& title, const Json& rows, const std::vector<std::string>& plainKeys,
                 const std::vector<std::pair<std::string, std::string>>& errorKeys) {
  fmt::print("{} (median / 95 % / largest)\n", title);
  std::vector<std::string> heads = plainKeys;
  for (const auto& [key, words] : errorKeys) heads.push_back(words);
  std::vector<std::vector<std::string>> lines;
  for (const Json& row : rows) {
    std::vector<std::string>& line = lines.emplace_back();
    for (const std::string& key : plainKeys) {
      line.push_back(row[key].is_string() ? row[key].get<std::string>() : fmt::format("{:g}", row[key].get<double>()));
    }
    for (const auto& [key, words] : errorKeys) line.push_back(inWords(row, key));
  }
  printTable(heads, lines);
  fmt::print("\n");
}

struct Tables {
  Json truth = Json::array(), wrench = Json::array(), ways = Json::array(), reduction = Json::array();
};

void runFamily(const ContactFamily& family, const Tier& tier, const BenchContactsOptions& options, Tables& tables) {
  const std::vector<ContactMethod> methods = contactMethods();
  std::vector<Tally> tallies(methods.size());
  constexpr int kReduced[] = {64, 8};
  Errors force[2], arm[2], counts[2], all;
  // Every family and tier draws its own numbers: adding a family changes no other.
  truth::Random random(options.seed);
  bool hasTruth = false;
  for (int i = 0; i < options.poses; ++i) {
    const double x = random.uniform(0, 1);
    const double overlap = tier.least * std::pow(tier.most / tier.least, x);
    const truth::Placement placement = family.place(random, overlap);
    hasTruth = placement.truth.has_value();
    const truth::VolumeGradient gradient = truth::volumeGradient(family.a->mesh(), family.b->mesh(), placement.bInA);
    const Vec3d& push = gradient.push;
    const double length = std::sqrt(otgDot(push, push));
    const double wayAlongGradient =
        hasTruth || !(length > 0) ? 0 : truth::wayOut(family, placement.bInA, otgScale(push, 1 / length));
    for (std::size_t k = 0; k < methods.size(); ++k) {
      judge(tallies[k], methods[k].contacts(*family.a, *family.b, placement.bInA), family, placement, gradient,
            wayAlongGradient);
    }
    const auto full = solidContactsOf(*family.a, *family.b, placement.bInA, 0);
    const Wrench whole = truth::wrenchOf(full, gradient.overlap.centroid);
    all.add(static_cast<double>(full.size()));
    for (std::size_t k = 0; k < 2; ++k) {
      const auto reduced = solidContactsOf(*family.a, *family.b, placement.bInA, kReduced[k]);
      const Wrench part = truth::wrenchOf(reduced, gradient.overlap.centroid);
      counts[k].add(static_cast<double>(reduced.size()));
      force[k].add(truth::angleBetween(part.force, whole.force));
      arm[k].add(truth::armError(part, whole) / family.size);
    }
  }
  for (std::size_t k = 0; k < methods.size(); ++k) {
    const Tally& tally = tallies[k];
    Json row = head(family, tier, methods[k].name, tally);
    row["contacts"] = tally.contacts.quantile(0.5);
    if (hasTruth) {
      addQuantiles(row, "normal_deg", tally.normal);
      addQuantiles(row, "depth", tally.depth);
      addQuantiles(row, "depth_size", tally.depthOfSize);
      tables.truth.push_back(row);
    }
    row = head(family, tier, methods[k].name, tally);
    addQuantiles(row, "force_deg", tally.force);
    addQuantiles(row, "arm_size", tally.arm);
    tables.wrench.push_back(row);
    if (hasTruth) continue;
    row = head(family, tier, methods[k].name, tally);
    addQuantiles(row, "way_share", tally.way);
    addQuantiles(row, "way_error", tally.wayError);
    tables.ways.push_back(row);
  }
  for (std::size_t k = 0; k < 2; ++k) {
    Json row;
    row["bodies"] = family.name;
    row["overlap"] = tier.name;
    row["places"] = kReduced[k];
    row["contacts"] = counts[k].quantile(0.5);
    row["of"] = all.quantile(0.5);
    addQuantiles(row, "force_deg", force[k]);
    addQuantiles(row, "arm_size", arm[k]);
    tables.reduction.push_back(row);
  }
}

std::vector<BenchMesh> closedMeshes(const BenchOptions& options) {
  std::vector<BenchMesh> meshes = benchMeshes(options);
  for (const BenchMesh& m : meshes) {
    if (m.mesh->meshClass() != MeshClass::kSolid) throw InputError(m.name + ": the mesh is not a closed solid");
  }
  return meshes;
}

std::vector<ContactFamily> familiesOf(const BenchContactsOptions& options) {
  std::vector<ContactFamily> families = truth::contactFamilies();
  std::vector<BenchMesh> meshes = closedMeshes(options.bench);
  // Of the meshes that benchmarks take, the smallest: the truth is slow, and no better for more triangles.
  if (options.bench.files.empty()) meshes.erase(meshes.begin(), meshes.end() - 1);
  for (const BenchMesh& m : meshes) families.push_back(truth::meshFamily(m.name, m.mesh));
  if (options.only.empty()) return families;
  std::erase_if(families, [&](const ContactFamily& f) { return f.name != options.only; });
  if (families.empty()) throw UsageError("there are no bodies named " + options.only);
  return families;
}

int run(const BenchContactsOptions& options) {
  if (options.certificate) {
    CertificateOptions certificates = options.certificates;
    certificates.seed = options.seed;
    certificates.json = options.bench.json;
    if (!options.bench.files.empty()) certificates.meshes = closedMeshes(options.bench);
    return benchCertificate(certificates);
  }
  const scenes::OdeSession session;
  if (!options.pictures.empty()) {
    writeContactPictures(options.pictures, familiesOf(options));
    return kOk;
  }
  Tables tables;
  const std::vector<ContactFamily> families = familiesOf(options);
  Progress all(families.size() * std::size(kTiers));
  for (const ContactFamily& family : families) {
    progress(fmt::format("{}: {}", family.name, family.what));
    for (const Tier& tier : kTiers) {
      runFamily(family, tier, options, tables);
      all.step();
    }
  }
  Json document;
  document["bench"] = "contacts";
  document["seed"] = options.seed;
  document["tables"] = {
      {"truth", tables.truth}, {"wrench", tables.wrench}, {"ways", tables.ways}, {"reduction", tables.reduction}};
  if (options.bench.json) {
    printJson(document);
    return kOk;
  }
  printErrors(
      "Directions and depths against formulas", tables.truth,
      {"bodies", "overlap", "method", "poses", "missed", "contacts"},
      {{"normal_deg", "normal, degrees"}, {"depth", "depth, of the depth"}, {"depth_size", "depth, of the size"}});
  printErrors("Net wrench against the gradient of the overlap's volume", tables.wrench,
              {"bodies", "overlap", "method", "poses", "missed"},
              {{"force_deg", "force, degrees"}, {"arm_size", "line of action, of the size"}});
  printErrors(
      "Way out along the deepest contact's normal, as a part of the way along the gradient, and what its depth says",
      tables.ways, {"bodies", "overlap", "method", "poses", "missed"},
      {{"way_share", "way"}, {"way_error", "depth, of the way"}});
  printErrors("Few contacts against all of the model solid: net wrench", tables.reduction,
              {"bodies", "overlap", "places", "contacts", "of"},
              {{"force_deg", "force, degrees"}, {"arm_size", "line of action, of the size"}});
  return kOk;
}

}  // namespace

void addBenchContacts(CLI::App& bench, Action& action) {
  CLI::App* command = bench.add_subcommand(
      "contacts", "Single queries against the truth: directions, depths, net wrenches, beside other libraries");
  auto options = std::make_shared<BenchContactsOptions>();
  command->add_option("MESH", options->bench.files,
                      "Closed meshes (default: the smallest armadillo* in the folder OTG_MESH_DIR, else a lump)");
  command->add_option("--poses", options->poses, "Random poses for each kind of bodies and overlap")
      ->check(CLI::Range(1, 100000));
  command->add_option("--seed", options->seed, "Of the random poses");
  command->add_option("--bodies", options->only, "Only these, by the name in the first column");
  command->add_option("--pictures", options->pictures,
                      "Instead: write scenes of a few overlaps with their contacts into this folder, for POV-Ray");
  command->add_flag("--json", options->bench.json, "One JSON document on stdout");
  CLI::Option* certificate =
      command->add_flag("--certificate", options->certificate,
                        "Instead: whether what contacts ask for separates random pairs that overlap, by family: of "
                        "those that are built in, or one for each MESH");
  const auto add = [&](const char* name, auto& value, const char* help) {
    return command->add_option(name, value, help)->needs(certificate);
  };
  add("--members", options->certificates.members, "Pairs of each family")->check(CLI::Range(1, 1000000));
  add("--first", options->certificates.first, "Number of the first of them")->check(CLI::Range(0, 1000000000));
  add("--family", options->certificates.family, "Only this family");
  add("--member", options->certificates.member, "Instead of a table: this pair of the family, with its contacts")
      ->check(CLI::Range(0, 1000000000));
  command
      ->add_flag("--deep", options->certificates.deep,
                 "Overlaps of 1 to 20 % of the smaller body, not 1e-6 to 1 %, as fast bodies have them")
      ->needs(certificate);
  add("--places", options->certificates.places, "Most contacts of a pair")->check(CLI::Range(1, 65535));
  add("--form", options->certificates.form, "Of the meshes: geoms of this library, dTriMesh taken over by it, or stock")
      ->check(CLI::IsMember({"own", "override", "stock"}));
  CLI::Option* falls = command->add_flag("--falls", options->certificates.falls,
                                         "Instead: these pairs stepped under gravity, beside stock dTriMesh");
  falls->needs(certificate);
  command
      ->add_flag("--open", options->certificates.open,
                 "Of these worlds: hosts that lost their triangles in the sides of their bounding boxes")
      ->needs(falls);
  command->add_option("--start", options->certificates.start, "How the bodies of these worlds begin (default: settled)")
      ->check(CLI::IsMember({"settled", "dropped", "slid"}))
      ->needs(falls);
  command->add_option("--seconds", options->certificates.seconds, "Of these worlds (default: 2)")
      ->check(CLI::Range(0.01, 1000.0))
      ->needs(falls);
  command->add_option("--rate", options->certificates.rate, "Their steps a second (default: 60 and 240 in turn)")
      ->check(CLI::Range(1, 100000))
      ->needs(falls);
  command->callback([options, &action] { action = [options] { return run(*options); }; });
}

}  // namespace otg::cli
