// SPDX-License-Identifier: BSD-3-Clause
// The convex hull of points in space.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "shared/math/vec3.h"

namespace otg {

/// Triangles with their corners counter-clockwise seen from outside; numbers are those of the points. Points within
/// 1e-9 of the hull's size of its surface may be left out. Empty if all points lie in a plane to within that.
///
/// Point by point: the faces that see a new point are replaced by the cone from it to their rim. O(n F).
std::vector<std::array<std::uint32_t, 3>> convexHull(std::span<const Vec3d> points);

}  // namespace otg
