// SPDX-License-Identifier: BSD-3-Clause
#include "queries/triangle_distance.h"

#include <algorithm>

#include "queries/closest_point.h"

namespace otg {

PointPair closestOnSegments(const Vec3d& p1, const Vec3d& q1, const Vec3d& p2, const Vec3d& q2) {
  const Vec3d d1 = otgSub(q1, p1), d2 = otgSub(q2, p2), r = otgSub(p1, p2);
  const double a = otgDot(d1, d1), e = otgDot(d2, d2), f = otgDot(d2, r), c = otgDot(d1, r), b = otgDot(d1, d2);
  double s = 0, t = 0;
  if (a > 0 && e > 0) {
    // |d1 x d2|^2, which a e - b b would lose to cancellation for nearly parallel segments.
    const Vec3d x = otgCross(d1, d2);
    const double denominator = otgDot(x, x);
    if (denominator > 0) s = std::clamp((b * f - c * e) / denominator, 0.0, 1.0);
    t = (b * s + f) / e;
    if (t < 0) {
      t = 0;
      s = std::clamp(-c / a, 0.0, 1.0);
    } else if (t > 1) {
      t = 1;
      s = std::clamp((b - c) / a, 0.0, 1.0);
    }
  } else if (a > 0) {
    s = std::clamp(-c / a, 0.0, 1.0);
  } else if (e > 0) {
    t = std::clamp(f / e, 0.0, 1.0);
  }
  const Vec3d x = otgAdd(p1, otgScale(d1, s)), y = otgAdd(p2, otgScale(d2, t)), d = otgSub(x, y);
  return {x, y, otgDot(d, d)};
}

Vec3d commonPoint(const Vec3d a[3], const Vec3d b[3]) {
  // Where an edge goes through the other's plane inside of it, the two are nearest; coplanar triangles have a corner in
  // the other one or two edges that cross, which the general case finds.
  PointPair best = closestOnTriangles(a, b);
  for (int side = 0; side < 2; ++side) {
    const Vec3d* const edges = side == 0 ? a : b;
    const Vec3d* const face = side == 0 ? b : a;
    const Vec3d n = otgCross(otgSub(face[1], face[0]), otgSub(face[2], face[0]));
    for (int k = 0; k < 3; ++k) {
      const Vec3d &p = edges[k], &q = edges[(k + 1) % 3];
      const double hp = otgDot(n, otgSub(p, face[0])), hq = otgDot(n, otgSub(q, face[0]));
      if (!(hp * hq < 0)) continue;
      const Vec3d x = otgAdd(p, otgScale(otgSub(q, p), hp / (hp - hq)));
      const SurfacePoint on = closestOnTriangle(face, x);
      if (on.distance * on.distance < best.distance2) best = {x, on.point, on.distance * on.distance};
    }
  }
  return best.a;
}

PointPair closestOnTriangles(const Vec3d a[3], const Vec3d b[3]) {
  PointPair best{a[0], b[0], std::numeric_limits<double>::infinity()};
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      const PointPair found = closestOnSegments(a[i], a[(i + 1) % 3], b[j], b[(j + 1) % 3]);
      if (found.distance2 < best.distance2) best = found;
    }
    const SurfacePoint onB = closestOnTriangle(b, a[i]), onA = closestOnTriangle(a, b[i]);
    if (onB.distance * onB.distance < best.distance2) best = {a[i], onB.point, onB.distance * onB.distance};
    if (onA.distance * onA.distance < best.distance2) best = {onA.point, b[i], onA.distance * onA.distance};
  }
  return best;
}

}  // namespace otg
