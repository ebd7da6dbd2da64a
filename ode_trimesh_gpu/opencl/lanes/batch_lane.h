// SPDX-License-Identifier: BSD-3-Clause
// What one batch of pairs at a time needs on a device.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "collide/pair_frame.h"
#include "opencl/meshes/mesh_store.h"
#include "opencl/results/exact_need.h"
#include "opencl/results/reducer.h"
#include "opencl/results/result_buffer.h"
#include "opencl/solid/large_stage.h"
#include "opencl/solid/small_stage.h"
#include "opencl/tuning.h"
#include "shared/layout/pairwise_given.h"

namespace otg::opencl {

/// What is requested of all pairs of a batch.
enum class BatchRequest {
  kAny,       ///< whether they intersect
  kPairs,     ///< records of all pairs of triangles that intersect
  kContacts,  ///< contacts of the model `pairwise`, reduced; needs BatchLane::makesContacts
  kSolid      ///< contacts of the model `solid`, likewise; what the device leaves is to be finished from records
};

/// Views of the lane's memory, good until its next batch. For each pair a word of OTG_PAIR_* flags.
struct BatchFound {
  const otg_uint* counters = nullptr;
  const otg_uint* flags = nullptr;
  /// Contacts, where they are requested. Those of a pair lie side by side; two words a pair say where, and how many.
  struct Contacts {
    const otg_uint* places = nullptr;
    const Contact* contacts = nullptr;
    std::shared_ptr<const void> memory;  ///< keeps them as they are for as long as it is shared
  };
  std::vector<Contacts> contacts;    ///< a pair has its contacts in one of them at most
  std::uint64_t decidedExactly = 0;  ///< pairs of triangles, where contacts of the model `pairwise` are requested
  /// Where pairs remember: the direction of the last deep region of each pair with contacts, or zero. Frame A.
  const Vec3d* directions = nullptr;
};

/// One thread at a time. After a ClError the lane is of no further use.
class BatchLane {
 public:
  BatchLane(Context& context, MeshStore& meshes, const Tuning& tuning);
  BatchLane(const BatchLane&) = delete;
  BatchLane& operator=(const BatchLane&) = delete;
  ~BatchLane();

  /// Memory for so many pairs, to be filled before run().
  std::span<otg_batch_task> stage(std::size_t count);
  /// Frames of the same pairs, which the CPU has to make for a device without doubles (else empty).
  std::span<otg_batch_pair> stageFrames();
  /// The same, for a batch of solids that remember: the direction of each pair's last deep region, or zero. Frame A.
  std::span<Vec3d> stageDirections();
  bool makesContacts() const { return static_cast<bool>(small_); }

  /// Begins with mid and narrow phase of the staged pairs in one submission, and what else is requested. Tasks name
  /// meshes by their places in `meshes` (empty ones too), and reductions. `threads`, if there are any, pack meshes that
  /// are not there. Throws ClError.
  void begin(std::span<const CollisionMesh* const> meshes, std::span<const otg_reduction> reductions,
             BatchRequest request, const RunParts* threads);
  /// The same for a batch of solids of which soonFlags() is to be called before end().
  void beginWithFlags(std::span<const CollisionMesh* const> meshes, std::span<const otg_reduction> reductions,
                      const RunParts* threads);
  /// Waits until the regions of a batch of solids and their ways out are known: the flags of its pairs as they are
  /// then. A pair that is
  /// left to the CPU stays so, unless a list was too short. Throws ClError.
  const otg_uint* soonFlags();
  /// Waits for it; the meshes stay pinned. With OTG_PAIR_TO_HOST but without OTG_PAIR_NO_FRAME a pair has to be
  /// finished from its records. Throws ClError.
  BatchFound end();
  /// All records of the last run. Throws ClError.
  Answer records();
  /// Those of pairs with OTG_PAIR_TO_HOST at least, if none of them has OTG_PAIR_MANY. Throws ClError.
  Answer recordsLeft();
  /// What there is to describe the overlaps of pairs of a batch of solids from, as long as the meshes are pinned.
  LargeStage::Batch solids() const;
  void letGo() { pinned_ = {}; }

  const Profile& profile() const { return profile_; }
  std::uint64_t repeats() const { return repeats_; }

 private:
  void beginRun();
  BatchFound endRun();
  template <class Run>
  void guarded(Run&& run);
  void send(std::span<const CollisionMesh* const> meshes, std::span<const otg_reduction> reductions);
  using Meshes = BufferOf<const otg_mesh_unit>;
  void enqueue(Meshes meshes, BatchRequest request);
  void enqueueWalk(Meshes meshes, bool any);
  void enqueueSolids(Meshes meshes);
  void enqueueReduction(Meshes meshes, BufferOf<const otg_result_byte> records, otg_uint only);
  void runMany(Meshes meshes, BatchFound& found);
  given::BatchHits hitsOf(Meshes meshes, const ChosenBuffer& chosen) const;
  template <class Given>
  void launchRecords(KernelFor<Given>& kernel, const Given& given);
  void enqueueRecords(Meshes meshes);
  void enqueueEntered(Meshes meshes, bool decides);
  std::string decideOptions(bool enter) const;

  Context& context_;
  MeshStore& meshes_;
  const Tuning tuning_;
  const std::size_t groups_;
  QueueHandle queue_;
  KernelFor<given::BatchPrepare> prepare_;
  KernelFor<given::BatchWalk> walk_;
  KernelFor<given::BatchReduce> small_, medium_;
  KernelFor<given::BatchResults> pairs_, records_;
  KernelFor<given::BatchResultsEntered> entered_;
  // In exact arithmetic; not built before they are requested, because they are large.
  KernelFor<given::BatchResults> decided_;
  KernelFor<given::BatchDecide> decide_;
  KernelFor<given::BatchDecideEntered> decideEntered_;
  ExactNeed exact_;
  ListOf<otg_counter> counters_;
  PinnedBuffer staged_;
  std::uint32_t count_ = 0, stackSize_ = 0, smallHits_, mediumHits_;
  std::vector<otg_batch_pair> frames_;
  std::vector<otg_device_mesh> sentPlaces_;
  ListOf<otg_batch_task> tasks_;
  ListOf<otg_batch_pair> pairList_;
  ListOf<otg_ordered_pair> order_;
  ListOf<otg_device_mesh> places_;
  ListOf<otg_listed_pair> list_;
  ListOf<otg_batch_hit> hits_;
  ResultBuffer results_;
  ChosenBuffer chosen_, chosenOfMany_;
  std::uint32_t contactPlaces_;
  std::vector<otg_uint> flagsOfMany_;
  otg_uint countersOfMany_[OTG_COUNTERS] = {};
  Reducer reducer_;
  Profile profile_;
  SmallStage solid_;
  MeshStore::Pinned pinned_;  ///< of the run under way
  BatchRequest request_ = BatchRequest::kAny;
  otg_uint mostPlaces_ = 1;  ///< of its reductions
  bool contactRecords_ = false, hasContacts_ = false, underWay_ = false;
  bool anyPairwise_ = false;  ///< of a batch of solids: some pair may have contacts of the model `pairwise`
  PinnedBuffer flags_;        ///< for soonFlags()
  bool wantsFlags_ = false;
  EventHandle flagged_;
  PinnedBuffer directionsBefore_, directions_;
  bool remembers_ = false;
  std::uint64_t repeats_ = 0;
};

}  // namespace otg::opencl
