// SPDX-License-Identifier: BSD-3-Clause
#include "queries/triangle_distance.h"

#include "base/vectors.h"
#include "queries/closest_point.h"

namespace otg {

PointPair closestOnSegments(const Vec3d& p1, const Vec3d& q1, const Vec3d& p2, const Vec3d& q2) {
  return otgNearestOnSegments(p1, q1, p2, q2);
}

Vec3d commonPoint(const Vec3d a[3], const Vec3d b[3]) {
  // Where an edge goes through the other's plane inside of it, the two are nearest; coplanar triangles have a corner in
  // the other one or two edges that cross, which the general case finds.
  PointPair best = closestOnTriangles(a, b);
  for (int side = 0; side < 2; ++side) {
    const Vec3d* const edges = side == 0 ? a : b;
    const Vec3d* const face = side == 0 ? b : a;
    const Vec3d n = otgCross(face[1] - face[0], face[2] - face[0]);
    for (int k = 0; k < 3; ++k) {
      const Vec3d &p = edges[k], &q = edges[(k + 1) % 3];
      const double hp = otgDot(n, p - face[0]), hq = otgDot(n, q - face[0]);
      if (!(hp * hq < 0)) continue;
      const Vec3d x = p + (q - p) * (hp / (hp - hq));
      const SurfacePoint on = closestOnTriangle(face, x);
      if (on.distance * on.distance < best.distance2) best = {x, on.point, on.distance * on.distance};
    }
  }
  return best.a;
}

PointPair closestOnTriangles(const Vec3d a[3], const Vec3d b[3]) {
  return otgNearestOnTriangles(a[0], a[1], a[2], b[0], b[1], b[2]);
}

}  // namespace otg
