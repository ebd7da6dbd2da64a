// SPDX-License-Identifier: BSD-3-Clause
#include "truth/triangle_distance.h"

#include <algorithm>
#include <cmath>

namespace otg::truth {
namespace {

double norm(const Vec3d& v) {
  return std::sqrt(otgDot(v, v));
}

double distanceToSegment(const Vec3d& p, const Vec3d& a, const Vec3d& b) {
  const Vec3d ab = otgSub(b, a);
  const double squared = otgDot(ab, ab);
  const double s = squared > 0 ? std::clamp(otgDot(otgSub(p, a), ab) / squared, 0.0, 1.0) : 0.0;
  return norm(otgSub(p, otgAdd(a, otgScale(ab, s))));
}

/// Whether a point of the triangle's plane lies within its edges.
bool within(const Vec3d& p, const Corners& t, const Vec3d& normal) {
  for (std::size_t k = 0; k < 3; ++k) {
    const Vec3d edge = otgSub(t[(k + 1) % 3], t[k]);
    if (otgDot(otgCross(edge, otgSub(p, t[k])), normal) < 0) return false;
  }
  return true;
}

}  // namespace

double distanceToTriangle(const Vec3d& p, const Corners& t) {
  const Vec3d n = otgCross(otgSub(t[1], t[0]), otgSub(t[2], t[0]));
  const double length = norm(n);
  if (length > 0 && within(p, t, n)) return std::fabs(otgDot(n, otgSub(p, t[0]))) / length;
  return std::min(
      {distanceToSegment(p, t[0], t[1]), distanceToSegment(p, t[1], t[2]), distanceToSegment(p, t[2], t[0])});
}

double distanceOfSegments(const Vec3d& p0, const Vec3d& p1, const Vec3d& q0, const Vec3d& q1) {
  double least = std::min({distanceToSegment(p0, q0, q1), distanceToSegment(p1, q0, q1), distanceToSegment(q0, p0, p1),
                           distanceToSegment(q1, p0, p1)});
  const Vec3d u = otgSub(p1, p0), v = otgSub(q1, q0), w = otgSub(p0, q0);
  const double a = otgDot(u, u), b = otgDot(u, v), c = otgDot(v, v), d = otgDot(u, w), e = otgDot(v, w);
  const double determinant = a * c - b * b;
  if (determinant > 1e-14 * a * c) {
    const double s = (b * e - c * d) / determinant, r = (a * e - b * d) / determinant;
    if (s > 0 && s < 1 && r > 0 && r < 1) {
      least = std::min(least, norm(otgAdd(w, otgSub(otgScale(u, s), otgScale(v, r)))));
    }
  }
  return least;
}

double distanceToTriangle(const Vec3d& p0, const Vec3d& p1, const Corners& t) {
  const Vec3d n = otgCross(otgSub(t[1], t[0]), otgSub(t[2], t[0]));
  const double h0 = otgDot(n, otgSub(p0, t[0])), h1 = otgDot(n, otgSub(p1, t[0]));
  if ((h0 > 0) != (h1 > 0)) {
    const Vec3d through = otgAdd(p0, otgScale(otgSub(p1, p0), h0 / (h0 - h1)));
    if (within(through, t, n)) return 0;
  }
  double least = std::min(distanceToTriangle(p0, t), distanceToTriangle(p1, t));
  for (std::size_t k = 0; k < 3; ++k) least = std::min(least, distanceOfSegments(p0, p1, t[k], t[(k + 1) % 3]));
  return least;
}

}  // namespace otg::truth
