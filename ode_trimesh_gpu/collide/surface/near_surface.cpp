// SPDX-License-Identifier: BSD-3-Clause
#include "collide/surface/near_surface.h"

#include <algorithm>
#include <cmath>

#include "bvh/wide_search.h"

namespace otg {
namespace {

constexpr double kAhead = 0.05;  ///< of the shape's radius: how far around it is looked for what is in the way
constexpr double kSinglePrecision = 4e-7;  ///< of the mesh's reach: single precision, in which its vertices are
constexpr double kTouched = 1e-13;         ///< of the size and the distances

}  // namespace

NearSurface::NearSurface(const Query& query, const ConvexGeometry& shape, bool looksAhead)
    : query_(query), shape_(shape), mesh_(query.a->mesh()), placed_(shape, query.bInA, {0, 0, 0}) {
  const Vec3d &low = shape.low, &high = shape.high;
  const Vec3d middle = (low + high) * 0.5;
  frame_ = query.bInA;
  frame_.t = otgTransform(frame_, middle);
  inside_ = rear_ = otgTransform(query.bInA, shape.middle);
  half_ = high - middle;
  const double radius = norm(half_);
  const Vec3d apart = frame_.t - Vec3d{mesh_.center().x, mesh_.center().y, mesh_.center().z};
  leastDepth_ = kTouched * (double{mesh_.radius()} + norm(apart) + radius + norm(query.bInA.t));
  const Vec3f &a = mesh_.boundsMin(), &b = mesh_.boundsMax();
  rounding_ = kSinglePrecision * std::max({std::fabs(a.x), std::fabs(a.y), std::fabs(a.z), std::fabs(b.x),
                                           std::fabs(b.y), std::fabs(b.z)});
  ahead_ = looksAhead ? kAhead * radius : 0;
}

bool NearSurface::collect() {
  bool isFew = true;
  const BoxQuery box(*query_.a, frame_, half_ + Vec3d{ahead_, ahead_, ahead_});
  searchWide(query_.a->wide(), box, [&](std::uint32_t t) { isFew = isFew && add(t); });
  std::sort(touched_.data(), touched_.data() + count_);
  return isFew;
}

/// The tree knows its boxes alone.
bool NearSurface::isBesideBox(std::uint32_t t) const {
  const Vec3d a = placed_.toLocal(corner(t, 0)), b = placed_.toLocal(corner(t, 1)), c = placed_.toLocal(corner(t, 2));
  const Vec3d least = minimum(minimum(a, b), c), most = maximum(maximum(a, b), c);
  const double around = std::max(ahead_, rounding_);
  return least.x > shape_.high.x + around || most.x < shape_.low.x - around || least.y > shape_.high.y + around ||
         most.y < shape_.low.y - around || least.z > shape_.high.z + around || most.z < shape_.low.z - around;
}

bool NearSurface::add(std::uint32_t t) {
  if (mesh_.isDegenerate(t) || isBesideBox(t)) return true;
  const Vec3d& n = query_.a->adjacency().normal[t];
  const double offset = otgDot(n, corner(t, 0));
  // Neighbours mostly have the same rear.
  if (otgDot(n, rear_) > offset) rear_ = placed_.rear(n);
  if (otgDot(n, rear_) > offset) {
    if (ahead_ > 0) {
      if (besideCount_ == kMostTriangles) return false;
      beside_[besideCount_++] = {n, offset};
    }
    return true;
  }
  const bool mayBeBehind = otgDot(n, inside_) < offset;
  if (mayBeBehind && -placed_.rearAlong(n * -1.0) < offset) return true;  // all of the shape
  if (count_ == kMostTriangles) return false;
  touched_[count_++] = t;
  return true;
}

bool NearSurface::isFree(const Vec3d& way) const {
  if (!(ahead_ > 0)) return true;
  return norm(way) <= ahead_ && std::all_of(beside_.data(), beside_.data() + besideCount_, [&](const Beside& b) {
           return placed_.rearAlong(b.normal) + otgDot(b.normal, way) >= b.offset - rounding_;
         });
}

}  // namespace otg
