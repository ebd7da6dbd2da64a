// SPDX-License-Identifier: BSD-3-Clause
// Requests for arrays of points and rays. Free of OpenCL's types.
#pragma once

#include <cstddef>
#include <functional>

#include "collide/mesh_ray.h"
#include "shared/layout/point_layout.h"
#include "shared/layout/ray_layout.h"

namespace otg::opencl {

struct PointRequest {
  bool nearest = false;  ///< the nearest triangle
  bool inside = false;   ///< of a solid: whether the point lies in it
};

struct RayRequest {
  bool cullBack = false;  ///< hits from behind do not count
};

/// Items begin to end - 1 of an array, in the frame of the mesh -> to[0] and up.
template <class Item>
using FillItems = std::function<void(std::size_t begin, std::size_t end, Item* to)>;
/// The same items with a word for each. Both arrays begin with item `begin`.
template <class Item>
using TakeItems = std::function<void(std::size_t begin, std::size_t end, const Item* items, const otg_uint* answers)>;

/// Words of shared/layout/point_layout.h.
using FillPoints = FillItems<Vec3d>;
using TakePoints = TakeItems<Vec3d>;
/// Words of shared/layout/ray_layout.h.
using FillRays = FillItems<LongRay>;
using TakeRays = TakeItems<LongRay>;

}  // namespace otg::opencl
