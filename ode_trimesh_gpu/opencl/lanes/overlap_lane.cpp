// SPDX-License-Identifier: BSD-3-Clause
#include "opencl/lanes/overlap_lane.h"

namespace otg::opencl {

OverlapLane::OverlapLane(Context& context, MeshStore&, const Tuning& tuning)
    : queue_(context.makeQueue(tuning.profile)),
      stage_(context, tuning),
      contacts_(context, tuning, true),
      profile_(tuning.profile) {}

OverlapLane::~OverlapLane() {
  if (underWay_) clRelease(OTG_CL(clFinish), queue_.get());  // end() was not reached
}

/// What fails leaves nothing behind: kernels may still be reading meshes that are unpinned in a moment.
template <class Run>
void OverlapLane::guarded(Run&& run) {
  try {
    run();
  } catch (...) {
    clRelease(OTG_CL(clFinish), queue_.get());
    underWay_ = false;
    throw;
  }
}

void OverlapLane::beginRun() {
  stage_.reserve(queue_.get(), batch_);
  stage_.enqueue(queue_.get(), batch_, profile_);
  if (hasContacts()) {
    beginContacts();
  } else {
    stage_.beginHead(queue_.get(), profile_);
  }
}

void OverlapLane::beginContacts() {
  contacts_.enqueue(queue_.get(),
                    {tasks_, batch_.meshes, stage_.pairs(), stage_.results(), stage_.unitRoom(), stage_.tableRoom()},
                    profile_);
  contacts_.beginHead(queue_.get(), profile_);
}

void OverlapLane::begin(const BatchLane& batch, std::span<const otg_listed_overlap> pairs,
                        std::span<const CollisionMesh* const> bodies, std::span<const otg_overlap_task> tasks) {
  batch_ = batch.solids();
  batch_.pairs = pairs;
  batch_.bodies = bodies;
  tasks_ = tasks;
  underWay_ = true;
  guarded([&] { beginRun(); });
}

void OverlapLane::end() {
  guarded([&] {
    if (hasContacts()) {
      for (contacts_.endHead(queue_.get()); !stage_.fits(contacts_.totals()); ++repeats_) {
        beginRun();
        contacts_.endHead(queue_.get());
      }
      for (; contacts_.isIncomplete(); ++repeats_) {
        beginContacts();
        contacts_.endHead(queue_.get());
      }
      contacts_.readRest(queue_.get(), profile_);
    } else {
      for (; !stage_.endHead(queue_.get()); ++repeats_) beginRun();
      stage_.readRest(queue_.get(), profile_);
    }
    if (profile_.on()) profile_.collect();
  });
  underWay_ = false;
}

void OverlapLane::readDescriptions() {
  guarded([&] {
    stage_.beginHead(queue_.get(), profile_);
    stage_.endHead(queue_.get());
    stage_.readRest(queue_.get(), profile_);
    if (profile_.on()) profile_.collect();
  });
}

bool OverlapLane::isDescribed(std::uint32_t pair) const {
  const otg_uint* counts = (hasContacts() ? contacts_.head(pair).state : stage_.head(pair)).counts;
  return counts[OTG_OVERLAP_WHY] == 0 && counts[OTG_OVERLAP_CHORDS] > 0;
}

}  // namespace otg::opencl
