// SPDX-License-Identifier: BSD-3-Clause
// Planning, running and judging.
#include "physics/suite.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstring>
#include <limits>
#include <map>
#include <nlohmann/json.hpp>
#include <numeric>
#include <stdexcept>
#include <thread>

#include "cli/progress.h"
#include "ode_trimesh_gpu/ode_trimesh_gpu.h"
#include "physics/process_pool.h"

namespace otg::physics {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

std::string keyOf(const Case& run) {
  return fmt::format("{} {} {}", run.scene, nameOf(run.form), describe(run));
}

std::string toText(const Result& result, double seconds) {
  return nlohmann::json{{"measures", result.measures}, {"energy", result.energyHistory}, {"wall", seconds}}.dump();
}

/// Numbers that are not finite travel as null.
double numberOf(const nlohmann::json& value) {
  return value.is_number() ? value.get<double>() : kNan;
}

void fromText(const std::string& text, Row& row) {
  const nlohmann::json document = nlohmann::json::parse(text);
  for (const auto& [name, value] : document.at("measures").items()) row.result.measures[name] = numberOf(value);
  for (const auto& sample : document.at("energy"))
    row.result.energyHistory.emplace_back(numberOf(sample.at(0)), numberOf(sample.at(1)));
  row.wallSeconds = document.at("wall").get<double>();
}

bool refersToNative(const Limit& limit) {
  return limit.kind != Limit::Kind::kAtMost && limit.kind != Limit::Kind::kAtLeast;
}

Check check(const Limit& limit, double value, double native) {
  Check c{limit, value, kNan, false};
  // Written so that a value that is not a number fails.
  switch (limit.kind) {
    case Limit::Kind::kAtMost:
      c.bound = limit.value;
      c.pass = value <= c.bound;
      break;
    case Limit::Kind::kAtLeast:
      c.bound = limit.value;
      c.pass = value >= c.bound;
      break;
    case Limit::Kind::kAtMostTimesNative:
      c.bound = limit.value * native;
      c.pass = value <= c.bound;
      break;
    case Limit::Kind::kAtLeastTimesNative:
      c.bound = limit.value * native;
      c.pass = value >= c.bound;
      break;
    case Limit::Kind::kWithinOfNative:
      c.bound = native;
      c.pass = std::abs(value - native) <= limit.value;
      break;
    case Limit::Kind::kWithinShareOfNative:
      c.bound = native;
      c.pass = std::abs(value - native) <= limit.value * std::abs(native);
      break;
  }
  return c;
}

std::vector<SpreadCheck> judgeSpreads(const std::vector<Row>& rows) {
  std::vector<SpreadCheck> checks;
  for (const SpreadLimit& limit : spreadLimits()) {
    // Runs that differ in nothing but the scene.
    std::map<std::string, std::vector<double>> groups;
    for (const Row& row : rows) {
      if (std::find(limit.scenes.begin(), limit.scenes.end(), row.scene->name) == limit.scenes.end()) continue;
      const auto found = row.result.measures.find(limit.measure);
      groups[fmt::format("{} {}", nameOf(row.run.form), describe(row.run))].push_back(
          found == row.result.measures.end() ? kNan : found->second);
    }
    for (const auto& [run, values] : groups) {
      if (values.size() != limit.scenes.size()) continue;
      double low = values[0], high = values[0];
      for (const double v : values) {
        low = std::isnan(v) ? v : std::min(low, v);
        high = std::max(high, v);
      }
      const double spread = (high - low) / std::abs(low);
      checks.push_back({limit.name, run, spread, limit.share, spread <= limit.share});
    }
  }
  return checks;
}

std::vector<const Scene*> chosenScenes(const SuiteOptions& options) {
  std::vector<const Scene*> chosen;
  for (const Scene& scene : allScenes()) {
    const bool named = std::find(options.scenes.begin(), options.scenes.end(), scene.name) != options.scenes.end();
    const bool usual =
        scene.realUse == options.realUse && (scene.realUse || options.extent != Extent::kQuick || scene.quick);
    if ((options.scenes.empty() ? usual : named) && missingFile(scene).empty()) chosen.push_back(&scene);
  }
  return chosen;
}

std::vector<Row> plan(const SuiteOptions& options) {
  std::vector<Row> rows;
  std::map<std::string, bool> planned;
  const auto add = [&](const Scene& scene, const Case& run) {
    if (planned.emplace(keyOf(run), true).second) rows.push_back({&scene, run, {}, {}, false, false, 0});
  };
  for (const Scene* scene : chosenScenes(options)) {
    for (const Form form : {Form::kNative, Form::kStock, Form::kOurs}) {
      if (std::find(options.forms.begin(), options.forms.end(), form) == options.forms.end()) continue;
      if (form == Form::kNative && !scene->hasNative) continue;
      for (Case run : runsOf(*scene, form, options.model, options.extent)) {
        if (form == Form::kNative) run = nativeOf(run);
        if (fmt::format("{}/{}", scene->family, keyOf(run)).find(options.filter) == std::string::npos) continue;
        // Also where no limit refers to it: whether a missed limit is excused must not hang on the choice of forms.
        if (form != Form::kNative && scene->hasNative) add(*scene, nativeOf(run));
        add(*scene, run);
      }
    }
  }
  return rows;
}

/// What the library helps itself out of would otherwise be counted as the device's.
void demandFaultlessDevice() {
  dGpuTriMeshDevice device;
  dGpuTriMeshDeviceInit(&device);
  if (dGpuTriMeshGetDevice(0, &device) != dGPUTRIMESH_OK || device.failed_calls > 0)
    throw std::runtime_error("the OpenCL device failed");
}

}  // namespace

