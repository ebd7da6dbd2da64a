// SPDX-License-Identifier: BSD-3-Clause
#include "ode/pair_batch.h"

#include <algorithm>

#include "dispatch/dispatcher.h"
#include "dispatch/host_batch.h"
#include "dispatch/workspace_lease.h"
#include "ode/pair_callbacks.h"
#include "ode/status.h"
#include "ode/trimesh_override.h"

namespace otg {

bool isPairInOde(dGeomID o1, dGeomID o2) {
  const dBodyID body = dGeomGetBody(o1);
  return o1 != o2 && (body == nullptr || body != dGeomGetBody(o2));
}

PairBatch::PairBatch(std::span<const dGpuTriMeshPair> pairs, int capacity, bool unimportant)
    : tasks_(pairs.size()), results_(pairs.size()) {
  alive_.reserve(4 * pairs.size());
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    if (!isPairInOde(pairs[i].o1, pairs[i].o2)) continue;
    PairTask& task = tasks_[i];
    MeshSide side1 = meshSideOf(pairs[i].o1), side2 = meshSideOf(pairs[i].o2);
    // While it is prepared. After that the batch has shares of the meshes, which nobody changes then.
    const GeomUse use(side1.object, side2.object);
    if (use.good()) {
      side1.takeMesh();
      side2.takeMesh();
      preparePair(std::move(side1), std::move(side2), task);
    } else {
      task.side1 = std::move(side1);
      task.side2 = std::move(side2);
      task.state = PairTask::State::kBusy;
    }
    task.job.any = unimportant;
    if (capacity > 0) {
      CollideOptions& options = task.job.query.options;
      options.maxContacts = std::min(options.maxContacts, capacity);
    }
    for (const MeshSide* side : {&task.side1, &task.side2}) {
      alive_.push_back(side->object->shared_from_this());
      if (task.state == PairTask::State::kReady) alive_.push_back(side->sharedMesh());
    }
    // The program is asked about triangles by its own thread, and now, while the geoms are what they are.
    if (task.state == PairTask::State::kReady && task.asks()) {
      PairCallbacks callbacks(task);
      task.job.filter = &callbacks;
      const WorkspaceLease lease;
      keepOutcome(results_[i], *lease, [&] { return collideOnHost(task.job, *lease); });
      task.job.filter = nullptr;
    }
  }
}

void PairBatch::run() {
  std::vector<const PairJob*> jobs;
  std::vector<std::size_t> which;
  for (std::size_t i = 0; i < tasks_.size(); ++i) {
    if (tasks_[i].state != PairTask::State::kReady || tasks_[i].asks()) continue;
    jobs.push_back(&tasks_[i].job);
    which.push_back(i);
  }
  std::vector<PairResult> results(jobs.size());
  dispatcher().collideBatch(jobs, results);
  for (std::size_t k = 0; k < which.size(); ++k) results_[which[k]] = std::move(results[k]);
}

std::size_t PairBatch::contactCount() const {
  std::size_t count = 0;
  for (const PairResult& result : results_) count += result.contacts.size();
  return count;
}

void PairBatch::remember() {
  for (std::size_t i = 0; i < tasks_.size(); ++i) {
    const PairTask& task = tasks_[i];
    if (task.side1.object == nullptr) continue;  // never a pair
    for (GeomObject* object : {task.side1.object, task.side2.object}) {
      object->stats.queries.fetch_add(1, std::memory_order_relaxed);
    }
    const PairResult& result = results_[i];
    if (task.side1.ownObject != nullptr && task.side2.ownObject != nullptr) countTrimesh(result.contacts.size());
    if (task.state == PairTask::State::kNothing) continue;
    if (task.state == PairTask::State::kBusy) {
      countFailure(task, dGPUTRIMESH_ERROR_BUSY);
    } else if (task.state == PairTask::State::kBadPose || result.outcome == PairResult::Outcome::kRefused) {
      countFailure(task, dGPUTRIMESH_ERROR_POSE);
    } else if (result.outcome == PairResult::Outcome::kNoMemory) {
      countFailure(task, dGPUTRIMESH_ERROR_MEMORY);
    } else {
      rememberPair(task, !result.contacts.empty());
      countPair(task, result.counts, result.contacts.size(), result.onDevice, result.deviceFailed);
    }
  }
}

}  // namespace otg
