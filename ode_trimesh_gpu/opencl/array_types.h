// SPDX-License-Identifier: BSD-3-Clause
// What arrays of points and rays are asked with. Free of OpenCL's types.
#pragma once

#include <cstddef>
#include <functional>

#include "collide/mesh_ray.h"
#include "shared/layout/point_layout.h"
#include "shared/layout/ray_layout.h"

namespace otg::opencl {

struct PointWish {
  bool nearest = false;  ///< the nearest triangle
  bool inside = false;   ///< of a solid: whether the point lies in it
};

/// Points begin to end - 1 of an array, in the frame of the mesh -> to[0] and up.
using FillPoints = std::function<void(std::size_t begin, std::size_t end, Vec3d* to)>;
/// The same points with a word for each: shared/layout/point_layout.h. Both arrays begin with point `begin`.
using TakePoints =
    std::function<void(std::size_t begin, std::size_t end, const Vec3d* points, const otg_uint* answers)>;
/// The same two of rays, in the frame of the mesh; words of shared/layout/ray_layout.h.
using FillRays = std::function<void(std::size_t begin, std::size_t end, LongRay* to)>;
using TakeRays = std::function<void(std::size_t begin, std::size_t end, const LongRay* rays, const otg_uint* answers)>;

}  // namespace otg::opencl
