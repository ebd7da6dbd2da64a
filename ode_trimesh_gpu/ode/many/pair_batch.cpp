// SPDX-License-Identifier: BSD-3-Clause
#include "ode/many/pair_batch.h"

#include <ode/ode.h>

#include <algorithm>
#include <atomic>
#include <climits>
#include <numeric>

#include "dispatch/dispatcher.h"
#include "dispatch/host_batch.h"
#include "dispatch/threads/workspace_lease.h"
#include "ode/base/status.h"
#include "ode/geom/geom_part.h"
#include "ode/geom/trimesh_pairs.h"
#include "ode/pairs/kept_pairs.h"
#include "ode/pairs/left_pairs.h"
#include "ode/pairs/pair_callbacks.h"

namespace otg {

bool isPairInOde(dGeomID o1, dGeomID o2) {
  const dBodyID body = dGeomGetBody(o1);
  return o1 != o2 && (body == nullptr || body != dGeomGetBody(o2));
}

int toInt(std::size_t count) {
  return static_cast<int>(std::min<std::size_t>(count, INT_MAX));
}

void rememberInto(PairBatch& batch, const PairArrays& to) {
  const std::size_t step = static_cast<std::size_t>(to.places) * static_cast<std::size_t>(to.skip);
  char* const first = reinterpret_cast<char*>(to.contact);
  batch.remember([&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const std::span<const Contact> contacts = batch.result(i).contacts;
      to.counts[i] = toInt(contacts.size());
      writeContacts(batch.task(i), contacts, {reinterpret_cast<dContactGeom*>(first + i * step), to.skip});
    }
  });
}

namespace {

/// Of what collided pairs leave in memories so many parts are written at once.
constexpr std::size_t kOwners = 64;

/// A status: why there are no contacts.
int statusOf(const PairTask& task, const PairResult& result) {
  switch (task.state) {
    case PairTask::State::kNothing:
      return dGPUTRIMESH_OK;
    case PairTask::State::kBusy:
      return dGPUTRIMESH_ERROR_BUSY;
    case PairTask::State::kBadPose:
      return dGPUTRIMESH_ERROR_POSE;
    case PairTask::State::kReady:
      break;
  }
  switch (result.outcome) {
    case PairResult::Outcome::kRefused:
      return dGPUTRIMESH_ERROR_POSE;
    case PairResult::Outcome::kNoMemory:
      return dGPUTRIMESH_ERROR_MEMORY;
    default:
      return dGPUTRIMESH_OK;
  }
}

bool wasCollided(const PairTask& task, const PairResult& result) {
  return task.state == PairTask::State::kReady && result.outcome == PairResult::Outcome::kDone;
}

/// Into the statistics, but for what countFailure() does. Returns statusOf().
int countOne(const PairTask& task, const PairResult& result) {
  if (task.side1.object == nullptr) return dGPUTRIMESH_OK;  // never a pair
  for (GeomObject* object : {task.side1.object, task.side2.object}) {
    object->stats.queries.fetch_add(1, std::memory_order_relaxed);
  }
  if (task.side1.ownObject != nullptr && task.side2.ownObject != nullptr) countTrimesh(result.contacts.size());
  if (wasCollided(task, result)) {
    countPair(task, result.counts, result.contacts.size(), result.onDevice, result.deviceFailed);
  }
  return statusOf(task, result);
}

}  // namespace

PairBatch::PairBatch(std::span<const dGpuTriMeshPair> pairs, const PairBatchRequest& request)
    : count_(pairs.size()),
      request_(request),
      blocks_((pairs.size() + kBlock - 1) / kBlock),
      kinds_(pairs.size(), Kind::kNone),
      work_(pairs.size()),
      owners_(pairs.size(), kNobody),
      firsts_(blocks_.size() + 1, 0) {
  std::atomic<bool> areMeshes{true}, areAllJobs{true}, anyLater{false};
  forParts([&](std::size_t begin, std::size_t end) {
    const Found found = readPart(begin, pairs.subspan(begin, end - begin));
    if (!found.areMeshes) areMeshes = false;
    if (!found.areAllJobs) areAllJobs = false;
    if (found.anyLater) anyLater = true;
  });
  areMeshes_ = areMeshes;
  if (!areMeshes_) return;
  // The program's callbacks for triangles run on its own thread, and now, while the geoms are what they are.
  for (std::size_t i = 0; anyLater && i < count_; ++i) {
    if (kinds_[i] == Kind::kLater) kinds_[i] = readLater(i, pairs[i]);
  }
  if (!areAllJobs) std::erase_if(work_, [](const PairWork& one) { return one.job == nullptr; });
}

PairBatch::~PairBatch() {
  try {
    forParts([&](std::size_t begin, std::size_t) { blocks_[begin / kBlock].reset(); });
  } catch (...) {  // what is left goes with the object
  }
}

void PairBatch::forParts(const ThreadPool::Work& work) const {
  dispatcher().runShort(count_, kBlock, work);
}

