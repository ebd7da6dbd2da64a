// SPDX-License-Identifier: BSD-3-Clause
#include "mesh/convex_geometry.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/vectors.h"

namespace otg {
namespace {

/// Along a line p + t d to the far side of |x, y| = radius; the point is inside.
double exitOfCircle(const Vec3d& p, const Vec3d& d, double radius) {
  const double a = d.x * d.x + d.y * d.y;
  if (!(a > 0)) return std::numeric_limits<double>::infinity();
  const double b = p.x * d.x + p.y * d.y, c = p.x * p.x + p.y * p.y - radius * radius;
  return (-b + std::sqrt(std::max(0.0, b * b - a * c))) / a;
}

double exitOfCapsule(const ConvexGeometry& s, const Vec3d& p, const Vec3d& d) {
  const double along = std::clamp(p.z, -s.length, s.length);
  const Vec3d off{p.x, p.y, p.z - along};
  if (otgDot(off, off) > s.radius * s.radius) return -1;
  // Of the cylinder's side and the two balls the one that is left last.
  double most = 0;
  const double side = exitOfCircle(p, d, s.radius), z = p.z + side * d.z;
  if (std::isfinite(side) && std::fabs(z) <= s.length) most = side;
  for (const double end : {-s.length, s.length}) {
    const Vec3d q{p.x, p.y, p.z - end};
    const double b = otgDot(q, d), disc = b * b - (otgDot(q, q) - s.radius * s.radius);
    if (disc >= 0) most = std::max(most, -b + std::sqrt(disc));
  }
  return most;
}

double exitOfFaces(const ConvexGeometry& s, const Vec3d& p, const Vec3d& d) {
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < s.faceNormals.size(); ++i) {
    const double height = s.faceOffsets[i] - otgDot(s.faceNormals[i], p), speed = otgDot(s.faceNormals[i], d);
    if (height < 0) return -1;
    if (speed > 0) least = std::min(least, height / speed);
  }
  return least;
}

}  // namespace

void ConvexGeometry::bound() {
  low = high = vertices.front();
  Vec3d sum{0, 0, 0};
  for (const Vec3d& v : vertices) {
    low = minimum(low, v);
    high = maximum(high, v);
    sum = sum + v;
  }
  middle = sum * (1.0 / static_cast<double>(vertices.size()));
  reach = 0;
  for (const Vec3d& v : vertices) reach = std::max(reach, norm(v - middle));
}

Vec3d ConvexGeometry::support(const Vec3d& d) const {
  switch (kind) {
    case Kind::kBox:
      return {std::copysign(half.x, d.x), std::copysign(half.y, d.y), std::copysign(half.z, d.z)};
    case Kind::kCapsule: {
      const Vec3d n = unit(d);
      return {radius * n.x, radius * n.y, radius * n.z + std::copysign(length, d.z)};
    }
    case Kind::kCylinder: {
      const double across = std::hypot(d.x, d.y);
      const double scale = across > 0 ? radius / across : 0;
      return {scale * d.x, scale * d.y, std::copysign(length, d.z)};
    }
    case Kind::kPolyhedron:
      break;
  }
  const Vec3d* farthest = vertices.data();
  double most = otgDot(*farthest, d);
  for (const Vec3d& v : vertices) {
    const double along = otgDot(v, d);
    if (!(along > most)) continue;
    most = along;
    farthest = &v;
  }
  return *farthest;
}

double ConvexGeometry::exitDistance(const Vec3d& p, const Vec3d& d) const {
  if (kind == Kind::kCapsule) return exitOfCapsule(*this, p, d);
  const double faces = exitOfFaces(*this, p, d);
  if (kind != Kind::kCylinder || faces < 0) return faces;
  if (p.x * p.x + p.y * p.y > radius * radius) return -1;
  return std::min(faces, exitOfCircle(p, d, radius));
}

bool ConvexGeometry::isNearSegment(const Vec3d& from, const Vec3d& to, double slack) const {
  const Vec3d d = to - from;
  double enters = 0, leaves = 1;  // the part of the segment that is inside
  for (std::size_t i = 0; i < faceNormals.size(); ++i) {
    const double height = faceOffsets[i] + slack - otgDot(faceNormals[i], from), speed = otgDot(faceNormals[i], d);
    if (speed > 0) {
      leaves = std::min(leaves, height / speed);
    } else if (speed < 0) {
      enters = std::max(enters, height / speed);
    } else if (height < 0) {
      return false;
    }
  }
  if (enters > leaves || kind != Kind::kCylinder) return enters <= leaves;
  const double a = d.x * d.x + d.y * d.y, b = d.x * from.x + d.y * from.y;
  const double nearest = std::clamp(a > 0 ? -b / a : enters, enters, leaves), farthest = radius + slack;
  const double x = from.x + nearest * d.x, y = from.y + nearest * d.y;
  return x * x + y * y <= farthest * farthest;
}

}  // namespace otg
