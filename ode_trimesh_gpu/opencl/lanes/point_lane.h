// SPDX-License-Identifier: BSD-3-Clause
// Arrays of points against one mesh on the device.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "opencl/array_types.h"
#include "opencl/lanes/word_array.h"
#include "opencl/tuning.h"

namespace otg::opencl {

/// One thread at a time. After a ClError the lane is of no further use.
class PointLane {
 public:
  /// The device has doubles.
  PointLane(Context& context, MeshStore& meshes, const Tuning& tuning);

  /// Room for so many points in the host's memory. Throws ClError.
  Vec3d* makeRoom(std::size_t count) { return static_cast<Vec3d*>(array_.makeRoom(count)); }
  /// Sends the points that were written there; does not wait. Throws ClError.
  void begin(const CollisionMesh& mesh, PointWish wish);
  /// Waits for a word for each of them (shared/layout/point_layout.h). Throws ClError.
  std::span<const otg_uint> end() { return array_.end(); }
  /// The points that were sent last.
  const Vec3d* items() const { return static_cast<const Vec3d*>(array_.items()); }

  std::uint64_t repeats() const { return 0; }

 private:
  Kernel nearest_, inside_;
  WordArray array_;  ///< goes first, when what is under way is done
};

}  // namespace otg::opencl
