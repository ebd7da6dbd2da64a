// SPDX-License-Identifier: BSD-3-Clause
// Arrays of points against one mesh on the device.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "opencl/backend.h"
#include "opencl/launch.h"
#include "opencl/mesh_store.h"
#include "opencl/pinned_buffer.h"
#include "opencl/tuning.h"

namespace otg::opencl {

/// One thread at a time. After a ClError the lane is of no further use.
class PointLane {
 public:
  /// The device has doubles.
  PointLane(Context& context, MeshStore& meshes, const Tuning& tuning);
  ~PointLane() { wait(); }
  PointLane(const PointLane&) = delete;
  PointLane& operator=(const PointLane&) = delete;

  /// Room for so many points in the host's memory. Throws ClError.
  std::span<Vec3d> makeRoom(std::size_t count);
  /// Sends the points that were written there; does not wait. Throws ClError.
  void begin(const CollisionMesh& mesh, PointWish wish);
  /// Waits for a word for each of them (shared/point_layout.h). Throws ClError.
  std::span<const otg_uint> end();
  /// The points that were sent last.
  std::span<const Vec3d> points() const { return {reinterpret_cast<const Vec3d*>(sent_.data()), count_}; }

  std::uint64_t repeats() const { return 0; }

 private:
  void wait() noexcept;
  Context& context_;
  MeshStore& meshes_;
  const std::size_t group_;
  QueueHandle queue_;
  Kernel nearest_, inside_;
  DeviceList points_{sizeof(Vec3d)}, answers_{sizeof(otg_uint)};
  PinnedBuffer sent_, received_;
  MeshStore::Pinned mesh_;
  std::size_t count_ = 0;
  bool underWay_ = false;
};

}  // namespace otg::opencl
