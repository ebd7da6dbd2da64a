// SPDX-License-Identifier: BSD-3-Clause
// What one batch of pairs at a time needs on a device.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "collide/pair_frame.h"
#include "opencl/mesh_store.h"
#include "opencl/result_buffer.h"
#include "opencl/tuning.h"

namespace otg::opencl {

/// One thread at a time. After a ClError the lane is of no further use.
class BatchLane {
 public:
  BatchLane(Context& context, MeshStore& meshes, const Tuning& tuning);

  /// Middle and near phase of all pairs (no mesh empty, every frame finite) in one submission, and their contacts if
  /// `contacts` and the device has doubles. Records name the pair by its place in `queries`. With `anyHit` a pair that
  /// intersects has one record at least, not all. Throws ClError.
  Answer run(std::span<const Query* const> queries, std::span<const PairFrame> frames, bool contacts, bool anyHit);

  std::uint64_t repeats() const { return repeats_; }

 private:
  struct Upload;
  Answer runOn(const Upload& upload, cl_mem meshes, bool contacts, bool anyHit);

  Context& context_;
  MeshStore& meshes_;
  const Tuning tuning_;
  const std::size_t groups_;
  QueueHandle queue_;
  KernelHandle walk_, pairs_, contacts_;
  BufferHandle counters_;
  DeviceList pairList_{sizeof(otg_batch_pair)}, poses_{sizeof(Transformd)}, places_{sizeof(otg_device_mesh)},
      hits_{sizeof(otg_batch_hit)};
  ResultBuffer results_;
  std::uint64_t repeats_ = 0;
};

}  // namespace otg::opencl