std::vector<Case> runsOf(const Scene& scene, Form form, Model model, Extent extent) {
  Case plain;
  plain.scene = scene.name;
  plain.form = form;
  plain.model = model;
  plain.size = scene.size;
  plain.dt = scene.dt;
  plain.fullGravity = scene.fullGravity;
  std::vector<Case> runs;
  for (const Stepping& stepping : scene.steppings) {
    plain.stepping = stepping;
    runs.push_back(plain);
    if (extent != Extent::kFull) continue;
    const auto vary = [&](unsigned axis, const auto& values, auto&& set) {
      if (!(scene.axes & axis)) return;
      for (const auto& value : values) {
        runs.push_back(plain);
        set(runs.back(), value);
      }
    };
    vary(kAxisTimeStep, std::vector{1.0 / 60}, [](Case& c, double dt) { c.dt = dt; });
    vary(kAxisFineStep, std::vector{1.0 / 1000}, [](Case& c, double dt) { c.dt = dt; });
    // Seeds where they mean something; the rest along the first stepper only, to keep the whole suite short.
    std::vector<unsigned long> seeds;
    for (int seed = 2; seed <= scene.seeds; ++seed) seeds.push_back(static_cast<unsigned long>(seed));
    if (stepping.stepper == Stepper::kQuick)
      vary(kAxisSeed, seeds, [](Case& c, unsigned long seed) { c.randomSeed = seed; });
    if (&stepping != &scene.steppings.front()) continue;
    vary(kAxisOrder, std::vector{Order::kSwapped, Order::kReversed}, [](Case& c, Order order) { c.order = order; });
    vary(kAxisOffset, std::vector{1e5}, [](Case& c, double offset) { c.offset = offset; });
    vary(kAxisSize, std::vector{1e-2, 1e2}, [](Case& c, double size) { c.size = size; });
    vary(kAxisBuffer, std::vector{20, 8, 4}, [](Case& c, int buffer) { c.buffer = buffer; });
  }
  return runs;
}

Result runCase(const Scene& scene, const Case& run) {
  return scene.run(run);
}

