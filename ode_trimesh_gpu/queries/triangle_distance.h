// SPDX-License-Identifier: BSD-3-Clause
// The distance of two triangles that do not intersect.
#pragma once

#include "shared/tests/triangle_distance.h"

namespace otg {

using PointPair = NearestPair<double>;

/// The nearest points of two segments, of length zero too. Source: C. Ericson, Real-Time Collision Detection (2005),
/// 5.1.9.
PointPair closestOnSegments(const Vec3d& p1, const Vec3d& q1, const Vec3d& p2, const Vec3d& q2);

/// The nearest points of two triangles that have no point in common: a corner and a triangle, or two edges.
PointPair closestOnTriangles(const Vec3d a[3], const Vec3d b[3]);

/// A point of two triangles that intersect, up to rounding: where an edge of one comes nearest to the other.
Vec3d commonPoint(const Vec3d a[3], const Vec3d b[3]);

}  // namespace otg
