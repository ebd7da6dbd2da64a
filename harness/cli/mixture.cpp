// SPDX-License-Identifier: BSD-3-Clause
#include "cli/mixture.h"

#include "cli/levels_rows.h"
#include "cli/times.h"
#include "collide/stages.h"
#include "opencl/backend.h"
#include "opencl/published/published_design.h"

namespace otg::cli {
namespace {

void runMiddle(opencl::PublishedDesign& design, const Query& query, const Mixture& mixture, Workspace& workspace,
               opencl::LevelsReport& report, bool profile) {
  if (mixture.middle == Mixture::Middle::kCpu) {
    middlePhase(query, workspace);
  } else if (mixture.middle == Mixture::Middle::kDevice) {
    design.findCandidates(query, workspace);
  } else {
    design.findCandidatesByLevels(query, workspace, mixture.levels, &report, profile);
  }
}

opencl::NearOrder orderOf(Mixture::Near near) {
  return near == Mixture::Near::kContactsFirst ? opencl::NearOrder::kContactsFirst : opencl::NearOrder::kFilterFirst;
}

opencl::NearTimes medianOf(const std::vector<opencl::NearTimes>& times) {
  using T = opencl::NearTimes;
  T out;
  for (double T::*member : {&T::gather, &T::upload, &T::kernel, &T::readBack, &T::host, &T::total}) {
    std::vector<double> values;
    values.reserve(times.size());
    for (const T& one : times) values.push_back(one.*member);
    out.*member = median(values);
  }
  return out;
}

}  // namespace

MixtureRun collideMixed(opencl::Backend& backend, const Query& query, const Mixture& mixture, Workspace& workspace,
                        bool profile) {
  MixtureRun run;
  opencl::PublishedDesign& design = backend.published();
  run.middle = timeOnce([&] { runMiddle(design, query, mixture, workspace, run.levels, profile); });
  if (mixture.near == Mixture::Near::kCpu) {
    run.near = timeOnce([&] { nearPhase(query, workspace); });
    run.rest = timeOnce([&] {
      collideIntersecting(query, workspace);
      numberAsCaller(query, workspace);
    });
    return run;
  }
  Query timed = query;
  timed.options.timings = true;
  const double all =
      timeOnce([&] { design.collideCandidates(timed, workspace, orderOf(mixture.near), &run.nearPhase, profile); });
  run.near = workspace.stats.nearMs;
  run.rest = all - run.near;
  return run;
}

void findPairsMixed(opencl::Backend& backend, const Query& query, const Mixture& mixture, Workspace& workspace) {
  opencl::LevelsReport report;
  runMiddle(backend.published(), query, mixture, workspace, report, false);
  if (mixture.near == Mixture::Near::kCpu) {
    nearPhase(query, workspace);
  } else {
    backend.published().decideCandidates(query, workspace, orderOf(mixture.near));
  }
}

MixtureRun measureMixed(opencl::Backend& backend, const Query& query, const Mixture& mixture, Workspace& workspace,
                        int repeat) {
  collideMixed(backend, query, mixture, workspace);
  collideMixed(backend, query, mixture, workspace, true);
  std::vector<double> middle, near, rest;
  std::vector<opencl::LevelsTimes> levels;
  std::vector<opencl::NearTimes> nears;
  MixtureRun last;
  repeatTimes(repeat, [&] {
    last = collideMixed(backend, query, mixture, workspace);
    middle.push_back(last.middle);
    near.push_back(last.near);
    rest.push_back(last.rest);
    const MixtureRun profiled = collideMixed(backend, query, mixture, workspace, true);
    levels.push_back(profiled.levels.times);
    nears.push_back(profiled.nearPhase.times);
    return last.total();
  });
  last.middle = median(middle);
  last.near = median(near);
  last.rest = median(rest);
  last.levels.times = medianOf(levels);
  last.nearPhase.times = medianOf(nears);
  return last;
}

QueryTimes timesOf(const MixtureRun& run) {
  QueryTimes times;
  times.total = {run.total()};
  times.main = {run.middle};
  times.near = {run.near};
  times.contacts = {run.rest};
  return times;
}

const char* nameOf(Mixture::Near near) {
  return near == Mixture::Near::kCpu ? "cpu" : near == Mixture::Near::kContactsFirst ? "published" : "filtered";
}

const char* nameOf(opencl::PrefixSums way) {
  return way == opencl::PrefixSums::kPublished       ? "published"
         : way == opencl::PrefixSums::kWorkEfficient ? "work-efficient"
                                                     : "single-pass";
}

std::vector<QueryStage> stagesOf(const opencl::NearTimes& t) {
  // What the device's clock does not see is the CPU's: launches, waiting, and what it finishes.
  return withHost(
      {{"gather", t.gather, 0}, {"upload", t.upload, 0}, {"kernel", t.kernel, 0}, {"read_back", t.readBack, 0}},
      t.total);
}

}  // namespace otg::cli
