// SPDX-License-Identifier: BSD-3-Clause
#include "otg_bench/certificate.h"

#include <fmt/format.h>
#include <ode_trimesh_gpu/ode_trimesh_gpu.h>

#include <algorithm>
#include <cmath>
#include <memory>

#include "cli/command.h"
#include "cli/progress.h"
#include "otg_bench/error_quantiles.h"
#include "scenes/simulation.h"
#include "truth/certificate_verdict.h"
#include "truth/family_fall.h"

namespace otg::cli {
namespace {

using truth::CertificateFamily;
using truth::CertificateMember;
using truth::FamilyVerdict;
using truth::JudgedContact;
using truth::Verdict;

std::string inDigits(double x) {
  return x == 0 ? "0" : fmt::format("{:.3g}", x);
}

std::string reasonOf(const Verdict& v) {
  if (v.certificate.none) return "no contacts";
  if (v.certificate.infeasible) return "no translation satisfies all";
  if (!v.certified())
    return fmt::format("{:.3g} of the overlap left, {:.3g} of the way", v.certificate.left, v.certificate.leftWay);
  return fmt::format("{:.3g} times the shortest", v.length);
}

truth::GeomChoices choicesOf(const CertificateOptions& options) {
  return {.places = options.places, .asTriMesh = options.form != "own"};
}

const truth::OverlapRange& overlapsOf(const CertificateOptions& options) {
  return options.deep ? truth::kDeepOverlaps : truth::kShallowOverlaps;
}

std::optional<CertificateMember> memberOf(const CertificateFamily& family, const CertificateOptions& options, int i) {
  return certificateMember(family, options.seed, i, overlapsOf(options));
}

FamilyVerdict judgeFamily(const CertificateFamily& family, const CertificateOptions& options) {
  return truth::judgeAll(family, {options.seed, options.first, options.members, overlapsOf(options)},
                         choicesOf(options));
}

Json rowOf(const std::string& name, const FamilyVerdict& v) {
  Json row;
  row["family"] = name;
  row["members"] = v.members;
  row["not_drawn"] = v.notDrawn;
  row["none"] = v.none;
  row["infeasible"] = v.infeasible;
  row["left"] = v.left;
  row["left_way"] = v.leftWay;
  row["too_long"] = v.tooLong;
  addErrorQuantiles(row, "length", v.length, 95);
  addErrorQuantiles(row, "tilt", v.tilt, 95);
  row["too_deep"] = v.tooDeep;
  row["longer"] = v.longer;
  row["order"] = v.order;
  row["order_much"] = v.orderMuch;
  row["call"] = v.call;
  row["update"] = v.update;
  row["worst"] = v.worst.number;
  row["worst_is"] = reasonOf(v.worst);
  row["failing"] = v.numbers;
  return row;
}

void printFamilies(const Json& rows) {
  std::vector<std::vector<std::string>> lines;
  for (const Json& row : rows) {
    const auto number = [&](const char* key) { return std::to_string(row[key].get<int>()); };
    const auto quantiles = [&](const std::string& name) {
      std::string words;
      for (const char* part : {"_median", "_p95", "_max"}) {
        const Json& value = row[name + part];
        words += (words.empty() ? "" : " / ") + (value.is_null() ? "-" : inDigits(value.get<double>()));
      }
      return words;
    };
    lines.push_back({row["family"].get<std::string>(), number("members"), number("none"), number("infeasible"),
                     number("left"), number("left_way"), number("too_long"), number("longer"), quantiles("length"),
                     quantiles("tilt"), number("too_deep"), number("order"), number("order_much"), number("call"),
                     number("update"), number("worst") + ": " + row["worst_is"].get<std::string>()});
  }
  fmt::print("Certificates (lengths over the shortest and tilts: median / 95 % / largest)\n");
  printTable({"family", "members", "none", "infeasible", "left", "left way", "> 3", "> 1.5", "length, of the shortest",
              "tilt, degrees", "too deep", "order", "much", "call", "update", "the worst member"},
             lines);
}

truth::FallConditions conditionsOf(const CertificateOptions& options, int number) {
  truth::FallConditions conditions = truth::fallConditions(number);
  conditions.start = options.start == "dropped" ? truth::FallStart::kDropped
                     : options.start == "slid"  ? truth::FallStart::kSlid
                                                : truth::FallStart::kSettled;
  conditions.duration = options.seconds;
  if (options.rate > 0) conditions.timeStep = 1.0 / options.rate;
  return conditions;
}

/// The members of a family as worlds: ours, and stock dTriMesh.
Json fallsOf(const CertificateFamily& family, const CertificateOptions& options) {
  truth::Errors gains[2];
  int thrown[2] = {0, 0};
  Json numbers = Json::array();
  for (int i = options.first; i < options.first + options.members; ++i) {
    std::optional<CertificateMember> member = memberOf(family, options, i);
    if (member && options.open) member = truth::withOpenHost(*member);
    if (!member) continue;
    truth::FallConditions conditions = conditionsOf(options, i);
    for (const std::size_t form : {0, 1}) {
      conditions.asTriMesh = form == 1;
      const double gain = truth::fall(*member, conditions).gain;
      gains[form].add(gain);
      if (!(gain > truth::thrownFrom(conditions.timeStep))) continue;
      ++thrown[form];
      if (form == 0) numbers.push_back(i);
    }
  }
  Json row;
  row["family"] = family.name;
  row["members"] = gains[0].count();
  row["thrown"] = thrown[0];
  row["stock_thrown"] = thrown[1];
  addErrorQuantiles(row, "gain", gains[0], 95);
  addErrorQuantiles(row, "stock_gain", gains[1], 95);
  row["failing"] = numbers;
  return row;
}

void printFalls(const Json& rows) {
  std::vector<std::vector<std::string>> lines;
  for (const Json& row : rows) {
    std::vector<std::string> line{row["family"].get<std::string>()};
    for (const char* key : {"members", "thrown", "stock_thrown"}) line.push_back(std::to_string(row[key].get<int>()));
    for (const char* key :
         {"gain_median", "gain_p95", "gain_max", "stock_gain_median", "stock_gain_p95", "stock_gain_max"}) {
      line.push_back(row[key].is_null() ? "-" : inDigits(row[key].get<double>()));
    }
    lines.push_back(std::move(line));
  }
  fmt::print(
      "Worlds (gains: largest rise of energy in one step, of weight times size; thrown: from {:.3g} on, and more "
      "at more than 240 steps a second)\n",
      truth::kThrown);
  printTable(
      {"family", "members", "thrown", "stock", "gain, median", "95 %", "largest", "stock's, median", "95 %", "largest"},
      lines);
}

std::string inWords(const Vec3d& v) {
  return fmt::format("({:.6g}, {:.6g}, {:.6g})", v.x, v.y, v.z);
}

/// Everything about one member, in the host's frame and in units of the smaller body.
void printMember(const CertificateFamily& family, const CertificateOptions& options) {
  const std::optional<CertificateMember> member = memberOf(family, options, options.member);
  if (!member) throw UsageError("no draw of this number gives a pair in such an overlap");
  const Verdict verdict = truth::judge(*member, options.member, choicesOf(options));
  const auto& frame = member->a.pose;
  const auto inA = [&](const Vec3d& v) { return otgRotateBack(frame, v); };
  const auto length = [](const Vec3d& v) { return std::sqrt(otgDot(v, v)); };
  fmt::print("{} {} (seed {}): {}\n", family.name, options.member, options.seed, member->what);
  fmt::print("size {:.6g}, triangles {} and {}\n", member->size, member->a.mesh.triangles.size(),
             member->b.mesh.triangles.size());
  fmt::print("A's frame. The shortest translation of A that separates: {:.6g} along {}\n", length(member->shortest),
             inWords(inA(otgScale(member->shortest, 1 / length(member->shortest)))));
  fmt::print("verdict: {}; asked {:.6g} along {}; tilt {:.3g} degrees; order {} call {} update {}\n", reasonOf(verdict),
             verdict.certificate.length,
             inWords(inA(otgScale(verdict.certificate.asked, 1 / std::max(verdict.certificate.length, 1e-300)))),
             verdict.tilt, verdict.orderMatters, verdict.callMatters, verdict.updateMatters);
  const std::vector<JudgedContact> contacts = truth::contactsInOde(member->a, member->b, choicesOf(options));
  const auto deep = truth::tooDeep(member->plainA, member->plainB, contacts, member->grain());
  std::vector<std::vector<std::string>> lines;
  for (std::size_t i = 0; i < contacts.size(); ++i) {
    const JudgedContact& c = contacts[i];
    const bool tooDeep = std::find(deep.begin(), deep.end(), i) != deep.end();
    lines.push_back({std::to_string(i), inWords(inA(otgSub(c.position, frame.t))), inWords(inA(c.normal)),
                     inDigits(c.depth / length(member->shortest)),
                     std::string(tooDeep ? "too deep" : "") + (c.exempt ? " exempt" : "")});
  }
  printTable({"contact", "place", "normal", "depth, of the shortest", ""}, lines);
}

std::vector<CertificateFamily> familiesOf(const std::vector<BenchMesh>& meshes) {
  std::vector<std::shared_ptr<const TriMesh>> bodies;
  for (const BenchMesh& m : meshes) bodies.push_back(m.mesh);
  std::vector<CertificateFamily> families;
  for (std::size_t i = 0; i < meshes.size(); ++i) families.push_back(truth::bodyFamily(meshes[i].name, bodies, i));
  return families;
}

std::vector<CertificateFamily> chosen(const CertificateOptions& options) {
  std::vector<CertificateFamily> families =
      options.meshes.empty() ? truth::certificateFamilies() : familiesOf(options.meshes);
  if (options.family.empty()) return families;
  std::erase_if(families, [&](const CertificateFamily& f) { return f.name != options.family; });
  if (families.empty()) throw UsageError("there is no family named " + options.family);
  return families;
}

}  // namespace

int benchCertificate(const CertificateOptions& options) {
  const scenes::OdeSession session;
  if (options.form == "override" && dGpuTriMeshOverrideTriMeshWith(dGPUTRIMESH_OVERRIDE_ALL) != dGPUTRIMESH_OK) {
    throw InputError("the library cannot take over dTriMesh geoms");
  }
  const std::vector<CertificateFamily> families = chosen(options);
  if (options.member >= 0) {
    if (families.size() != 1) throw UsageError("--member goes with --family");
    printMember(families.front(), options);
    return kOk;
  }
  Json rows = Json::array();
  Progress all(families.size());
  for (const CertificateFamily& family : families) {
    progress(fmt::format("{}: {}", family.name, family.what));
    rows.push_back(options.falls ? fallsOf(family, options) : rowOf(family.name, judgeFamily(family, options)));
    all.step();
  }
  if (options.json) {
    Json document;
    document["bench"] = "contacts";
    document["seed"] = options.seed;
    document["form"] = options.form;
    if (options.falls) {
      document["open"] = options.open;
      document["start"] = options.start;
      document["seconds"] = options.seconds;
      document["rate"] = options.rate;
    }
    document["tables"] = {{options.falls ? "falls" : "certificate", rows}};
    printJson(document);
  } else if (options.falls) {
    printFalls(rows);
  } else {
    printFamilies(rows);
  }
  return kOk;
}

}  // namespace otg::cli
