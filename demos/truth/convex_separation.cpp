// SPDX-License-Identifier: BSD-3-Clause
#include "truth/convex_separation.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

namespace otg::truth {
namespace {

double norm(const Vec3d& v) {
  return std::sqrt(otgDot(v, v));
}

Vec3d axisOf(const ConvexBody& body, int k) {
  return {body.pose.r[k], body.pose.r[3 + k], body.pose.r[6 + k]};
}

std::vector<Vec3d> startsFor(const ConvexBody& a, const ConvexBody& b) {
  constexpr int kAround = 100;
  constexpr double kGoldenAngle = 2.399963229728653;
  std::vector<Vec3d> starts;
  for (int i = 0; i < kAround; ++i) {
    const double z = 1 - (2.0 * i + 1) / kAround, across = std::sqrt(1 - z * z);
    starts.push_back({across * std::cos(kGoldenAngle * i), across * std::sin(kGoldenAngle * i), z});
  }
  for (int i = 0; i < 3; ++i) {
    for (const double sign : {1.0, -1.0}) {
      starts.push_back(otgScale(axisOf(a, i), sign));
      starts.push_back(otgScale(axisOf(b, i), sign));
      for (int k = 0; k < 3; ++k) {
        const Vec3d n = otgCross(axisOf(a, i), axisOf(b, k));
        if (norm(n) > 1e-9) starts.push_back(otgScale(n, sign / norm(n)));
      }
    }
  }
  return starts;
}

}  // namespace

double ConvexBody::reach(const Vec3d& direction) const {
  const Vec3d d = otgRotateBack(pose, direction);
  const double middle = otgDot(direction, pose.t);
  switch (kind) {
    case Kind::kSphere:
      return middle + radius;
    case Kind::kBox:
      return middle + std::fabs(d.x) * half.x + std::fabs(d.y) * half.y + std::fabs(d.z) * half.z;
    case Kind::kCapsule:
      return middle + radius + std::fabs(d.z) * length;
    case Kind::kCylinder:
      break;
  }
  return middle + radius * std::hypot(d.x, d.y) + std::fabs(d.z) * length;
}

double separation(const ConvexBody& a, const ConvexBody& b, const Vec3d& d) {
  return a.reach(d) + b.reach(otgScale(d, -1.0));
}

double leastSeparation(const ConvexBody& a, const ConvexBody& b) {
  double best = std::numeric_limits<double>::infinity();
  for (Vec3d d : startsFor(a, b)) {
    double least = separation(a, b, d);
    for (double step = 0.1; step > 1e-7; step *= 0.6) {
      const Vec3d other = std::fabs(d.x) < 0.8 ? Vec3d{1, 0, 0} : Vec3d{0, 1, 0};
      const Vec3d s = otgCross(d, other), t = otgCross(d, s);
      for (int k = 0; k < 8; ++k) {
        const double angle = k * M_PI / 4;
        const Vec3d moved = otgAdd(d, otgAdd(otgScale(s, step * std::cos(angle)), otgScale(t, step * std::sin(angle))));
        const Vec3d e = otgScale(moved, 1 / norm(moved));
        const double f = separation(a, b, e);
        if (f < least) {
          least = f;
          d = e;
        }
      }
    }
    best = std::min(best, least);
  }
  return best;
}

}  // namespace otg::truth
