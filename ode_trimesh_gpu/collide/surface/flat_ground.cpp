// SPDX-License-Identifier: BSD-3-Clause
#include "collide/surface/flat_ground.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>

#include "bvh/wide_search.h"
#include "collide/surface/near_surface.h"

namespace otg {
namespace {

constexpr double kBoxReach = 2;  ///< of the other mesh's radius: how far the box goes around and below it

/// Axes of a frame whose z is a unit vector.
Transformd frameAlong(const Vec3d& z, const Vec3d& origin) {
  const Vec3d aside = std::fabs(z.x) < 0.6 ? Vec3d{1, 0, 0} : Vec3d{0, 1, 0};
  const Vec3d x = unit(otgCross(aside, z)), y = otgCross(z, x);
  return {{x.x, y.x, z.x, x.y, y.y, z.y, x.z, y.z, z.z}, origin};
}

}  // namespace

bool FlatGround::find(const CollisionMesh& ground, const CollisionMesh& other, const Transformd& toGround,
                      double ahead) {
  const TriMesh& mesh = ground.mesh();
  ground_ = &ground;
  count_ = 0;
  const Vec3d low = asDouble(other.mesh().boundsMin()), high = asDouble(other.mesh().boundsMax());
  box_ = toGround;
  box_.t = otgTransform(toGround, (low + high) * 0.5);
  half_ = (high - low) * 0.5 + Vec3d{ahead, ahead, ahead};
  rounding_ = vertexRounding(mesh);
  radius_ = double{other.mesh().radius()};
  const BoxQuery box(ground, box_, half_);
  const BallQuery ball(ground, otgTransform(toGround, asDouble(other.mesh().center())), radius_ + ahead);
  const auto around = [&](const WideNode& node) {
    const unsigned bits = box(node);
    return bits != 0 ? bits & ball(node) : 0;
  };
  const bool isFlat = searchWide(ground.wide(), around, [&](std::uint32_t t) {
    return mesh.isDegenerate(t) || isBeside(corner(t, 0), corner(t, 1), corner(t, 2)) || add(t);
  });
  if (!isFlat || count_ == 0) return false;
  if (std::any_of(triangles_.data(), triangles_.data() + count_, [&](std::uint32_t t) { return isRim(t); })) {
    return false;
  }
  std::sort(triangles_.data(), triangles_.data() + count_);
  return isThere(radius_ + ahead);
}

/// Whether the plane is covered where it cuts what is around the other mesh: as no edge ends it there, it is so all
/// over, or nowhere. Then the triangles lie beside, and only their boxes do not. One point says which: the first one in
/// the box, from below the middle towards where the way to the box's lowest corner leads through the plane.
bool FlatGround::isThere(double reach) const {
  const double height = otgDot(normal_, box_.t) - offset_;
  const Vec3d down = otgRotateBack(box_, normal_ * -1.0);
  const Vec3d corner{std::copysign(half_.x, down.x), std::copysign(half_.y, down.y), std::copysign(half_.z, down.z)};
  const double depth = otgDot(corner, down);
  if (!(height >= 0) || height > depth) return false;
  const Vec3d below = down * height, aside = corner * (height / depth);
  double in = 0;  // of the way from below to aside
  const auto enter = [&](double from, double to, double half) {
    if (std::fabs(from) > half) in = std::max(in, (from - std::copysign(half, from)) / (from - to));
  };
  enter(below.x, aside.x, half_.x);
  enter(below.y, aside.y, half_.y);
  enter(below.z, aside.z, half_.z);
  const Vec3d first = below + (aside - below) * in;
  return norm(first) <= reach && covers(otgTransform(box_, first));
}

Vec3d FlatGround::corner(std::uint32_t t, std::size_t k) const {
  const TriMesh& mesh = ground_->mesh();
  return asDouble(mesh.vertices()[mesh.triangles()[t].v[k]]);
}

/// Of three points' box in the box's frame.
bool FlatGround::isBeside(const Vec3d& p, const Vec3d& q, const Vec3d& r) const {
  const auto local = [&](const Vec3d& x) { return otgRotateBack(box_, x - box_.t); };
  const Vec3d a = local(p), b = local(q), c = local(r);
  const Vec3d low = minimum(minimum(a, b), c), high = maximum(maximum(a, b), c);
  const Vec3d reach = half_ + Vec3d{rounding_, rounding_, rounding_};
  return low.x > reach.x || low.y > reach.y || low.z > reach.z || high.x < -reach.x || high.y < -reach.y ||
         high.z < -reach.z;
}

bool FlatGround::add(std::uint32_t t) {
  const Vec3d& n = ground_->adjacency().normal[t];
  if (count_ == 0) {
    normal_ = n;
    offset_ = otgDot(n, corner(t, 0));
  }
  if (count_ == kMostTriangles || otgDot(n, normal_) < kFlatEdge) return false;
  for (std::size_t k = 0; k < 3; ++k) {
    if (std::fabs(otgDot(normal_, corner(t, k)) - offset_) > rounding_) return false;
  }
  triangles_[count_++] = t;
  return true;
}

bool FlatGround::isRim(std::uint32_t t) const {
  for (std::uint32_t k = 0; k < 3; ++k) {
    if (ground_->mesh().topology().twin[3 * std::size_t{t} + k] != kNone) continue;
    const Vec3d from = corner(t, k), to = corner(t, (k + 1) % 3);
    if (!isBeside(from, to, to)) return true;
  }
  return false;
}

Transformd FlatGround::makeBox(ConvexGeometry& box) const {
  // As high as the highest vertex: what is above all of them is free.
  double height = offset_;
  for (const std::uint32_t t : std::span(triangles_.data(), count_)) {
    for (std::size_t k = 0; k < 3; ++k) height = std::max(height, otgDot(normal_, corner(t, k)));
  }
  const double side = kBoxReach * radius_;
  box.kind = ConvexGeometry::Kind::kPolyhedron;
  box.vertices.clear();
  box.faceNormals.clear();
  box.faceOffsets.clear();
  for (const double x : {-side, side}) {
    for (const double y : {-side, side}) {
      for (const double z : {-side, side}) box.vertices.push_back({x, y, z});
    }
    const double sign = std::copysign(1.0, x);
    for (const Vec3d& axis : {Vec3d{sign, 0, 0}, Vec3d{0, sign, 0}, Vec3d{0, 0, sign}}) {
      box.faceNormals.push_back(axis);
      box.faceOffsets.push_back(side);
    }
  }
  box.bound();
  return frameAlong(normal_, box_.t + normal_ * (height - otgDot(normal_, box_.t) - side));
}

double FlatGround::beyond(std::uint32_t t, const Vec3d& p) const {
  double out = 0;
  for (std::size_t k = 0; k < 3; ++k) {
    const Vec3d from = corner(t, k), along = unit(corner(t, (k + 1) % 3) - from);
    out = std::max(out, -otgDot(otgCross(along, p - from), normal_));
  }
  return out;
}

bool FlatGround::covers(const Vec3d& p) const {
  return std::any_of(triangles_.data(), triangles_.data() + count_,
                     [&](std::uint32_t t) { return beyond(t, p) <= rounding_; });
}

std::uint32_t FlatGround::triangleBelow(const Vec3d& p) const {
  std::uint32_t nearest = kNone;
  double least = std::numeric_limits<double>::infinity();
  for (const std::uint32_t t : std::span(triangles_.data(), count_)) {
    const double out = beyond(t, p);
    if (out < least) {
      least = out;
      nearest = t;
    }
  }
  return nearest;
}

}  // namespace otg
