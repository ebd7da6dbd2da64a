// SPDX-License-Identifier: BSD-3-Clause
#include "opencl/overlap_lane.h"

namespace otg::opencl {

OverlapLane::OverlapLane(Context& context, MeshStore&, const Tuning& tuning)
    : queue_(context.makeQueue(tuning.profile)), stage_(context, tuning), profile_(tuning.profile) {}

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
  stage_.beginHead(queue_.get(), profile_);
}

void OverlapLane::begin(const BatchLane& batch, std::span<const otg_listed_overlap> pairs,
                        std::span<const CollisionMesh* const> bodies) {
  batch_ = batch.solids();
  batch_.pairs = pairs;
  batch_.bodies = bodies;
  underWay_ = true;
  guarded([&] { beginRun(); });
}

void OverlapLane::end() {
  guarded([&] {
    for (; !stage_.endHead(queue_.get()); ++repeats_) beginRun();
    stage_.readRest(queue_.get(), profile_);
    if (profile_.on()) profile_.collect();
  });
  underWay_ = false;
}

bool OverlapLane::isDescribed(std::uint32_t pair) const {
  const otg_uint* counts = stage_.head(pair).counts;
  return counts[OTG_OVERLAP_WHY] == 0 && counts[OTG_OVERLAP_CHORDS] > 0;
}

}  // namespace otg::opencl
