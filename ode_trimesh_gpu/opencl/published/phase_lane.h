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
#include "opencl/runtime/launch.h"
#include "opencl/tuning.h"

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
  void walk(const otg_device_pair& pair, cl_mem meshes, std::vector<TrianglePair>& candidates, std::uint64_t& boxTests);
  void test(const otg_device_pair& pair, const Transformd& bInA, cl_mem meshes, std::size_t count);
  template <class Run>
  void onMeshes(const Query& query, const PairFrame& frame, Run&& run);

  Context& context_;
  MeshStore& meshes_;
  const std::size_t groups_;
  const Tuning tuning_;
  QueueHandle queue_;
  Kernel middle_, near_;
  BufferHandle counters_;
  DeviceList in_{sizeof(cl_uint2)}, out_{sizeof(cl_uint2)}, found_{sizeof(cl_uint2)},
      recordList_{sizeof(otg_pair_record)};
  std::vector<cl_uint2> pairs_;
  std::vector<otg_pair_record> records_;
  std::uint64_t repeats_ = 0;
};

}  // namespace otg::opencl
