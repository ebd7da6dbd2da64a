// SPDX-License-Identifier: BSD-3-Clause
// Table, JSON and plot.
#include "physics/report.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <limits>
#include <map>
#include <nlohmann/json.hpp>
#include <set>

namespace otg::physics {
namespace {

using Json = nlohmann::ordered_json;

const char* verdictOf(const Row& row) {
  return row.pass ? "pass" : !row.result.error.empty() ? "ERROR" : row.nativeFailsToo ? "(fail)" : "FAIL";
}

const char* symbolOf(Limit::Kind kind) {
  switch (kind) {
    case Limit::Kind::kAtMost:
    case Limit::Kind::kAtMostTimesNative:
      return "<=";
    case Limit::Kind::kAtLeast:
    case Limit::Kind::kAtLeastTimesNative:
      return ">=";
    case Limit::Kind::kWithinOfNative:
    case Limit::Kind::kWithinShareOfNative:
      return "~";
  }
  return "";
}

std::string formOf(const Case& run) {
  return run.form == Form::kOurs && run.model != Model::kAuto
             ? fmt::format("{}/{}", nameOf(run.form), nameOf(run.model))
             : nameOf(run.form);
}

/// At most about `count` samples: of every stretch the highest, so that no spike is lost.
std::vector<std::pair<double, double>> thinned(const std::vector<std::pair<double, double>>& samples,
                                               std::size_t count) {
  const std::size_t stride = std::max<std::size_t>(1, samples.size() / count);
  std::vector<std::pair<double, double>> few;
  for (std::size_t i = 0; i < samples.size(); i += stride) {
    const auto begin = samples.begin() + static_cast<std::ptrdiff_t>(i);
    const auto end = samples.begin() + static_cast<std::ptrdiff_t>(std::min(samples.size(), i + stride));
    few.push_back(*std::max_element(begin, end, [](const auto& x, const auto& y) { return x.second < y.second; }));
  }
  return few;
}

/// How much of what a limit allows is used up: above 1 it is missed. Not a number counts as all and more.
double useOf(const Check& check) {
  const double infinity = std::numeric_limits<double>::infinity();
  double use = infinity;
  switch (check.limit.kind) {
    case Limit::Kind::kAtMost:
    case Limit::Kind::kAtMostTimesNative:
      use = check.value <= 0 ? 0 : check.value / check.bound;
      break;
    case Limit::Kind::kAtLeast:
    case Limit::Kind::kAtLeastTimesNative:
      use = check.bound <= 0 ? 0 : check.value > 0 ? check.bound / check.value : infinity;
      break;
    case Limit::Kind::kWithinOfNative:
      use = std::abs(check.value - check.bound) / check.limit.value;
      break;
    case Limit::Kind::kWithinShareOfNative:
      use = std::abs(check.value - check.bound) / (check.limit.value * std::abs(check.bound));
      break;
  }
  return std::isnan(use) ? infinity : use;
}

/// Of every limit of a scene the run of ours that comes nearest to it: "drift 3.4e-08 (<= 1e-06), ...". Missed ones
/// with "!" and the run's conditions.
std::string worstFigures(const SuiteResult& suite, const Scene& scene) {
  struct Worst {
    const Row* row;
    const Check* check;
  };
  std::vector<Worst> worst;  // in the order of the limits
  int errors = 0;
  for (const Row& row : suite.rows) {
    if (row.scene != &scene || row.run.form != Form::kOurs) continue;
    errors += !row.result.error.empty();
    for (const Check& check : row.checks) {
      if (check.pass && std::strcmp(check.limit.measure, "finite") == 0) continue;
      const auto same = [&](const Worst& w) {
        const Limit &x = w.check->limit, &y = check.limit;
        return std::strcmp(x.measure, y.measure) == 0 && x.kind == y.kind && x.value == y.value &&
               x.stepper == y.stepper;
      };
      const auto found = std::find_if(worst.begin(), worst.end(), same);
      if (found == worst.end()) {
        worst.push_back({&row, &check});
      } else if (useOf(check) > useOf(*found->check)) {
        *found = {&row, &check};
      }
    }
  }
  std::string text;
  for (const auto& [row, check] : worst) {
    const Limit& limit = check->limit;
    text += fmt::format("{}{}{} {:.3g} ({} {:.3g}{})", text.empty() ? "" : ", ", check->pass ? "" : "!", limit.measure,
                        check->value, symbolOf(limit.kind), check->bound,
                        limit.stepper ? *limit.stepper == Stepper::kWorld ? ", W" : ", Q" : "");
    if (!check->pass) text += " in " + describe(row->run);
  }
  if (errors) text += fmt::format("{}!{} without result", text.empty() ? "" : ", ", errors);
  return text;
}

bool isPlain(const Row& row) {
  const std::vector<Case> runs = runsOf(*row.scene, row.run.form, row.run.model, Extent::kPlain);
  return std::any_of(runs.begin(), runs.end(), [&](const Case& c) { return describe(c) == describe(row.run); });
}

/// Half a height of the axis that makes what matters in the scene visible and no noise: what it allows to be gained.
double meaningfulEnergy(const Scene& scene) {
  double least = 1e-3;
  for (const Limit& limit : scene.limits)
    if (std::string(limit.measure) == "energy_gain") least = std::max(least, limit.value);
  return least;
}

/// The same in all panels: colour by form, dashes by stepper, and the wide line below, since curves often coincide.
std::string styleOf(const Case& run) {
  const char* colour = run.form == Form::kNative ? "#b0b0b0" : run.form == Form::kStock ? "#d55e00" : "#0072b2";
  return fmt::format("lc rgb '{}' lw {} dt {}", colour, run.form == Form::kNative ? 4 : 1.5,
                     run.stepping.stepper == Stepper::kWorld ? "1" : "2");
}

}  // namespace

std::string lineOf(const Row& row) {
  std::string line =
      fmt::format("{:<6} {:<22} {:<14} {:<20}", verdictOf(row), row.scene->name, formOf(row.run), describe(row.run));
  if (!row.result.error.empty()) return line + " " + row.result.error;
  for (const Check& c : row.checks) {
    if (c.pass && std::string(c.limit.measure) == "finite") continue;
    line += fmt::format("  {}{} {:.3g}", c.pass ? "" : "!", c.limit.measure, c.value);
    if (!c.pass) line += fmt::format(" ({} {:.3g})", symbolOf(c.limit.kind), c.bound);
  }
  const auto measure = [&](const char* name) {
    const auto found = row.result.measures.find(name);
    return found == row.result.measures.end() ? 0.0 : found->second;
  };
  return line + fmt::format("  | n {:.1f} collide {:.3f} ms, {:.1f} s", measure("contacts"), measure("collide_ms"),
                            row.wallSeconds);
}

std::string tableOf(const SuiteResult& suite) {
  std::string table;
  for (const Row& row : suite.rows) table += lineOf(row) + "\n";
  for (const SpreadCheck& c : suite.spreads)
    table += fmt::format("{:<6} {}: {}: {:.2f} % (<= {:g} %)\n", c.pass ? "pass" : "FAIL", c.name, c.run,
                         100 * c.spread, 100 * c.share);
  struct Count {
    int passed = 0, asNative = 0, all = 0;
  };
  std::map<std::string, std::map<Form, Count>> counts;
  std::map<Form, Count> total;
  for (const Row& row : suite.rows) {
    for (Count* count : {&counts[row.scene->name][row.run.form], &total[row.run.form]}) {
      ++count->all;
      count->passed += row.pass;
      count->asNative += row.nativeFailsToo;
    }
  }
  const auto cell = [](const std::map<Form, Count>& forms, Form form) {
    const auto found = forms.find(form);
    if (found == forms.end()) return std::string("-");
    const Count& c = found->second;
    return fmt::format("{}/{}{}", c.passed, c.all, c.asNative ? fmt::format(" (+{})", c.asNative) : "");
  };
  // Markdown, so that it can be put on a page as it is.
  table += fmt::format(
      "\nRuns passed of all, and the figures of ours that come nearest to their limits or miss them (!):\n\n"
      "| {:<22} | {:>8} | {:>8} | {:>13} | worst of ours (limit) |\n|{:-<24}|{:->9}:|{:->9}:|{:->14}:|---|\n",
      "scene", "native", "stock", "ours", "", "", "", "");
  std::set<std::string> printed;
  for (const Row& row : suite.rows) {
    if (!printed.insert(row.scene->name).second) continue;
    const auto& forms = counts[row.scene->name];
    table += fmt::format("| {:<22} | {:>8} | {:>8} | {:>13} | {} |\n", row.scene->name, cell(forms, Form::kNative),
                         cell(forms, Form::kStock), cell(forms, Form::kOurs), worstFigures(suite, *row.scene));
  }
  table += fmt::format("| {:<22} | {:>8} | {:>8} | {:>13} | {:.0f} s |\n\n", "all", cell(total, Form::kNative),
                       cell(total, Form::kStock), cell(total, Form::kOurs), suite.wallSeconds);
  table += "(fail) and (+n): runs that miss a limit which ODE's own geoms miss too under the same conditions\n";
  return table;
}

std::string jsonOf(const SuiteResult& suite, const SuiteOptions& options) {
  Json document;
  document["bench"] = "physics";
  document["model"] = nameOf(options.model);
  document["backend"] = options.opencl ? "opencl" : "cpu";
  document["pass"] = suite.pass();
  document["wall_s"] = suite.wallSeconds;
  Json& rows = document["rows"] = Json::array();
  for (const Row& row : suite.rows) {
    Json r;
    r["scene"] = row.scene->name;
    r["family"] = row.scene->family;
    r["what"] = row.scene->what;
    r["form"] = nameOf(row.run.form);
    r["stepper"] = nameOf(row.run.stepping);
    r["dt"] = row.run.dt;
    r["order"] = row.run.order == Order::kAsMade    ? "as made"
                 : row.run.order == Order::kSwapped ? "swapped"
                                                    : "reversed";
    r["offset"] = row.run.offset;
    r["size"] = row.run.size;
    r["buffer"] = row.run.buffer;
    r["seed"] = row.run.randomSeed;
    r["run"] = describe(row.run);
    r["pass"] = row.pass;
    r["native_fails_too"] = row.nativeFailsToo;
    if (!row.result.error.empty()) r["error"] = row.result.error;
    r["measures"] = row.result.measures;
    Json& checks = r["checks"] = Json::array();
    for (const Check& c : row.checks)
      checks.push_back({{"measure", c.limit.measure},
                        {"value", c.value},
                        {"relation", symbolOf(c.limit.kind)},
                        {"bound", c.bound},
                        {"pass", c.pass}});
    if (isPlain(row)) r["energy"] = thinned(row.result.energyHistory, 200);
    rows.push_back(std::move(r));
  }
  Json& spreads = document["spreads"] = Json::array();
  for (const SpreadCheck& c : suite.spreads)
    spreads.push_back({{"name", c.name}, {"run", c.run}, {"spread", c.spread}, {"at_most", c.share}, {"pass", c.pass}});
  return document.dump(1, ' ', false, Json::error_handler_t::replace);
}

std::string plotEnergies(const SuiteResult& suite, const std::string& file) {
  std::vector<std::pair<const Scene*, std::vector<const Row*>>> panels;
  for (const Row& row : suite.rows) {
    if (!isPlain(row) || row.result.energyHistory.empty()) continue;
    if (panels.empty() || panels.back().first != row.scene) panels.push_back({row.scene, {}});
    panels.back().second.push_back(&row);
  }
  if (panels.empty()) return "no run has a history to plot";
  const int columns = std::min<int>(4, static_cast<int>(panels.size()));
  const int lines = (static_cast<int>(panels.size()) + columns - 1) / columns;
  const bool png = file.size() > 4 && file.substr(file.size() - 4) == ".png";
  const std::string script = file + ".gnuplot";
  std::ofstream out(script);
  out << fmt::format("set terminal {} size {},{} font ',9'\nset output '{}'\n", png ? "pngcairo" : "svg dynamic",
                     360 * columns, 260 * lines + 40, file);
  out << fmt::format("set multiplot layout {},{} title 'Energy above the start, J/kg, over time, s'\n", lines, columns);
  out << "set key outside below center horizontal samplen 2 font ',8'\nset grid\nset format y '%.2g'\n";
  for (auto& [scene, rows] : panels) {
    std::stable_sort(rows.begin(), rows.end(), [](const Row* x, const Row* y) { return x->run.form < y->run.form; });
    const double least = meaningfulEnergy(*scene);
    double low = -least, high = least;
    for (std::size_t i = 0; i < rows.size(); ++i) {
      out << fmt::format("$d{} << EOD\n", i);
      for (const auto& [t, e] : thinned(rows[i]->result.energyHistory, 400)) {
        out << fmt::format("{:.4g} {:.6g}\n", t, e);
        // What stock meshes throw about would flatten the others.
        if (rows[i]->run.form != Form::kStock && std::isfinite(e)) {
          low = std::min(low, e);
          high = std::max(high, e);
        }
      }
      out << "EOD\n";
    }
    const double room = 0.05 * (high - low);
    out << fmt::format("set title '{}' noenhanced\nset yrange [{:.6g}:{:.6g}]\nplot ", scene->name, low - room,
                       high + room);
    for (std::size_t i = 0; i < rows.size(); ++i)
      out << fmt::format("{}$d{} with lines {} title '{} {}' noenhanced", i ? ", " : "", i, styleOf(rows[i]->run),
                         nameOf(rows[i]->run.form), nameOf(rows[i]->run.stepping));
    out << "\n";
  }
  out << "unset multiplot\n";
  out.close();
  if (!out) return "cannot write " + script;
  if (std::system(("gnuplot '" + script + "' 2>/dev/null").c_str()) != 0)
    return "gnuplot is not installed or failed; its input is " + script;
  std::remove(script.c_str());
  return {};
}

}  // namespace otg::physics
