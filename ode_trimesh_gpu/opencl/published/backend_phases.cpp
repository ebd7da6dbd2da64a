// SPDX-License-Identifier: BSD-3-Clause
// One phase of a query on the device.
#include <algorithm>
#include <chrono>

#include "collide/stages.h"
#include "opencl/backend.h"
#include "opencl/backend_state.h"

namespace otg::opencl {
namespace {

using Clock = std::chrono::steady_clock;

double msSince(Clock::time_point start) {
  return std::chrono::duration<double, std::milli>(Clock::now() - start).count();
}

}  // namespace

bool Backend::findCandidates(const Query& query, Workspace& workspace) {
  const PairFrame frame = makePairFrame(query);
  ++state_->queries;
  if (isRefused(query) || isIdleQuery(query, frame)) {
    middlePhase(query, workspace);
    return true;
  }
  try {
    const Clock::time_point start = Clock::now();
    workspace.stats = {};
    state_->phases.with(
        [&](PhaseLane& lane) { lane.findCandidates(query, frame, workspace.candidates, workspace.stats.boxTests); });
    workspace.stats.candidatePairs = workspace.candidates.size();
    if (query.options.timings) workspace.stats.middleMs = msSince(start);
    return true;
  } catch (const ClError& error) {
    logError(error);
  }
  ++state_->onHost;
  middlePhase(query, workspace);
  return false;
}

bool Backend::decideCandidates(const Query& query, Workspace& workspace) {
  const PairFrame frame = makePairFrame(query);
  ++state_->queries;
  if (isRefused(query) || isIdleQuery(query, frame)) {
    nearPhase(query, workspace);
    return true;
  }
  try {
    const Clock::time_point start = Clock::now();
    state_->phases.with([&](PhaseLane& lane) {
      const std::span<const otg_pair_record> records =
          lane.decide(query, frame, state_->soupPlaces, workspace.candidates);
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
  ++state_->onHost;
  nearPhase(query, workspace);
  return false;
}

}  // namespace otg::opencl
