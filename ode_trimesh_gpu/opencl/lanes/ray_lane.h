// SPDX-License-Identifier: BSD-3-Clause
// Arrays of rays against one mesh on the device.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "collide/mesh_ray.h"
#include "opencl/lanes/word_array.h"
#include "opencl/tuning.h"

namespace otg::opencl {

/// One thread at a time. After a ClError the lane is of no further use.
class RayLane {
 public:
  /// The device has doubles.
  RayLane(Context& context, MeshStore& meshes, const Tuning& tuning);

  /// Room for so many rays in the host's memory. Throws ClError.
  LongRay* makeRoom(std::size_t count) { return static_cast<LongRay*>(array_.makeRoom(count)); }
  /// Sends the rays that were written there; does not wait. Throws ClError.
  void begin(const CollisionMesh& mesh, bool cullBack);
  /// Waits for a word for each of them (shared/layout/ray_layout.h). Throws ClError.
  std::span<const otg_uint> end() { return array_.end(); }
  /// The rays that were sent last.
  const LongRay* items() const { return static_cast<const LongRay*>(array_.items()); }

  std::uint64_t repeats() const { return 0; }

 private:
  Kernel cast_;
  WordArray array_;  ///< goes first, when what is under way is done
};

}  // namespace otg::opencl
