// SPDX-License-Identifier: BSD-3-Clause
// One phase of a query on the device.
#include <algorithm>
#include <chrono>

#include "collide/stages.h"
#include "opencl/lanes/host_cases.h"
#include "opencl/published/published_design.h"
#include "opencl/results/take_records.h"
#include "opencl/runtime/call.h"

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
    phases_.with(
        [&](PhaseLane& lane) { lane.findCandidates(query, frame, workspace.candidates, workspace.stats.boxTests); });
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

bool PublishedDesign::decideCandidates(const Query& query, Workspace& workspace) {
  const PairFrame frame = makePairFrame(query);
  ++counters_.queries;
  if (isRefused(query) || isIdleQuery(query, frame)) {
    nearPhase(query, workspace);
    return true;
  }
  try {
    const Clock::time_point start = Clock::now();
    phases_.with([&](PhaseLane& lane) {
      const std::span<const otg_pair_record> records = lane.decide(query, frame, soupPlaces_, workspace.candidates);
      CollideStats byHost;
      workspace.intersecting.clear();
      for (const otg_pair_record& record : records) {
        workspace.stats.decidedByDouble += record.pair;
        if (record.kind == OTG_RECORD_APART) continue;
        const TrianglePair pair{record.a, record.b};
        if (record.kind == OTG_RECORD_OPEN && !decidePair(query, frame, pair, byHost)) continue;
        workspace.intersecting.push_back(pair);
      }
      workspace.stats.decidedExactly = byHost.decidedExactly;
    });
    std::sort(workspace.intersecting.begin(), workspace.intersecting.end());
    workspace.stats.intersectingPairs = workspace.intersecting.size();
    if (query.options.timings) workspace.stats.nearMs = msSince(start);
    return true;
  } catch (const ClError& error) {
    logError(error);
  }
  ++counters_.onHost;
  nearPhase(query, workspace);
  return false;
}

}  // namespace otg::opencl
