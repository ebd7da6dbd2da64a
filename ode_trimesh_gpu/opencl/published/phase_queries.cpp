// SPDX-License-Identifier: BSD-3-Clause
// One phase of a query on the device.
#include <chrono>

#include "collide/stages.h"
#include "opencl/lanes/host_cases.h"
#include "opencl/lanes/take_answer.h"
#include "opencl/published/published_design.h"
#include "opencl/runtime/call.h"
#include "opencl/runtime/stopwatch.h"

namespace otg::opencl {
namespace {

using Clock = std::chrono::steady_clock;

double msSince(Clock::time_point start) {
  return std::chrono::duration<double, std::milli>(Clock::now() - start).count();
}

}  // namespace

bool PublishedDesign::findCandidates(const Query& query, Workspace& workspace) {
  const PairFrame frame = makePairFrame(query);
  ++counters_.queries;
  if (isRefused(query) || isIdleQuery(query, frame)) {
    middlePhase(query, workspace);
    return true;
  }
  try {
    const Clock::time_point start = Clock::now();
    workspace.stats = {};
    bool tooMany = false;
    middle_.with([&](MiddleLane& lane) {
      tooMany = !lane.findCandidates(query, frame, workspace.candidates, workspace.stats.boxTests);
    });
    if (tooMany) {
      middlePhase(query, workspace);  // which says so
      return true;
    }
    workspace.stats.candidatePairs = workspace.candidates.size();
    if (query.options.timings) workspace.stats.middleMs = msSince(start);
    return true;
  } catch (const ClError& error) {
    logError(error);
  }
  ++counters_.onHost;
  middlePhase(query, workspace);
  return false;
}

bool PublishedDesign::decide(const Query& query, Workspace& workspace, NearOrder order, bool contacts, bool profile,
                             NearReport& report) {
  const Stopwatch total(profile);
  const PairFrame frame = makePairFrame(query);
  bool made = false;
  (profile ? near_.profiled : near_.lanes).with([&](NearLane& lane) {
    const Answer answer = lane.run(query, frame, workspace.candidates, order, contacts);
    const Stopwatch host(profile);
    // What the middle phase said stays.
    std::vector<TrianglePair> candidates = std::move(workspace.candidates);
    const CollideStats before = workspace.stats;
    takeAll(query, frame, answer, contacts, workspace);
    workspace.candidates = std::move(candidates);
    workspace.stats.boxTests = before.boxTests;
    workspace.stats.triangleBoxTests = before.triangleBoxTests;
    workspace.stats.candidatePairs = before.candidatePairs;
    workspace.stats.boxTestsPerDepth = before.boxTestsPerDepth;
    workspace.stats.middleMs = before.middleMs;
    made = contacts && answer.hasContacts();
    report = lane.report();
    report.times.host = host.ms();
  });
  report.times.total = total.ms();
  return made;
}

bool PublishedDesign::decideCandidates(const Query& query, Workspace& workspace, NearOrder order) {
  ++counters_.queries;
  if (isRefused(query) || isIdleQuery(query, makePairFrame(query))) {
    nearPhase(query, workspace);
    return true;
  }
  try {
    const Clock::time_point start = Clock::now();
    NearReport report;
    decide(query, workspace, order, false, false, report);
    if (query.options.timings) workspace.stats.nearMs = msSince(start);
    return true;
  } catch (const ClError& error) {
    logError(error);
  }
  ++counters_.onHost;
  nearPhase(query, workspace);
  return false;
}

bool PublishedDesign::collideCandidates(const Query& query, Workspace& workspace, NearOrder order, NearReport* report,
                                        bool profile) {
  ++counters_.queries;
  if (report) *report = {};
  bool good = true;
  const auto onHost = [&] {
    nearPhase(query, workspace);
    collideIntersecting(query, workspace);
  };
  if (isRefused(query) || isIdleQuery(query, makePairFrame(query))) {
    onHost();
  } else {
    try {
      const Clock::time_point start = Clock::now();
      NearReport found;
      const bool made = decide(query, workspace, order, isPairwise(query), profile, found);
      if (query.options.timings) workspace.stats.nearMs = msSince(start);
      if (report) *report = found;
      if (made) {
        reduceContacts(query, workspace);
      } else {
        collideIntersecting(query, workspace);
      }
    } catch (const ClError& error) {
      logError(error);
      ++counters_.onHost;
      good = false;
      onHost();
    }
  }
  numberAsCaller(query, workspace);
  return good;
}

}  // namespace otg::opencl
