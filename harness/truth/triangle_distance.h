// SPDX-License-Identifier: BSD-3-Clause
// Distances from triangles in plain double arithmetic, for judges.
#pragma once

#include <array>

#include "shared/math/vec3.h"

namespace otg::truth {

using Corners = std::array<Vec3d, 3>;

double distanceToTriangle(const Vec3d& p, const Corners& triangle);
double distanceOfSegments(const Vec3d& p0, const Vec3d& p1, const Vec3d& q0, const Vec3d& q1);
/// 0 where the segment goes through the triangle.
double distanceToTriangle(const Vec3d& p0, const Vec3d& p1, const Corners& triangle);

}  // namespace otg::truth
