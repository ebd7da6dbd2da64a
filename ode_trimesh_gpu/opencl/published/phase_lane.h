// SPDX-License-Identifier: BSD-3-Clause
// Queries of which one phase runs on a device and the other one on the host.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <mutex>
#include <vector>

#include "collide/pair_frame.h"
#include "opencl/meshes/mesh_store.h"
#include "opencl/runtime/given.h"
#include "opencl/tuning.h"
#include "shared/layout/published_given.h"

namespace otg::opencl {

/// Where the triangles of meshes that have not moved lie in the soups on the device: the host knows them by number.
/// (Packing a mesh that has moved may give an order other than that of the copy that has followed its moves, which has
/// PackedPlaces.) Any thread.
class SoupPlaces {
 public:
  explicit SoupPlaces(std::uint32_t leafTriangles) : leafTriangles_(leafTriangles) {}
  using Places = std::vector<std::uint32_t>;  ///< by number
  std::shared_ptr<const Places> of(const CollisionMesh& mesh);

 private:
  const std::uint32_t leafTriangles_;
  std::mutex mutex_;
  std::map<std::weak_ptr<const void>, std::shared_ptr<const Places>, std::owner_less<>> places_;
};

/// One thread at a time. After a ClError the lane is of no further use.
class PhaseLane {
 public:
  PhaseLane(Context& context, MeshStore& meshes, const Tuning& tuning);

  /// The middle phase: pairs of triangles in leaves whose boxes overlap, by number, in no certain order. One step down
  /// the trees at a time, with the host in between. `boxTests` counts. Throws ClError.
  void findCandidates(const Query& query, const PairFrame& frame, std::vector<TrianglePair>& candidates,
                      std::uint64_t& boxTests);

  /// The near phase: a record for each of the candidates, in their order. Good until the next call. Throws ClError.
  std::span<const otg_pair_record> decide(const Query& query, const PairFrame& frame, SoupPlaces& places,
                                          std::span<const TrianglePair> candidates);

  /// Times that a list was too short and a step was done again.
  std::uint64_t repeats() const { return repeats_; }

 private:
  using Meshes = BufferOf<const otg_mesh_unit>;
  void walk(const otg_device_pair& pair, Meshes meshes, std::vector<TrianglePair>& candidates, std::uint64_t& boxTests);
  void test(const otg_device_pair& pair, const Transformd& bInA, Meshes meshes, std::size_t count);
  template <class Run>
  void onMeshes(const Query& query, const PairFrame& frame, Run&& run);

  Context& context_;
  MeshStore& meshes_;
  const std::size_t groups_;
  const Tuning tuning_;
  QueueHandle queue_;
  KernelFor<given::MiddleStep> middle_;
  KernelFor<given::NearStep> near_;
  ListOf<otg_step_counter> counters_;
  ListOf<otg_node_pair> in_, out_;
  ListOf<otg_number_pair> found_;
  ListOf<otg_place_pair> asked_;
  ListOf<otg_pair_record> recordList_;
  std::vector<otg_place_pair> pairs_;
  std::vector<otg_pair_record> records_;
  std::uint64_t repeats_ = 0;
};

}  // namespace otg::opencl
