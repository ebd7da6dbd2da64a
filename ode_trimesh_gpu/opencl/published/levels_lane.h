// SPDX-License-Identifier: BSD-3-Clause
// The traversal `levels` (kernels/published/levels_*.cl), one query at a time.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "opencl/lanes/pair_lane.h"
#include "opencl/published/levels.h"
#include "opencl/published/prefix_sum.h"

namespace otg::opencl {

/// One thread at a time. After a ClError the lane is of no further use.
class LevelsLane {
 public:
  /// `meshes`: with the layout kBinary.
  LevelsLane(Context& context, MeshStore& meshes, const Tuning& tuning);
  LevelsLane(const LevelsLane&) = delete;
  LevelsLane& operator=(const LevelsLane&) = delete;

  /// As PairLane::run, but for the counts of box tests and of pairs of triangles, which are in steps(). Throws ClError.
  PairAnswer run(const Query& query, const PairFrame& frame, bool contacts, const LevelsOptions& how);

  /// The mid phase alone: pairs of triangles, by number, in the order of the traversal. False where there are more
  /// than the query may have. Throws ClError.
  bool findCandidates(const Query& query, const PairFrame& frame, const LevelsOptions& how,
                      std::vector<TrianglePair>& candidates);

  /// Of the last query.
  const std::vector<LevelsStep>& steps() const { return steps_; }
  std::uint64_t bytesSent() const { return bytesSent_; }
  const Profile& profile() const { return profile_; }
  /// Times that a list was too short and a step was done again.
  std::uint64_t repeats() const { return repeats_; }

 private:
  /// A mesh as it is sent, kept in host memory between queries: all of it, or its nodes as integers alone.
  struct SentMesh {
    std::weak_ptr<const void> of;
    PackedMesh mesh;
    bool nodesAlone;
  };
  /// Of the mid phase, for one kind of nodes.
  struct WalkKernels {
    KernelFor<given::LevelsTest> test;
    KernelFor<given::LevelsCompact> compact;
    KernelFor<given::LevelsSplit> split;
    KernelFor<given::LevelsSpawn> spawn;
  };
  /// The kernels of the narrow phase for one way of deciding, made when first requested.
  struct FusedKernels {
    KernelFor<given::LevelsNearFused> near;  ///< tests, and makes contacts
    KernelFor<given::LevelsEnd> end;
    KernelFor<given::LevelsEnter> enter;  ///< in place of `end`, if contacts are to be reduced
  };
  struct NearKernels {
    KernelFor<given::LevelsNear> near;
    KernelFor<given::PairResults> records;
    KernelFor<given::PairResultsEntered> entered;  ///< in place of `records`, if contacts are to be reduced
  };
  using Meshes = BufferOf<const otg_mesh_unit>;
  FusedKernels& fusedKernels(bool contacts, bool reduce);
  NearKernels& nearKernels(bool contacts, bool reduce);
  /// Calls use(pair, meshes), with meshes that are there or that are sent.
  template <class Use>
  void onMeshes(const Query& query, const PairFrame& frame, bool sendTrees, bool nodesAlone, Use&& use);
  PairAnswer runOn(const otg_device_pair& pair, const Query& query, Meshes meshes, bool contacts,
                   const LevelsOptions& how);
  const PackedMesh& packed(const CollisionMesh& mesh, int side, bool nodesAlone);
  void send(const Query& query, bool nodesAlone, otg_device_pair& pair);
  void makeWalk(bool nodesAlone);
  void walk(const otg_device_pair& pair, const Query& query, Meshes meshes, const LevelsOptions& how);
  std::uint32_t begin(const Query& query, std::uint32_t startDepth);
  void step(const otg_device_pair& pair, Meshes meshes, std::uint32_t count);
  void distribute(const otg_device_pair& pair, Meshes meshes, std::uint32_t count, LevelsStep& counts);
  PairAnswer decide(const otg_device_pair& pair, const Query& query, Meshes meshes, bool contacts, bool fused);
  void enqueueNear(const otg_device_pair& pair, const Query& query, Meshes meshes, bool contacts, bool reduce);
  void enqueueFused(const otg_device_pair& pair, const Query& query, Meshes meshes, bool contacts, bool reduce);
  void enqueueDecision(const otg_device_pair& pair, const Query& query, Meshes meshes, const otg_reduction& how,
                       bool contacts, bool reduce, bool fused);
  void write(cl_mem to, std::size_t offset, std::size_t bytes, const void* from);
  void growLeaves(std::uint64_t places);

  Context& context_;
  MeshStore& meshes_;
  const Tuning tuning_;
  const std::size_t group_, groups_;
  QueueHandle queue_;
  KernelFor<given::LevelsBegin> begin_;
  WalkKernels walks_[2];         ///< of nodes as floats, of nodes as integers
  WalkKernels* walk_ = nullptr;  ///< one of them: of this query
  PrefixSums prefixSums_ = PrefixSums::kPublished;
  KernelFor<given::LevelsReset> reset_;
  FusedKernels fused_[3];  ///< pairs alone, contacts, contacts to be reduced
  NearKernels near_[3];    ///< the same
  PrefixSum<otg_one_sum> sumOfOne_;
  PrefixSum<otg_two_sums> sumOfTwo_;
  ListOf<otg_counter> counters_;
  ListOf<otg_one_sum> totals_;
  ListOf<otg_start_node> starts_;
  ListOf<otg_node_pair> now_, next_, kept_;
  ListOf<otg_one_sum> overlaps_, places_;
  ListOf<otg_two_sums> weights_, placesOfTwo_;
  ListOf<otg_place_pair> leaves_;
  ListOf<otg_hit> hits_;
  ListOf<MeshUnit> sentUnits_;
  std::unique_ptr<SentMesh> sent_[2];
  std::vector<cl_uint> startNodes_;
  std::vector<LevelsStep> steps_;
  std::uint32_t leafCount_ = 0;
  std::uint64_t bytesSent_ = 0;
  ResultBuffer results_;
  ChosenBuffer chosen_;
  Reducer reducer_;
  Profile profile_;
  std::uint64_t repeats_ = 0;
};

}  // namespace otg::opencl
