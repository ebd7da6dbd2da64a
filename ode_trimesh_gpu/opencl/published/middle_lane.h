// SPDX-License-Identifier: BSD-3-Clause
// The middle phase alone on a device, by the trees of the usual traversal.
#pragma once

#include <cstdint>
#include <vector>

#include "collide/pair_frame.h"
#include "opencl/meshes/mesh_store.h"
#include "opencl/runtime/given.h"
#include "opencl/tuning.h"
#include "shared/layout/published_given.h"

namespace otg::opencl {

/// One thread at a time. After a ClError the lane is of no further use.
class MiddleLane {
 public:
  MiddleLane(Context& context, MeshStore& meshes, const Tuning& tuning);

  /// The middle phase: pairs of triangles in leaves whose boxes overlap, by number, in no certain order. One step down
  /// the trees at a time, with the CPU in between. `boxTests` counts. False where there are more than the query may
  /// have. Throws ClError.
  bool findCandidates(const Query& query, const PairFrame& frame, std::vector<TrianglePair>& candidates,
                      std::uint64_t& boxTests);

  /// Times that a list was too short and a step was done again.
  std::uint64_t repeats() const { return repeats_; }

 private:
  using Meshes = BufferOf<const otg_mesh_unit>;
  bool walk(const otg_device_pair& pair, Meshes meshes, std::size_t most, std::vector<TrianglePair>& candidates,
            std::uint64_t& boxTests);
  template <class Run>
  void onMeshes(const Query& query, const PairFrame& frame, Run&& run);

  Context& context_;
  MeshStore& meshes_;
  const std::size_t groups_;
  const Tuning tuning_;
  QueueHandle queue_;
  KernelFor<given::MiddleStep> middle_;
  ListOf<otg_step_counter> counters_;
  ListOf<otg_node_pair> in_, out_;
  ListOf<otg_number_pair> found_;
  std::uint64_t repeats_ = 0;
};

}  // namespace otg::opencl
