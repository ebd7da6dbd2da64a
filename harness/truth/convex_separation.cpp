// SPDX-License-Identifier: BSD-3-Clause
#include "truth/convex_separation.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "base/vectors.h"

namespace otg::truth {
namespace {

Vec3d axisOf(const ConvexBody& body, int k) {
  return {body.pose.r[k], body.pose.r[3 + k], body.pose.r[6 + k]};
}

/// Directions along which a body may be left by a flat face: its axes, or the normals of its faces.
std::vector<Vec3d> facesOf(const ConvexBody& body) {
  std::vector<Vec3d> faces;
  if (body.kind == ConvexBody::Kind::kPolyhedron) {
    for (const Vec3d& n : body.normals) faces.push_back(otgRotate(body.pose, n));
  } else {
    for (int k = 0; k < 3; ++k) faces.push_back(axisOf(body, k));
  }
  return faces;
}

std::vector<Vec3d> startsFor(const ConvexBody& a, const ConvexBody& b) {
  constexpr int kAround = 100;
  constexpr double kGoldenAngle = 2.399963229728653;
  std::vector<Vec3d> starts;
  for (int i = 0; i < kAround; ++i) {
    const double z = 1 - (2.0 * i + 1) / kAround, across = std::sqrt(1 - z * z);
    starts.push_back({across * std::cos(kGoldenAngle * i), across * std::sin(kGoldenAngle * i), z});
  }
  const std::vector<Vec3d> facesOfA = facesOf(a), facesOfB = facesOf(b);
  for (const double sign : {1.0, -1.0}) {
    for (const auto* faces : {&facesOfA, &facesOfB}) {
      for (const Vec3d& n : *faces) starts.push_back(n * sign);
    }
    for (int i = 0; i < 3; ++i) {
      for (int k = 0; k < 3; ++k) {
        const Vec3d n = otgCross(axisOf(a, i), axisOf(b, k));
        if (norm(n) > 1e-9) starts.push_back(n * (sign / norm(n)));
      }
    }
  }
  return starts;
}

/// Goes down from a direction by steps sideways; each round of steps is turned against the last one, so that none runs
/// along a ridge for ever.
double descend(const ConvexBody& a, const ConvexBody& b, Vec3d& d) {
  double least = separation(a, b, d), twist = 0;
  // NOLINTNEXTLINE(clang-analyzer-security.FloatLoopCounter): shrinks by a factor, the count of rounds is free
  for (double step = 0.1; step > 1e-7; step *= 0.6, twist += 0.3) {
    const Vec3d other = std::fabs(d.x) < 0.8 ? Vec3d{1, 0, 0} : Vec3d{0, 1, 0};
    const Vec3d s = otgCross(d, other), t = otgCross(d, s);
    for (int k = 0; k < 8; ++k) {
      const double angle = twist + k * M_PI / 4;
      const Vec3d moved = d + (s * (step * std::cos(angle)) + t * (step * std::sin(angle)));
      const Vec3d e = moved * (1 / norm(moved));
      const double f = separation(a, b, e);
      if (f < least) {
        least = f;
        d = e;
      }
    }
  }
  return least;
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
      return middle + radius * std::hypot(d.x, d.y) + std::fabs(d.z) * length;
    case Kind::kPolyhedron:
      break;
  }
  double most = -std::numeric_limits<double>::infinity();
  for (const Vec3d& v : vertices) most = std::max(most, otgDot(d, v));
  return middle + most;
}

double separation(const ConvexBody& a, const ConvexBody& b, const Vec3d& d) {
  return a.reach(d) + b.reach(d * -1.0);
}

double leastSeparation(const ConvexBody& a, const ConvexBody& b) {
  double best = std::numeric_limits<double>::infinity();
  for (Vec3d d : startsFor(a, b)) best = std::min(best, descend(a, b, d));
  return best;
}

double roughSeparation(const ConvexBody& a, const ConvexBody& b) {
  double best = std::numeric_limits<double>::infinity();
  for (const Vec3d& d : startsFor(a, b)) best = std::min(best, separation(a, b, d));
  return best;
}

WaysApart waysApart(const ConvexBody& a, const ConvexBody& b, double degrees) {
  WaysApart ways;
  ways.least = ways.other = std::numeric_limits<double>::infinity();
  std::vector<std::pair<double, Vec3d>> found;
  for (Vec3d d : startsFor(a, b)) {
    const double length = descend(a, b, d);
    found.emplace_back(length, d);
    if (length < ways.least) {
      ways.least = length;
      ways.direction = d;
    }
  }
  const double angle = degrees * M_PI / 180, cosine = std::cos(angle), sine = std::sin(angle);
  for (const auto& [length, d] : found) {
    if (otgDot(d, ways.direction) <= cosine) ways.other = std::min(ways.other, length);
  }
  // The least outside of the cone may lie on it.
  const Vec3d& d = ways.direction;
  Vec3d s = otgCross(d, std::fabs(d.x) < 0.8 ? Vec3d{1, 0, 0} : Vec3d{0, 1, 0});
  s = s * (1 / norm(s));
  const Vec3d t = otgCross(d, s);
  constexpr int kAround = 72;
  for (int i = 0; i < kAround; ++i) {
    const double turn = 2 * M_PI * i / kAround;
    const Vec3d side = s * std::cos(turn) + t * std::sin(turn);
    ways.other = std::min(ways.other, separation(a, b, d * cosine + side * sine));
  }
  return ways;
}

}  // namespace otg::truth
