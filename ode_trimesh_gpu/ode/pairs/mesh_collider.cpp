// SPDX-License-Identifier: BSD-3-Clause
// dCollide for two geoms of our class.
#include "ode/pairs/mesh_collider.h"

#include <algorithm>
#include <optional>

#include "base/fork_gate.h"
#include "dispatch/dispatcher.h"
#include "dispatch/threads/workspace_lease.h"
#include "ode/base/status.h"
#include "ode/geom/class_number.h"
#include "ode/pairs/apart_pairs.h"
#include "ode/pairs/kept_pairs.h"
#include "ode/pairs/left_pairs.h"
#include "ode/pairs/pair_callbacks.h"
#include "ode/pairs/prefetched_pairs.h"

namespace otg {

int collideMeshMesh(dGeomID o1, dGeomID o2, int flags, dContactGeom* contact, int skip) noexcept {
  return collideMeshes(o1, o2, flags, {contact, skip});
}

int collideMeshes(dGeomID o1, dGeomID o2, int flags, const ContactArray& to) noexcept {
  const LibraryCall call;
  try {
    MeshSide side1 = meshSideOf(o1);  // first: so two dTriMeshes that are new get their places in the order of geoms
    return collideSides(std::move(side1), meshSideOf(o2), flags, to);
  } catch (...) {  // no memory for the mesh of a dTriMesh
    noteStatus(dGPUTRIMESH_ERROR_MEMORY);
    return 0;
  }
}

int collideSides(MeshSide&& side1, MeshSide&& side2, int flags, const ContactArray& to) noexcept {
  const LibraryCall call;
  if (side1.object == nullptr || side2.object == nullptr) {
    answerProbe();
    return 0;
  }
  int capacity = capacityOf(flags);
  if (to.first == nullptr || capacity == 0) return 0;
  // A skip that makes elements overlap is an error of the caller's; the first element is there in any case.
  if (to.skip < static_cast<int>(sizeof(dContactGeom))) capacity = 1;

  const GeomUse use(side1.object, side2.object);
  if (!use.good()) {
    noteStatus(dGPUTRIMESH_ERROR_BUSY);
    for (GeomObject* object : {side1.object, side2.object}) {
      object->stats.queries.fetch_add(1, std::memory_order_relaxed);
      object->stats.failedQueries.fetch_add(1, std::memory_order_relaxed);
    }
    return 0;
  }
  side1.takeMesh();
  side2.takeMesh();
  if (to.data == nullptr && isLeftToOde(side1, side2)) {
    return collideByOde(side1.geom, side2.geom, (flags & ~0xffff) | capacity, to.first, to.skip);
  }
  const GeomCallbacks callbacks1 = side1.callbacks, callbacks2 = side2.callbacks;
  const bool asks = callbacks1.asked() || callbacks2.asked();
  const auto both = {side1.object, side2.object};
  for (GeomObject* object : both) object->stats.queries.fetch_add(1, std::memory_order_relaxed);
  PairPoses poses{readPose(side1.geom), readPose(side2.geom), false};
  if (comesToNothing(side1, side2, poses)) return 0;
  PairTask task;
  preparePair(std::move(side1), std::move(side2), poses, task);
  if (task.state == PairTask::State::kNothing) return 0;
  if (task.state == PairTask::State::kBadPose) {
    countFailure(task, dGPUTRIMESH_ERROR_POSE);
    return 0;
  }
  try {
    SolidHistory history;
    if (needsHistory(task)) recallPair(task, history);
    turnInward(task);
    task.job.any = isUnimportant(flags) && !task.isJoined();
    PrefetchedPairs* const ready = task.younger().prefetched.get();
    if (!task.job.any && !asks && ready != nullptr && !ready->empty()) {
      PairResult result;
      if (ready->find(task, capacity, result)) {
        const std::uint64_t stamp = rememberPair(task, !result.contacts.empty());
        ready->seen(task, stamp);
        if (!result.onDevice && !result.deviceFailed) {
          task.job.query.options.maxContacts = std::min(task.job.query.options.maxContacts, capacity);
          noteComputed(task, stamp, result.contacts, result.counts);
        }
        writeContacts(task, result.contacts, to);
        countPair(task, result.counts, result.contacts.size(), result.onDevice, result.deviceFailed);
        for (GeomObject* object : both) {
          object->stats.prefetched.fetch_add(1, std::memory_order_relaxed);
        }
        return static_cast<int>(result.contacts.size());
      }
    }
    CollideOptions& options = task.job.query.options;
    options.maxContacts = std::min(options.maxContacts, capacity);
    std::optional<PairCallbacks> callbacks;
    if (asks) task.job.filter = &callbacks.emplace(task, callbacks1, callbacks2);
    const WorkspaceLease lease;
    Workspace& workspace = *lease;
    Dispatcher::Ran ran;
    PairCounts counts;
    const bool isKnown = findKept(task, workspace.reduced, counts);
    const std::span<const Contact> all = isKnown ? workspace.reduced : dispatcher().collide(task.job, workspace, ran);
    if (!isKnown) counts = PairCounts(workspace.stats);
    std::span<const Contact> contacts = all;
    std::vector<Contact> own;
    if (task.isJoined()) {
      own.assign(all.begin(), all.end());
      keepOwnContacts(task, own);
      contacts = own;
    }
    const std::uint64_t stamp = rememberPair(task, !contacts.empty());
    if (isKnown) {
      foundKept(task, task.stamp, stamp);
    } else if (!ran.onDevice && !ran.deviceFailed) {
      noteComputed(task, stamp, all, counts);
    }
    writeContacts(task, contacts, to);
    countPair(task, counts, contacts.size(), ran.onDevice, ran.deviceFailed);
    return static_cast<int>(contacts.size());
  } catch (...) {
    // Only want of memory throws: the query's pose is made of two that were found rigid. ODE's space would stay locked
    // for ever if we let it through.
    countFailure(task, dGPUTRIMESH_ERROR_MEMORY);
    return 0;
  }
}

}  // namespace otg
