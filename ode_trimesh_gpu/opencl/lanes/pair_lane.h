// SPDX-License-Identifier: BSD-3-Clause
// What one query at a time needs on a device: a queue, kernels, and the lists between kernels.
#pragma once

#include <cstdint>
#include <span>

#include "collide/pair_frame.h"
#include "opencl/meshes/mesh_store.h"
#include "opencl/results/exact_need.h"
#include "opencl/results/reducer.h"
#include "opencl/results/result_buffer.h"
#include "opencl/solid/large_contacts.h"
#include "opencl/solid/large_stage.h"
#include "opencl/tuning.h"
#include "shared/layout/pairwise_given.h"

namespace otg::opencl {

/// What a query of one pair found, good until the lane's next one.
struct PairAnswer {
  Answer found;          ///< the counters; the records unless the contacts are reduced
  bool reduced = false;  ///< `contacts` is the result
  bool left = false;     ///< it was to be, but the CPU has to finish the pair
  std::span<const Contact> contacts;
  bool tooMany = false;    ///< more than Tuning::mostHits: nothing else is here, and the CPU has to do all of it
  bool asked = false;      ///< for a description
  bool described = false;  ///< `overlap` is what was requested, and `found` has no records
  FoundOverlap overlap;
  bool made = false;  ///< described, but in place of `overlap` are the contacts of its large regions
  FoundContacts contactsOfRegions;
};

/// What is requested of a pair.
enum class PairRequest {
  kPairs,     ///< the pairs of triangles that intersect
  kContacts,  ///< contacts of the model `pairwise` where the device has doubles, reduced where that can be done there
  kOverlap    ///< where there are many, the description of the overlap; else as kPairs
};

/// One thread at a time. After a ClError the lane is of no further use.
class PairLane {
 public:
  PairLane(Context& context, MeshStore& meshes, const Tuning& tuning);
  PairLane(const PairLane&) = delete;
  PairLane& operator=(const PairLane&) = delete;

  /// Middle and near phase of one pair, and what else is requested. Throws ClError.
  PairAnswer run(const Query& query, const PairFrame& frame, PairRequest request);
  /// After a result with `described`, which has these counters: the records. Throws ClError.
  Answer records(const otg_uint* counters);
  /// After a result with `made`: the description. Throws ClError.
  FoundOverlap description();

  /// Of the last query, if tuning.profile is set.
  const Profile& profile() const { return profile_; }
  /// Times that a list was too short and the query was run again.
  std::uint64_t repeats() const { return repeats_; }

 private:
  using Meshes = BufferOf<const otg_mesh_unit>;
  PairAnswer runOn(const otg_device_pair& pair, const Query& query, Meshes meshes, bool contacts);
  PairAnswer describe(const otg_device_pair& pair, const Query& query, Meshes meshes);
  bool describes(const otg_device_pair& pair) const;
  given::PairHits hitsOf(const otg_device_pair& pair, const Transformd& bInA, Meshes meshes) const;
  void enqueueWalk(const otg_device_pair& pair, Meshes meshes, const otg_reduction& how);
  void enqueueFew(const given::PairHits& found);
  void enqueueRecords(const given::PairHits& found, bool contacts, bool reduce);
  void enqueueContacts(const given::PairHits& found);
  template <class Given>
  void launchRecords(KernelFor<Given>& kernel, const Given& given);
  std::string decideOptions(bool contacts, bool reduce) const;
  bool makeRoom(const otg_uint* counters);
  bool hasTooMany();

  Context& context_;
  MeshStore& meshes_;
  const Tuning tuning_;
  const std::size_t groups_;
  QueueHandle queue_;
  KernelFor<given::PairCut> cut_;
  KernelFor<given::PairLevel> level_;
  KernelFor<given::PairTail> tail_;
  KernelFor<given::PairResults> pairs_, contacts_;
  KernelFor<given::PairResultsEntered> entered_;
  KernelFor<given::PairReduce> few_;
  // In exact arithmetic; not built before they are requested, because they are large.
  KernelFor<given::PairReduce> fewDecided_;
  KernelFor<given::PairDecide> decidePairs_, decideContacts_;
  KernelFor<given::PairDecideEntered> decideEntered_;
  ExactNeed exact_;
  ListOf<otg_counter> counters_;
  ListOf<otg_node_pair> level0_, level1_, level2_;
  ListOf<otg_leaf_pair> leaves_;
  ListOf<otg_hit> hits_;
  ResultBuffer results_;
  ChosenBuffer chosen_;
  Reducer reducer_;
  LargeStage overlap_;
  LargeContacts overlapContacts_;
  Profile profile_;
  std::uint32_t fewHits_ = 0, lastHits_ = 0;
  bool isFresh_ = true;  ///< no query yet that shows how many hits to expect
  std::uint64_t repeats_ = 0;
};

}  // namespace otg::opencl