void judge(Row& row, const Row* native) {
  row.checks.clear();
  row.pass = row.result.error.empty();
  std::vector<Limit> limits = row.scene->limits;
  limits.push_back(atLeast("finite", 1));
  for (const Limit& limit : limits) {
    if (limit.stepper && *limit.stepper != row.run.stepping.stepper) continue;
    const auto valueIn = [&](const Row& from) {
      const auto found = from.result.measures.find(limit.measure);
      return found == from.result.measures.end() ? kNan : found->second;
    };
    if (refersToNative(limit) && (!native || row.run.form == Form::kNative)) continue;
    row.checks.push_back(check(limit, valueIn(row), native ? valueIn(*native) : kNan));
    row.pass = row.pass && row.checks.back().pass;
  }
  const auto missesToo = [&](const Check& missed) {
    return native && std::any_of(native->checks.begin(), native->checks.end(), [&](const Check& c) {
             return !c.pass && std::strcmp(c.limit.measure, missed.limit.measure) == 0;
           });
  };
  row.nativeFailsToo =
      !row.pass && row.result.error.empty() &&
      std::all_of(row.checks.begin(), row.checks.end(), [&](const Check& c) { return c.pass || missesToo(c); });
}

bool SuiteResult::pass() const {
  return std::all_of(rows.begin(), rows.end(),
                     [](const Row& row) { return row.run.form != Form::kOurs || row.pass || row.nativeFailsToo; }) &&
         std::all_of(spreads.begin(), spreads.end(),
                     [](const SpreadCheck& c) { return c.pass || c.run.rfind("ours", 0) != 0; });
}

SuiteResult runSuite(const SuiteOptions& options) {
  const auto start = std::chrono::steady_clock::now();
  const auto secondsSince = [](std::chrono::steady_clock::time_point t) {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - t).count();
  };
  SuiteResult suite;
  suite.rows = plan(options);
  // Long runs first, so that no processor waits at the end.
  std::vector<std::size_t> order(suite.rows.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return suite.rows[a].scene->seconds > suite.rows[b].scene->seconds;
  });
  std::map<std::string, const Row*> natives;
  for (const Row& row : suite.rows)
    if (row.run.form == Form::kNative) natives[keyOf(row.run)] = &row;
  const int workers =
      options.workers > 0 ? options.workers : static_cast<int>(std::max(1u, std::thread::hardware_concurrency()));
  cli::Progress progress(order.size());
  runInProcesses(
      order.size(), workers, options.timeout,
      [&](std::size_t i) {
        const Row& row = suite.rows[order[i]];
        const auto begin = std::chrono::steady_clock::now();
        const OdeSession session;
        const bool onDevice = options.opencl && row.run.form == Form::kOurs;
        if (dGpuTriMeshSetBackend(onDevice ? dGPUTRIMESH_BACKEND_OPENCL : dGPUTRIMESH_BACKEND_CPU) != dGPUTRIMESH_OK)
          throw std::runtime_error("no OpenCL device");
        const Result result = runCase(*row.scene, row.run);
        if (onDevice) demandFaultlessDevice();
        return toText(result, secondsSince(begin));
      },
      [&](std::size_t i, const JobOutcome& outcome) {
        Row& row = suite.rows[order[i]];
        row.result.error = outcome.error;
        if (outcome.error.empty()) fromText(outcome.output, row);
        judge(row, nullptr);
        progress.step();
      });
  for (Row& row : suite.rows) {
    const auto native = natives.find(keyOf(nativeOf(row.run)));
    // Native rows are judged by the absolute limits above and stand still while others refer to them.
    if (row.run.form != Form::kNative) judge(row, native == natives.end() ? nullptr : native->second);
  }
  suite.spreads = judgeSpreads(suite.rows);
  suite.wallSeconds = secondsSince(start);
  return suite;
}

}  // namespace otg::physics
