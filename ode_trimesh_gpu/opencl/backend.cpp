// SPDX-License-Identifier: BSD-3-Clause
// Opening a device, and queries of one pair.
#include "opencl/backend.h"

#include <algorithm>

#include "collide/convex/convex_pair_contacts.h"
#include "collide/shell/shell_roles.h"
#include "collide/stages.h"
#include "opencl/backend_state.h"
#include "opencl/lanes/host_cases.h"
#include "opencl/lanes/take_answer.h"
#include "opencl/lanes/take_times.h"
#include "opencl/results/take_records.h"
#include "opencl/runtime/stop.h"
#include "opencl/runtime/stopwatch.h"

namespace otg::opencl {
Backend::Backend(std::unique_ptr<BackendState> state) : state_(std::move(state)) {}
Backend::~Backend() = default;

std::shared_ptr<Backend> Backend::open(int index, const Tuning& tuning) {
  try {
    const std::vector<FoundDevice> devices = findDevices();
    tellLoaded();
    for (const FoundDevice& device : devices) {
      if (device.info.index != index || !device.info.available) continue;
      return std::shared_ptr<Backend>(new Backend(std::make_unique<BackendState>(device, tuning)));
    }
  } catch (const ClError& error) {
    logError(error);
  }
  return nullptr;
}

const DeviceInfo& Backend::device() const {
  return state_->context.info();
}

bool Backend::collide(const Query& query, Workspace& workspace) {
  StageTimes ignored;
  return collideIn(false, query, workspace, ignored);
}

bool Backend::collideProfiled(const Query& query, Workspace& workspace, StageTimes& times) {
  return collideIn(true, query, workspace, times);
}

bool Backend::collideIn(bool profile, const Query& query, Workspace& workspace, StageTimes& times) {
  ++state_->queries;
  if (isRefused(query) || isIdleQuery(query, makePairFrame(query)) || isConvexPair(query)) {
    otg::collide(query, workspace);
    return true;
  }
  if (collideSurfacePair(query, workspace)) {
    numberAsCaller(query, workspace);
    return true;
  }
  Query rest = query;
  rest.isOffSurface = true;
  return collideTriangles(profile, rest, workspace, times);
}

bool Backend::collideTriangles(bool profile, const Query& query, Workspace& workspace, StageTimes& times) {
  const Stopwatch total(profile);
  const bool contacts = isPairwise(query);
  const PairRequest request = contacts                                                ? PairRequest::kContacts
                              : query.refiner == nullptr && !areContactsOfHost(query) ? PairRequest::kOverlap
                                                                                      : PairRequest::kPairs;
  const PairFrame frame = makePairFrame(query);
  try {
    HostRest rest = HostRest::kNothing;
    StageTimes t;
    bool tooMany = false;
    (profile ? state_->profiled : state_->pairs).with([&](PairLane& lane) {
      PairAnswer answer = lane.run(query, frame, request);
      tooMany = answer.tooMany;
      if (tooMany) return;
      const Stopwatch host(profile);
      bool done = answer.made && takeMade(query, answer.contactsOfRegions, workspace);
      if (answer.made) ++(done ? state_->contactsMade : state_->contactsLeft);
      if (!done && answer.described && !(answer.made && isApart(*answer.contactsOfRegions.head))) {
        if (answer.made) answer.overlap = lane.description();
        done = takeDescribed(query, answer.overlap, workspace);
      }
      if (done) takeCounts(answer.found, workspace.stats);
      if (answer.asked) ++(done ? state_->described : state_->describedInVain);
      if (done) {
        t.reduction = host.ms();
      } else {
        if (answer.described) answer.found = lane.records(answer.found.counters);
        const Taken taken = takeAnswer(query, frame, answer, contacts, workspace);
        rest = taken.rest;
        state_->leftToHost += answer.left ? 1 : 0;
        state_->decidedOnHost += taken.decidedExactly;
        t.host = host.ms();
      }
      addTimes(t, lane.profile());
    });
    if (tooMany) {
      ++state_->leftToHost;
      otg::collide(query, workspace);
      return true;
    }
    const Stopwatch reduction(profile);
    finishAnswer(query, rest, workspace);
    t.reduction += reduction.ms();
    t.total = total.ms();
    times = t;
    return true;
  } catch (const ClError& error) {
    logError(error);
  }
  ++state_->onHost;
  otg::collide(query, workspace);
  return false;
}

bool Backend::findIntersectingPairs(const Query& query, Workspace& workspace) {
  const PairFrame frame = makePairFrame(query);
  ++state_->queries;
  if (isRefused(query) || isIdleQuery(query, frame)) {
    otg::findIntersectingPairs(query, workspace);
    return true;
  }
  try {
    bool tooMany = false;
    state_->pairs.with([&](PairLane& lane) {
      const PairAnswer answer = lane.run(query, frame, PairRequest::kPairs);
      tooMany = answer.tooMany;
      if (!tooMany) state_->decidedOnHost += takeAll(query, frame, answer.found, false, workspace);
    });
    if (tooMany) {
      ++state_->leftToHost;
      otg::findIntersectingPairs(query, workspace);
    }
    return true;
  } catch (const ClError& error) {
    logError(error);
  }
  ++state_->onHost;
  otg::findIntersectingPairs(query, workspace);
  return false;
}

std::uint64_t Backend::releaseMemory() {
  MemoryBudget& memory = state_->context.memory();
  const std::uint64_t before = memory.held();
  memory.askAll();
  const std::uint64_t after = memory.held();
  return before - std::min(before, after);
}

BackendCounts Backend::counts() const {
  BackendCounts out;
  out.queries = state_->queries;
  out.onHost = state_->onHost;
  out.leftToHost = state_->leftToHost;
  out.decidedOnHost = state_->decidedOnHost;
  out.described = state_->described;
  out.describedInVain = state_->describedInVain;
  out.contactsMade = state_->contactsMade;
  out.contactsLeft = state_->contactsLeft;
  out.points = state_->pointsAsked;
  out.pointsOnHost = state_->pointsOnHost;
  out.rays = state_->raysCast;
  out.raysOnHost = state_->raysOnHost;
  out.distances = state_->distancesAsked;
  out.distancesOnHost = state_->distancesOnHost;
  out.repeats = state_->pairs.repeats() + state_->batches.repeats() + state_->overlaps.repeats();
  const MeshStore::Counts meshes = state_->meshes.counts();
  out.meshUploads = meshes.uploads;
  out.meshUpdates = meshes.updates;
  out.meshBytesSent = meshes.bytesUploaded;
  out.meshEvictions = meshes.evictions;
  out.meshBytes = meshes.bytesUsed;
  addPublishedCounts(out);
  out.memory = state_->context.memory().held();
  const Programs::Counts programs = state_->context.programs().counts();
  out.programsFromSource = programs.fromSource;
  out.programsFromCache = programs.fromCache;
  return out;
}

}  // namespace otg::opencl