PairBatch::Found PairBatch::readPart(std::size_t begin, std::span<const dGpuTriMeshPair> pairs) {
  static_assert(kBlock <= GeomPart::kMost);
  Found found;
  GeomPart part(pairs, request_.known);
  if (!request_.known) {
    // Geoms of our class, and once they are overridden dTriMeshes: only these are read.
    const bool overridden = isTrimeshOverridden(dTriMeshClass);
    const auto isMesh = [&](const GeomObject* object, dGeomID geom) {
      return object != nullptr || (overridden && geom != nullptr && dGeomGetClass(geom) == dTriMeshClass);
    };
    for (std::size_t k = 0; k < pairs.size() && found.areMeshes; ++k) {
      found.areMeshes = isMesh(part.object1(k), pairs[k].o1) && isMesh(part.object2(k), pairs[k].o2);
    }
    if (!found.areMeshes) return found;
  }
  std::unique_ptr<Block>& made = blocks_[begin / kBlock];
  made = std::make_unique<Block>();
  Block& block = *made;
  constexpr std::size_t kAhead = 4;
  for (std::size_t k = 0; k < kAhead; ++k) part.fetchPoses(k);
  for (std::size_t k = 0; k < pairs.size(); ++k) {
    part.fetchPoses(k + kAhead);
    const auto [o1, o2] = pairs[k];
    PairTask& task = block.tasks[k];
    GeomObject *const object1 = part.object1(k), *const object2 = part.object2(k);
    Kind& kind = kinds_[begin + k];
    if (!isPairInOde(o1, o2)) continue;
    // A dTriMesh that is new gets its place in the order of geoms: by the order of the pairs.
    if (object1 == nullptr || object2 == nullptr || object1->callbacks.asked() || object2->callbacks.asked()) {
      kind = Kind::kLater;
      found.anyLater = true;
      continue;
    }
    MeshGeom side1{o1, object1}, side2{o2, object2};
    // While it is prepared. After that the batch has shares of the meshes, which no one changes then.
    if (part.hold(k)) {
      side1.takeMesh();
      side2.takeMesh();
      preparePair(std::move(side1), std::move(side2), task);
    } else {
      takeBusy(std::move(side1), std::move(side2), task);
    }
    const bool isJob = finishReading(begin + k);
    if (task.state != PairTask::State::kReady) continue;
    // A task has a share of what its geoms are pieces of.
    if (task.side1.join == nullptr) part.share(*object1, task.side1.mesh, block.meshes);
    if (task.side2.join == nullptr) part.share(*object2, task.side2.mesh, block.meshes);
    kind = isJob ? Kind::kJob : Kind::kKept;
  }
  part.letGo();
  for (std::size_t k = 0; k < pairs.size(); ++k) {
    if (kinds_[begin + k] == Kind::kJob) {
      work_[begin + k] = {&block.tasks[k].job, &block.results[k]};
    } else {
      found.areAllJobs = false;
    }
  }
  return found;
}

void PairBatch::takeBusy(MeshGeom&& side1, MeshGeom&& side2, PairTask& task) {
  task.side1 = std::move(side1);
  task.side2 = std::move(side2);
  task.state = PairTask::State::kBusy;
}

bool PairBatch::finishReading(std::size_t i) {
  Block& block = *blocks_[i / kBlock];
  const std::size_t k = i % kBlock;
  PairTask& task = block.tasks[k];
  block.objects[2 * k] = task.side1.object->shared_from_this();
  block.objects[2 * k + 1] = task.side2.object->shared_from_this();
  if (task.state != PairTask::State::kReady) return false;
  if (needsHistory(task)) {
    if (block.histories.empty()) block.histories.reserve(kBlock);
    recallPair(task, block.histories.emplace_back());
  }
  turnInward(task);
  task.job.any = request_.unimportant && !task.isJoined();
  if (request_.capacity > 0) {
    CollideOptions& options = task.job.query.options;
    options.maxContacts = std::min(options.maxContacts, request_.capacity);
  }
  std::vector<Contact> contacts;
  PairResult& result = block.results[k];
  if (!findKept(task, contacts, result.counts)) return true;
  keepContacts(result, contacts);
  return false;
}

PairBatch::Kind PairBatch::readLater(std::size_t i, const dGpuTriMeshPair& pair) {
  Block& block = *blocks_[i / kBlock];
  PairTask& task = block.tasks[i % kBlock];
  MeshSide side1 = meshSideOf(pair.o1), side2 = meshSideOf(pair.o2);
  const GeomCallbacks callbacks1 = side1.callbacks, callbacks2 = side2.callbacks;
  const GeomUse use(side1.object, side2.object);
  bool isLeft = false;
  if (use.good()) {
    side1.takeMesh();
    side2.takeMesh();
    isLeft = isLeftToOde(side1, side2);
    preparePair(std::move(side1), std::move(side2), task);
  } else {
    takeBusy(std::move(side1), std::move(side2), task);
  }
  const bool isJob = finishReading(i);
  if (task.state != PairTask::State::kReady) return Kind::kNone;
  if (isLeft) {
    constexpr int kMost = 64;  // where the caller has no limit, who queries again
    keepContacts(result(i), contactsByOde(task, request_.capacity > 0 ? request_.capacity : kMost));
    return Kind::kAsks;
  }
  for (const MeshGeom* side : {&task.side1, &task.side2}) block.meshes.push_back(side->sharedMesh());
  if (!callbacks1.asked() && !callbacks2.asked()) {
    if (!isJob) return Kind::kKept;
    work_[i] = {&task.job, &result(i)};
    return Kind::kJob;
  }
  PairCallbacks callbacks(task, callbacks1, callbacks2);
  task.job.filter = &callbacks;
  const WorkspaceLease lease;
  keepOutcome(result(i), *lease, [&] { return collideOfMany(task.job, *lease); });
  task.job.filter = nullptr;
  return Kind::kAsks;
}

