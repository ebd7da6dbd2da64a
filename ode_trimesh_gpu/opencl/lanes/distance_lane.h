// SPDX-License-Identifier: BSD-3-Clause
// The nearest triangles of many pairs of meshes on the device.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "opencl/meshes/mesh_store.h"
#include "opencl/runtime/given.h"
#include "opencl/runtime/pinned_buffer.h"
#include "opencl/tuning.h"
#include "shared/layout/queries_given.h"

namespace otg::opencl {

/// One thread at a time. After a ClError the lane is of no further use.
class DistanceLane {
 public:
  /// The device has doubles.
  DistanceLane(Context& context, MeshStore& meshes, const Tuning& tuning);
  ~DistanceLane();
  DistanceLane(const DistanceLane&) = delete;
  DistanceLane& operator=(const DistanceLane&) = delete;

  /// Memory for so many pairs, to be filled before run(). Throws ClError.
  std::span<otg_distance_task> stage(std::size_t count);
  /// Two words for each of them (shared/layout/distance_layout.h); a view of the lane's memory. Tasks name meshes by
  /// their places in `meshes`; none is empty. `threads` pack meshes that are not there. Throws ClError.
  std::span<const otg_uint> run(std::span<const CollisionMesh* const> meshes, const RunParts& threads);

  std::uint64_t repeats() const { return 0; }

 private:
  Context& context_;
  MeshStore& meshes_;
  const std::size_t group_;
  const Tuning tuning_;
  QueueHandle queue_;
  KernelFor<given::BatchDistance> walk_;
  ListOf<otg_distance_task> tasks_;
  ListOf<otg_device_mesh> places_;
  ListOf<otg_distance_answer> answers_;
  PinnedBuffer staged_, received_;
  std::vector<otg_device_mesh> table_;
  MeshStore::Pinned pinned_;
  std::size_t count_ = 0;
  bool underWay_ = false;
};

}  // namespace otg::opencl
