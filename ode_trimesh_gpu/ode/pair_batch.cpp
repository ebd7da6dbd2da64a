// SPDX-License-Identifier: BSD-3-Clause
#include "ode/pair_batch.h"

#include <algorithm>
#include <atomic>
#include <numeric>

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

namespace {

/// Of what collided pairs leave with their geoms so many are written at once.
constexpr std::size_t kOwners = 64;

/// Returns a status: why there are no contacts, which is not counted yet.
int rememberOne(const PairTask& task, const PairResult& result) {
  if (task.side1.object == nullptr) return dGPUTRIMESH_OK;  // never a pair
  for (GeomObject* object : {task.side1.object, task.side2.object}) {
    object->stats.queries.fetch_add(1, std::memory_order_relaxed);
  }
  if (task.side1.ownObject != nullptr && task.side2.ownObject != nullptr) countTrimesh(result.contacts.size());
  if (task.state == PairTask::State::kNothing) return dGPUTRIMESH_OK;
  if (task.state == PairTask::State::kBusy) return dGPUTRIMESH_ERROR_BUSY;
  if (task.state == PairTask::State::kBadPose || result.outcome == PairResult::Outcome::kRefused) {
    return dGPUTRIMESH_ERROR_POSE;
  }
  if (result.outcome == PairResult::Outcome::kNoMemory) return dGPUTRIMESH_ERROR_MEMORY;
  rememberPair(task, !result.contacts.empty());
  countPair(task, result.counts, result.contacts.size(), result.onDevice, result.deviceFailed);
  return dGPUTRIMESH_OK;
}

}  // namespace

PairBatch::PairBatch(std::span<const dGpuTriMeshPair> pairs, int capacity, bool unimportant)
    : count_(pairs.size()),
      blocks_((pairs.size() + kBlock - 1) / kBlock),
      kinds_(pairs.size(), Kind::kNone),
      owners_(pairs.size(), 0) {
  forParts([&](std::size_t begin, std::size_t end) {
    blocks_[begin / kBlock] = std::make_unique<Block>();
    for (std::size_t i = begin; i < end; ++i) kinds_[i] = read(i, pairs[i], capacity, unimportant, false);
  });
  // The program is asked about triangles by its own thread, and now, while the geoms are what they are.
  for (std::size_t i = 0; i < count_; ++i) {
    if (kinds_[i] == Kind::kLater) kinds_[i] = read(i, pairs[i], capacity, unimportant, true);
  }
}

PairBatch::~PairBatch() {
  try {
    forParts([&](std::size_t begin, std::size_t) { blocks_[begin / kBlock].reset(); });
  } catch (...) {  // what is left goes with the object
  }
}

void PairBatch::forParts(const ThreadPool::Work& work) const {
  dispatcher().run(count_, kBlock, work);
}

void PairBatch::Block::hold(const MeshSide& side) {
  const auto isHeld = [&](const auto& mesh) { return mesh.get() == side.mesh; };
  if (std::none_of(meshes.begin(), meshes.end(), isHeld)) meshes.push_back(side.sharedMesh());
}

PairBatch::Kind PairBatch::read(std::size_t i, const dGpuTriMeshPair& pair, int capacity, bool unimportant,
                                bool mayAsk) {
  if (!isPairInOde(pair.o1, pair.o2)) return Kind::kNone;
  // A dTriMesh that is new gets its place in the order of geoms: by the order of the pairs.
  if (!mayAsk && (objectOf(pair.o1) == nullptr || objectOf(pair.o2) == nullptr)) return Kind::kLater;
  MeshSide side1 = meshSideOf(pair.o1), side2 = meshSideOf(pair.o2);
  if (!mayAsk && (side1.callbacks.asked() || side2.callbacks.asked())) return Kind::kLater;
  PairTask& task = blocks_[i / kBlock]->tasks[i % kBlock];
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
  Block& block = *blocks_[i / kBlock];
  block.objects[2 * (i % kBlock)] = task.side1.object->shared_from_this();
  block.objects[2 * (i % kBlock) + 1] = task.side2.object->shared_from_this();
  if (task.state == PairTask::State::kReady) {
    block.hold(task.side1);
    block.hold(task.side2);
  }
  owners_[i] = static_cast<std::uint8_t>(std::max(task.side1.object->serial, task.side2.object->serial) % kOwners);
  if (task.state != PairTask::State::kReady) return Kind::kNone;
  if (!task.asks()) return Kind::kJob;
  PairCallbacks callbacks(task);
  task.job.filter = &callbacks;
  const WorkspaceLease lease;
  keepOutcome(result(i), *lease, [&] { return collideOnHost(task.job, *lease); });
  task.job.filter = nullptr;
  return Kind::kAsks;
}

void PairBatch::run() {
  std::vector<const PairJob*> jobs;
  std::vector<std::size_t> which;
  for (std::size_t i = 0; i < count_; ++i) {
    if (kinds_[i] != Kind::kJob) continue;
    jobs.push_back(&task(i).job);
    which.push_back(i);
  }
  std::vector<PairResult> results(jobs.size());
  dispatcher().collideBatch(jobs, results);
  std::atomic<std::size_t> contacts{0};
  dispatcher().run(which.size(), kBlock, [&](std::size_t begin, std::size_t end) {
    std::size_t sum = 0;
    for (std::size_t k = begin; k < end; ++k) {
      sum += results[k].contacts.size();
      result(which[k]) = std::move(results[k]);
    }
    contacts += sum;
  });
  contactCount_ = contacts;
  for (std::size_t i = 0; i < count_; ++i) {
    if (kinds_[i] == Kind::kAsks) contactCount_ += result(i).contacts.size();
  }
}

void PairBatch::remember() {
  // Pairs of one memory one after the other, in their order, which the stamps in it grow with.
  std::vector<std::size_t> ends(kOwners + 1, 0), order(count_);
  for (const std::uint8_t owner : owners_) ++ends[owner + 1u];
  std::partial_sum(ends.begin(), ends.end(), ends.begin());
  std::vector<std::size_t> next(ends.begin(), ends.end() - 1);
  for (std::size_t i = 0; i < count_; ++i) order[next[owners_[i]]++] = i;
  std::vector<int> failures(count_, dGPUTRIMESH_OK);
  std::atomic<bool> anyFailed{false};
  dispatcher().run(kOwners, 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t k = ends[begin]; k < ends[end]; ++k) {
      const std::size_t i = order[k];
      failures[i] = rememberOne(task(i), result(i));
      if (failures[i] != dGPUTRIMESH_OK) anyFailed = true;
    }
  });
  if (!anyFailed) return;
  for (std::size_t i = 0; i < count_; ++i) {  // the last error is this thread's
    if (failures[i] != dGPUTRIMESH_OK) countFailure(task(i), failures[i]);
  }
}

}  // namespace otg
