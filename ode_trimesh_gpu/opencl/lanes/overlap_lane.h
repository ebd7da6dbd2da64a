// SPDX-License-Identifier: BSD-3-Clause
// What describing the overlaps of some pairs of a batch at a time needs on a device, and making contacts from that.
#pragma once

#include <cstdint>
#include <span>

#include "opencl/lanes/batch_lane.h"
#include "opencl/solid/large_contacts.h"
#include "opencl/solid/large_stage.h"

namespace otg::opencl {

/// One thread at a time. After a ClError the lane is of no further use.
class OverlapLane {
 public:
  OverlapLane(Context& context, MeshStore& meshes, const Tuning& tuning);
  OverlapLane(const OverlapLane&) = delete;
  OverlapLane& operator=(const OverlapLane&) = delete;
  ~OverlapLane();

  /// Begins with pairs of a batch that has ended and is not let go before end(): `pairs` gives their numbers and their
  /// hits, `bodies` the meshes A and B of each, `tasks` the request for each; none: only to describe them. All have to
  /// stay. Throws ClError.
  void begin(const BatchLane& batch, std::span<const otg_listed_overlap> pairs,
             std::span<const CollisionMesh* const> bodies, std::span<const otg_overlap_task> tasks);
  /// Waits for it. Throws ClError.
  void end();
  /// After that, until the next begin: whether a pair was described; if so, the description.
  bool isDescribed(std::uint32_t pair) const;
  FoundOverlap found(std::uint32_t pair) const { return stage_.found(pair); }
  /// Whether the contacts of large regions were made; if so, those of a pair, and descriptions are there once they are
  /// read. Throws ClError.
  bool hasContacts() const { return !tasks_.empty(); }
  FoundContacts contacts(std::uint32_t pair) const { return contacts_.found(pair); }
  void readDescriptions();

  const Profile& profile() const { return profile_; }
  std::uint64_t repeats() const { return repeats_; }

 private:
  template <class Run>
  void guarded(Run&& run);
  void beginRun();
  void beginContacts();
  QueueHandle queue_;
  LargeStage stage_;
  LargeContacts contacts_;
  LargeStage::Batch batch_{};
  std::span<const otg_overlap_task> tasks_;
  Profile profile_;
  bool underWay_ = false;
  std::uint64_t repeats_ = 0;
};

}  // namespace otg::opencl
