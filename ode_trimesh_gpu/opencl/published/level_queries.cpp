// SPDX-License-Identifier: BSD-3-Clause
// Queries by the traversal `levels`.
#include "collide/stages.h"
#include "opencl/lanes/host_cases.h"
#include "opencl/lanes/take_answer.h"
#include "opencl/published/published_design.h"
#include "opencl/runtime/call.h"
#include "opencl/runtime/stopwatch.h"

namespace otg::opencl {
namespace {

void takeReport(const LevelsLane& lane, LevelsReport& report) {
  const Profile& p = lane.profile();
  report.steps = lane.steps();
  report.bytesSent = lane.bytesSent();
  LevelsTimes& t = report.times;
  t.upload = p.ms(Profile::kWrite);
  t.start = p.ms(Profile::kTop);
  t.test = p.ms(Profile::kTest);
  t.scan = p.ms(Profile::kScan);
  t.compaction = p.ms(Profile::kCompact);
  t.split = p.ms(Profile::kSplit);
  t.spawn = p.ms(Profile::kSpawn);
  t.near = p.ms(Profile::kNear);
  t.contacts = p.ms(Profile::kContacts);
  t.regions = p.ms(Profile::kRegions);
  t.choose = p.ms(Profile::kSelect) + p.ms(Profile::kChoose);
  t.readBack = p.ms(Profile::kReadBack);
}

/// What the traversal counts: it tests every pair of leaves, and each has one pair of triangles.
void takeStepCounts(const std::vector<LevelsStep>& steps, CollideStats& stats) {
  stats.boxTests = stats.candidatePairs = 0;
  for (const LevelsStep& step : steps) {
    stats.boxTests += step.tests;
    stats.candidatePairs += step.leafPairs;
  }
}

}  // namespace

bool PublishedDesign::collideByLevels(const Query& query, Workspace& workspace, const LevelsOptions& how,
                                      LevelsReport* report, bool profile) {
  const Stopwatch total(profile);
  const bool contacts = isPairwise(query);
  const PairFrame frame = makePairFrame(query);
  ++counters_.queries;
  if (report) *report = {};
  if (isRefused(query) || isIdleQuery(query, frame)) {
    otg::collide(query, workspace);
    return true;
  }
  try {
    HostRest rest = HostRest::kNothing;
    LevelsReport found;
    (profile ? levels().profiled : levels().lanes).with([&](LevelsLane& lane) {
      const PairAnswer answer = lane.run(query, frame, contacts, how);
      const Stopwatch host(profile);
      rest = takeAnswer(query, frame, answer, contacts, workspace).rest;
      takeReport(lane, found);
      takeStepCounts(found.steps, workspace.stats);
      found.times.host = host.ms();
    });
    const Stopwatch reduction(profile);
    finishAnswer(query, rest, workspace);
    found.times.reduction = reduction.ms();
    found.times.total = total.ms();
    if (report) *report = std::move(found);
    return true;
  } catch (const ClError& error) {
    logError(error);
  }
  ++counters_.onHost;
  otg::collide(query, workspace);
  return false;
}

bool PublishedDesign::findPairsByLevels(const Query& query, Workspace& workspace, const LevelsOptions& how,
                                        LevelsReport* report) {
  const PairFrame frame = makePairFrame(query);
  ++counters_.queries;
  if (report) *report = {};
  if (isRefused(query) || isIdleQuery(query, frame)) {
    otg::findIntersectingPairs(query, workspace);
    return true;
  }
  try {
    levels().lanes.with([&](LevelsLane& lane) {
      takeAll(query, frame, lane.run(query, frame, false, how).found, false, workspace);
      takeStepCounts(lane.steps(), workspace.stats);
      if (report) takeReport(lane, *report);
    });
    return true;
  } catch (const ClError& error) {
    logError(error);
  }
  ++counters_.onHost;
  otg::findIntersectingPairs(query, workspace);
  return false;
}

bool PublishedDesign::findCandidatesByLevels(const Query& query, Workspace& workspace, const LevelsOptions& how,
                                             LevelsReport* report, bool profile) {
  const Stopwatch total(profile || query.options.timings);
  const PairFrame frame = makePairFrame(query);
  ++counters_.queries;
  if (report) *report = {};
  if (isRefused(query) || isIdleQuery(query, frame)) {
    middlePhase(query, workspace);
    return true;
  }
  try {
    LevelsReport found;
    bool tooMany = false;
    workspace.clear();
    (profile ? levels().profiled : levels().lanes).with([&](LevelsLane& lane) {
      tooMany = !lane.findCandidates(query, frame, how, workspace.candidates);
      takeStepCounts(lane.steps(), workspace.stats);
      takeReport(lane, found);
    });
    found.times.total = total.ms();
    if (query.options.timings) workspace.stats.middleMs = total.ms();
    if (report) *report = std::move(found);
    if (tooMany) middlePhase(query, workspace);  // which says so
    return true;
  } catch (const ClError& error) {
    logError(error);
  }
  ++counters_.onHost;
  middlePhase(query, workspace);
  return false;
}

}  // namespace otg::opencl
