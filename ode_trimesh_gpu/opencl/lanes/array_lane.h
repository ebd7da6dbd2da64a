// SPDX-License-Identifier: BSD-3-Clause
// Arrays of points or of rays against one mesh on the device.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "opencl/array_types.h"
#include "opencl/lanes/word_array.h"
#include "opencl/tuning.h"

namespace otg::opencl {

/// What is found of points: words of shared/layout/point_layout.h.
class PointKernels {
 public:
  using Item = Vec3d;
  using Request = PointRequest;
  using Array = WordArray<otg_point_double>;
  /// Throws ClError.
  void build(Context& context, const Tuning& tuning);
  void run(Array& array, const CollisionMesh& mesh, const PointRequest& request);

 private:
  KernelFor<given::NearestPoints> nearest_;
  KernelFor<given::InsidePoints> inside_;
};

/// What is found of rays: words of shared/layout/ray_layout.h.
class RayKernels {
 public:
  using Item = LongRay;
  using Request = RayRequest;
  using Array = WordArray<otg_ray_double>;
  /// Throws ClError.
  void build(Context& context, const Tuning& tuning);
  void run(Array& array, const CollisionMesh& mesh, const RayRequest& request);

 private:
  KernelFor<given::CastRays> cast_;
};

/// One thread at a time. After a ClError the lane is of no further use.
template <class Kernels>
class ArrayLane {
 public:
  using Item = typename Kernels::Item;
  using Request = typename Kernels::Request;

  /// The device has doubles.
  ArrayLane(Context& context, MeshStore& meshes, const Tuning& tuning)
      : array_(context, meshes, tuning.pointGroup, sizeof(Item)) {
    kernels_.build(context, tuning);
  }

  /// Room for so many items in host memory. Throws ClError.
  Item* makeRoom(std::size_t count) { return static_cast<Item*>(array_.makeRoom(count)); }
  /// Sends the items that were written there; does not wait. Throws ClError.
  void begin(const CollisionMesh& mesh, const Request& request) {
    array_.send(mesh);
    kernels_.run(array_, mesh, request);
    array_.receive();
  }
  /// Waits for a word for each of them. Throws ClError.
  std::span<const otg_uint> end() { return array_.end(); }
  /// The items that were sent last.
  const Item* items() const { return static_cast<const Item*>(array_.items()); }

  std::uint64_t repeats() const { return 0; }

 private:
  Kernels kernels_;
  typename Kernels::Array array_;  ///< goes first, when what is under way is done
};

using PointLane = ArrayLane<PointKernels>;
using RayLane = ArrayLane<RayKernels>;

}  // namespace otg::opencl
