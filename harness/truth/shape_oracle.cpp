// SPDX-License-Identifier: BSD-3-Clause
#include "truth/shape_oracle.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

namespace otg::truth {
namespace {

using Polygon = std::vector<Vec3d>;

double norm(const Vec3d& v) {
  return std::sqrt(otgDot(v, v));
}

/// The part where normal . p <= offset.
Polygon cut(const Polygon& in, const Vec3d& normal, double offset) {
  Polygon out;
  for (std::size_t i = 0; i < in.size(); ++i) {
    const Vec3d &p = in[i], &q = in[(i + 1) % in.size()];
    const double hp = otgDot(normal, p) - offset, hq = otgDot(normal, q) - offset;
    if (hp <= 0) out.push_back(p);
    if ((hp < 0 && hq > 0) || (hp > 0 && hq < 0)) out.push_back(otgAdd(p, otgScale(otgSub(q, p), hp / (hp - hq))));
  }
  return out;
}

/// Distance of a convex polygon's projection on z = 0 from the origin.
double distanceFromAxis(Polygon polygon) {
  for (Vec3d& p : polygon) p.z = 0;
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t i = 2; i < polygon.size(); ++i) {
    least = std::min(least, distanceToTriangle({0, 0, 0}, {polygon[0], polygon[i - 1], polygon[i]}));
  }
  return least;
}

}  // namespace

ShapeOracle::ShapeOracle(const PairBody& mesh, const PairBody& shape, double meshMoves, double grain)
    : shape_(*shape.shape), shapePose_(shape.pose), meshMoves_(meshMoves), grain_(grain) {
  const Transformd meshInShape = relativePose(shape.pose, mesh.pose);
  for (const Triangle& t : mesh.mesh.triangles) {
    Corners corners;
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec3f& v = mesh.mesh.vertices[t.v[k]];
      corners[k] = otgTransform(meshInShape, Vec3d{v.x, v.y, v.z});
    }
    triangles_.push_back(corners);
  }
  if (shape_.kind == ConvexBody::Kind::kBox) {
    for (const Vec3d& n : {Vec3d{1, 0, 0}, Vec3d{0, 1, 0}, Vec3d{0, 0, 1}}) {
      shape_.normals.insert(shape_.normals.end(), {n, otgScale(n, -1.0)});
      offsets_.insert(offsets_.end(), 2, otgDot(n, shape_.half));
    }
    bound_ = norm(shape_.half);
  } else if (shape_.kind == ConvexBody::Kind::kPolyhedron) {
    for (const Vec3d& n : shape_.normals) {
      double offset = -std::numeric_limits<double>::infinity();
      for (const Vec3d& v : shape_.vertices) offset = std::max(offset, otgDot(n, v));
      offsets_.push_back(offset);
    }
    for (const Vec3d& v : shape_.vertices) {
      bound_ = std::max(bound_, norm(v));
      middle_ = otgAdd(middle_, otgScale(v, 1.0 / static_cast<double>(shape_.vertices.size())));
    }
  } else {
    bound_ = shape_.radius + shape_.length;
  }
}

bool ShapeOracle::meets(const Corners& t) const {
  switch (shape_.kind) {
    case ConvexBody::Kind::kSphere:
      return distanceToTriangle({0, 0, 0}, t) < shape_.radius - grain_;
    case ConvexBody::Kind::kCapsule:
      return distanceToTriangle({0, 0, -shape_.length}, {0, 0, shape_.length}, t) < shape_.radius - grain_;
    case ConvexBody::Kind::kCylinder: {
      const Polygon part =
          cut(cut({t[0], t[1], t[2]}, {0, 0, 1}, shape_.length - grain_), {0, 0, -1}, shape_.length - grain_);
      return part.size() >= 3 && distanceFromAxis(part) < shape_.radius - grain_;
    }
    default: {
      Polygon part{t[0], t[1], t[2]};
      for (std::size_t i = 0; i < offsets_.size() && !part.empty(); ++i) {
        part = cut(part, shape_.normals[i], offsets_[i] - grain_);
      }
      return !part.empty();
    }
  }
}

bool ShapeOracle::isWithin(const Vec3d& by) const {
  const Vec3d toMiddle = otgSub(by, middle_);
  int layers = 0;
  for (const Corners& t : triangles_) {
    // The upright line through the middle crosses two sides of a triangle, or none. Both triangles at a side see the
    // same crossing.
    std::array<Vec3d, 2> crossing{};
    std::size_t count = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      Vec3d p = otgAdd(t[k], toMiddle), q = otgAdd(t[(k + 1) % 3], toMiddle);
      if ((p.y > 0) == (q.y > 0)) continue;
      if (p.y > 0) std::swap(p, q);
      crossing[count++] = otgAdd(p, otgScale(otgSub(q, p), -p.y / (q.y - p.y)));
    }
    if (count < 2 || (crossing[0].x > 0) == (crossing[1].x > 0)) continue;
    const double share = -crossing[0].x / (crossing[1].x - crossing[0].x);
    if (crossing[0].z + share * (crossing[1].z - crossing[0].z) <= 0) continue;
    const Vec3d u = otgSub(t[1], t[0]), v = otgSub(t[2], t[0]);
    layers += u.x * v.y - u.y * v.x > 0 ? 1 : -1;
  }
  return layers > 0;
}

bool ShapeOracle::overlapped(const Vec3d& translation) {
  const Vec3d by = otgScale(otgRotateBack(shapePose_, translation), meshMoves_);
  const bool meets = std::any_of(triangles_.begin(), triangles_.end(), [&](const Corners& t) {
    Vec3d low = otgAdd(t[0], by), high = low;
    Corners moved;
    for (std::size_t k = 0; k < 3; ++k) {
      moved[k] = otgAdd(t[k], by);
      low = {std::min(low.x, moved[k].x), std::min(low.y, moved[k].y), std::min(low.z, moved[k].z)};
      high = {std::max(high.x, moved[k].x), std::max(high.y, moved[k].y), std::max(high.z, moved[k].z)};
    }
    if (std::max({low.x, low.y, low.z}) > bound_ || std::min({high.x, high.y, high.z}) < -bound_) return false;
    return this->meets(moved);
  });
  return meets || isWithin(by);
}

std::vector<Vec3d> ShapeOracle::faceDirections() {
  std::vector<Vec3d> all;
  const auto offer = [&](const Vec3d& inShape, double sign) {
    const Vec3d world = otgRotate(shapePose_, otgScale(inShape, sign / norm(inShape)));
    const bool known = std::any_of(all.begin(), all.end(), [&](const Vec3d& d) { return otgDot(d, world) > 0.9998; });
    if (!known && all.size() < 40) all.push_back(world);
  };
  // The mesh leaves against its own normals, the shape along them.
  for (const Corners& t : triangles_) {
    const Vec3d n = otgCross(otgSub(t[1], t[0]), otgSub(t[2], t[0]));
    if (norm(n) > 0 && meets(t)) offer(n, -meshMoves_);
  }
  for (const Vec3d& n : shape_.normals) offer(n, meshMoves_);
  return all;
}

}  // namespace otg::truth
