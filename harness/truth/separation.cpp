// SPDX-License-Identifier: BSD-3-Clause
#include "truth/separation.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/vectors.h"

namespace otg::truth {
namespace {

Vec3d unitOrUp(const Vec3d& v) {
  const double l = norm(v);
  return l > 0 ? v * (1 / l) : Vec3d{0, 0, 1};
}
Vec3d column(const Transformd& pose, int k) {
  return {pose.r[k], pose.r[3 + k], pose.r[6 + k]};
}

}  // namespace

Separation boxBox(const Vec3d& halfA, const Vec3d& halfB, const Transformd& bInA) {
  const Vec3d axesA[3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  const Vec3d axesB[3] = {column(bInA, 0), column(bInA, 1), column(bInA, 2)};
  const double a[3] = {halfA.x, halfA.y, halfA.z}, b[3] = {halfB.x, halfB.y, halfB.z};
  Separation best;
  best.depth = std::numeric_limits<double>::infinity();
  const auto offer = [&](const Vec3d& axis) {
    const double size = norm(axis);
    if (size < 1e-9) return;  // parallel edges: the faces' axes say it
    const Vec3d n = axis * (1 / size);
    double reach = 0;
    for (int k = 0; k < 3; ++k) {
      reach += a[k] * std::fabs(otgDot(n, axesA[k])) + b[k] * std::fabs(otgDot(n, axesB[k]));
    }
    const double along = otgDot(n, bInA.t);
    const double depth = reach - std::fabs(along);
    if (depth < best.depth) best = {along > 0 ? n * -1.0 : n, depth};
  };
  for (const Vec3d& u : axesA) offer(u);
  for (const Vec3d& v : axesB) offer(v);
  for (const Vec3d& u : axesA) {
    for (const Vec3d& v : axesB) offer(otgCross(u, v));
  }
  return best;
}

Separation ballAndDistance(double distance, const Vec3d& outward, double radius) {
  return {outward * -1.0, radius - distance};  // A leaves in the direction opposite to the ball's
}

Distance distanceToBall(double radius, const Vec3d& p) {
  return {norm(p) - radius, unitOrUp(p)};
}

Distance distanceToBox(const Vec3d& half, const Vec3d& p) {
  const double h[3] = {half.x, half.y, half.z}, x[3] = {p.x, p.y, p.z};
  double out[3] = {0, 0, 0};
  double squared = 0, nearest = -std::numeric_limits<double>::infinity();
  int face = 0;
  for (int k = 0; k < 3; ++k) {
    const double d = std::fabs(x[k]) - h[k];
    if (d > 0) {
      out[k] = std::copysign(d, x[k]);
      squared += d * d;
    }
    if (d > nearest) {
      nearest = d;
      face = k;
    }
  }
  if (squared > 0) return {std::sqrt(squared), unitOrUp({out[0], out[1], out[2]})};
  Vec3d n{0, 0, 0};
  (face == 0 ? n.x : face == 1 ? n.y : n.z) = std::copysign(1.0, x[face]);
  return {nearest, n};
}

Distance distanceToCylinder(double radius, double halfHeight, const Vec3d& p) {
  const double r = std::hypot(p.x, p.y), side = r - radius, cap = std::fabs(p.z) - halfHeight;
  const Vec3d radial = r > 0 ? Vec3d{p.x / r, p.y / r, 0} : Vec3d{1, 0, 0};
  const Vec3d up{0, 0, std::copysign(1.0, p.z)};
  if (side > 0 && cap > 0) {
    const double d = std::hypot(side, cap);
    return {d, radial * (side / d) + up * (cap / d)};
  }
  return side > cap ? Distance{side, radial} : Distance{cap, up};
}

Distance distanceToTorus(double major, double minor, const Vec3d& p) {
  const double r = std::hypot(p.x, p.y);
  const Vec3d radial = r > 0 ? Vec3d{p.x / r, p.y / r, 0} : Vec3d{1, 0, 0};
  const Vec3d fromRing = p - radial * major;
  return {norm(fromRing) - minor, unitOrUp(fromRing)};
}

double extentDepth(const TriMesh& a, const TriMesh& b, const Transformd& bInA, const Vec3d& direction) {
  const double inf = std::numeric_limits<double>::infinity();
  double lowA = inf, highB = -inf;
  for (const Vec3f& v : a.vertices()) lowA = std::min(lowA, otgDot(direction, Vec3d{v.x, v.y, v.z}));
  for (const Vec3f& v : b.vertices()) {
    highB = std::max(highB, otgDot(direction, otgTransform(bInA, Vec3d{v.x, v.y, v.z})));
  }
  return highB - lowA;
}

}  // namespace otg::truth