void PairBatch::run() {
  end_ = dispatcher().collideBatch(work_);
  std::atomic<bool> anyOwner{false};
  forParts([&](std::size_t begin, std::size_t end) {
    std::size_t sum = 0;
    bool any = false;
    for (std::size_t i = begin; i < end; ++i) {
      keepOwnOf(i);
      sum += result(i).contacts.size();
      owners_[i] = ownerOf(i);
      any = any || owners_[i] != kNobody;
    }
    firsts_[begin / kBlock + 1] = sum;
    if (any) anyOwner = true;
  });
  anyOwner_ = anyOwner;
  std::partial_sum(firsts_.begin(), firsts_.end(), firsts_.begin());
}

void PairBatch::keepOwnOf(std::size_t i) {
  PairTask& task = blocks_[i / kBlock]->tasks[i % kBlock];
  if (!task.isJoined()) return;
  std::vector<Contact> own(result(i).contacts.begin(), result(i).contacts.end());
  keepOwnContacts(task, own);
  keepContacts(result(i), own);
}

std::uint8_t PairBatch::ownerOf(std::size_t i) const {
  const PairTask& task = this->task(i);
  if (!wasCollided(task, result(i))) return kNobody;
  const bool changes =
      isKept(i) || (task.remembers ? task.isOutside || task.usedHistory() != nullptr : !task.younger().memory.empty());
  static_assert(kOwners <= kNobody);
  return changes ? static_cast<std::uint8_t>(task.younger().serial % kOwners) : kNobody;
}

void PairBatch::rememberHistories() {
  if (!anyOwner_) return;
  // Pairs of one memory one after the other, in their order, which the stamps in it grow with.
  std::vector<std::size_t> ends(kOwners + 1, 0);
  for (const std::uint8_t owner : owners_) {
    if (owner != kNobody) ++ends[owner + 1u];
  }
  std::partial_sum(ends.begin(), ends.end(), ends.begin());
  std::vector<std::size_t> next(ends.begin(), ends.end() - 1), order(ends.back());
  for (std::size_t i = 0; i < count_; ++i) {
    if (owners_[i] != kNobody) order[next[owners_[i]]++] = i;
  }
  dispatcher().runShort(kOwners, kOwners / 8, [&](std::size_t begin, std::size_t end) {
    for (std::size_t k = ends[begin]; k < ends[end]; ++k) {
      PairTask& task = blocks_[order[k] / kBlock]->tasks[order[k] % kBlock];
      const std::uint64_t before = task.stamp;
      const bool hasContacts = !result(order[k]).contacts.empty();
      // A query without contacts ends what other queries have left meanwhile.
      if (isKept(order[k]) && before == 0 && !task.isOutside && !hasContacts) {
        task.younger().memory.forget(task.older().serial);
      } else {
        task.stamp = rememberPair(task, hasContacts);
      }
      if (isKept(order[k])) foundKept(task, before, task.stamp);
    }
  });
}

void PairBatch::keepResult(std::size_t i) const {
  const PairTask& task = this->task(i);
  const PairResult& result = this->result(i);
  if (kinds_[i] != Kind::kJob || task.isJoined() || !wasCollided(task, result) || result.onDevice ||
      result.deviceFailed)
    return;
  noteComputed(task, task.stamp, result.contacts, result.counts);
}

void PairBatch::count(const ThreadPool::Work& write) {
  std::atomic<bool> anyFailed{false};
  forParts([&](std::size_t begin, std::size_t end) {
    constexpr std::size_t kAhead = 4;
    bool failed = false;
    for (std::size_t i = begin; i < end; ++i) {
      if (i + kAhead < end) fetchStats(task(i + kAhead));
      if (countOne(task(i), result(i)) != dGPUTRIMESH_OK) failed = true;
      keepResult(i);
    }
    if (write) write(begin, end);
    if (failed) anyFailed = true;
    if (write && !failed) blocks_[begin / kBlock].reset();
  });
  if (!anyFailed) return;
  for (std::size_t i = 0; i < count_; ++i) {  // the last error is this thread's
    if (blocks_[i / kBlock] == nullptr) continue;
    if (const int status = statusOf(task(i), result(i)); status != dGPUTRIMESH_OK) countFailure(task(i), status);
  }
}

}  // namespace otg
