// SPDX-License-Identifier: BSD-3-Clause
#include "dispatch/single_run.h"

#include "collide/shell/shell_roles.h"
#include "collide/solid/solid_contacts.h"
#include "collide/stages.h"

namespace otg {
namespace {

/// Counts a query under way.
class UnderWay {
 public:
  explicit UnderWay(DeviceSlot& slot) : slot_(slot) { slot_.underWay.fetch_add(1, std::memory_order_relaxed); }
  ~UnderWay() { slot_.underWay.fetch_sub(1, std::memory_order_relaxed); }
  UnderWay(const UnderWay&) = delete;
  UnderWay& operator=(const UnderWay&) = delete;

 private:
  DeviceSlot& slot_;
};

/// Whether one call does all of a job, on the device as far as that can.
bool allOnDevice(const PairJob& job) {
  return !job.any && job.filter == nullptr;
}

}  // namespace

Placement settled(Placement place) {
  if (place.middle == Place::kAuto) return {place.near, place.near};
  if (place.near == Place::kAuto) return {place.middle, place.middle};
  return place;
}

bool contactsOnDevice(const PairJob& job) {
  return !job.any && job.filter == nullptr && isPairwise(job.query);
}

bool solidInBatch(const PairJob& job) {
  return !job.any && !isPairwise(job.query) && !mayBeShells(job.query);
}

bool isSoonerOnDevice(const PairJob& job, const CostModel& costs, double work) {
  const auto isSolid = [](const CollisionMesh* mesh) { return mesh->mesh().meshClass() == MeshClass::kSolid; };
  if (solidInBatch(job) && isSolid(job.query.a) && isSolid(job.query.b) && allOnDevice(job) && costs.knowsSolidPair()) {
    return costs.deviceSolid.of(work) < costs.hostCost(true, work);
  }
  return contactsOnDevice(job) ? costs.devicePairwise.of(work) < costs.hostPairwise.of(work)
                               : costs.devicePairs.of(work) < costs.hostPairs.of(work);
}

std::span<const Contact> collideOn(DeviceSlot& slot, const PairJob& job, Workspace& workspace, bool& onDevice,
                                   bool& deviceFailed) {
  Placement place = settled(job.place);
  if (place.middle == Place::kAuto) {
    const Place best = isSoonerOnDevice(job, slot.costs, expectedWork(job.query)) ? Place::kOpencl : Place::kCpu;
    place = {best, best};
  }
  const bool middle = place.middle == Place::kOpencl, near = place.near == Place::kOpencl;
  if ((!middle && !near) || slot.isOff) return collideOnHost(job, workspace);
  const UnderWay underWay(slot);
  opencl::Backend& device = *slot.backend;
  const auto note = [&](bool good) {
    slot.note(1, good);
    (good ? onDevice : deviceFailed) = true;
  };
  if (middle && near && allOnDevice(job)) {  // what only the CPU can do runs there
    note(job.byLevels ? device.collideByLevels(job.query, workspace) : device.collide(job.query, workspace));
    return workspace.reduced;
  }
  if (middle && near) {
    note(job.byLevels ? device.findPairsByLevels(job.query, workspace)
                      : device.findIntersectingPairs(job.query, workspace));
  } else if (middle) {
    note(job.byLevels ? device.findCandidatesByLevels(job.query, workspace)
                      : device.findCandidates(job.query, workspace));
    nearPhase(job.query, workspace);
  } else {
    middlePhase(job.query, workspace);
    if (contactsOnDevice(job)) {
      note(device.collideCandidates(job.query, workspace));
      return workspace.reduced;
    }
    note(device.decideCandidates(job.query, workspace));
  }
  return contactsOnHost(job, workspace);
}

}  // namespace otg
