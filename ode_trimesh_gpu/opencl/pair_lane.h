// SPDX-License-Identifier: BSD-3-Clause
// What one query at a time needs on a device: a queue, kernels, and the lists between kernels.
#pragma once

#include <cstdint>

#include "collide/pair_frame.h"
#include "opencl/mesh_store.h"
#include "opencl/result_buffer.h"
#include "opencl/tuning.h"

namespace otg::opencl {

/// One thread at a time. After a ClError the lane is of no further use.
class PairLane {
 public:
  PairLane(Context& context, MeshStore& meshes, const Tuning& tuning);
  PairLane(const PairLane&) = delete;
  PairLane& operator=(const PairLane&) = delete;

  /// Middle and near phase of one pair, and its contacts if `contacts` and the device has doubles. The answer is good
  /// until the next call. Throws ClError.
  Answer run(const Query& query, const PairFrame& frame, bool contacts);

  /// Of the last query, if tuning.profile is set.
  const Profile& profile() const { return profile_; }
  /// Times that a list was too short and the query was run again.
  std::uint64_t repeats() const { return repeats_; }

 private:
  Answer runOn(const otg_device_pair& pair, const Transformd& bInA, cl_mem meshes, bool contacts);
  void enqueue(const otg_device_pair& pair, const Transformd& bInA, cl_mem meshes, bool contacts);
  bool makeRoom(const otg_uint* counters);

  Context& context_;
  MeshStore& meshes_;
  const Tuning tuning_;
  const std::size_t groups_;
  QueueHandle queue_;
  KernelHandle cut_, level_, tail_, pairs_, contacts_;
  BufferHandle counters_;
  DeviceList level0_{sizeof(cl_uint2)}, level1_{sizeof(cl_uint2)}, level2_{sizeof(cl_uint2)}, leaves_{sizeof(cl_uint2)},
      hits_{sizeof(cl_uint2)};
  ResultBuffer results_;
  Profile profile_;
  std::uint64_t repeats_ = 0;
};

}  // namespace otg::opencl
