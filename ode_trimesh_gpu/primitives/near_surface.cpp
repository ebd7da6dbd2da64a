// SPDX-License-Identifier: BSD-3-Clause
#include "primitives/near_surface.h"

#include <algorithm>
#include <cmath>

#include "bvh/wide_search.h"
#include "collide/solid/look_ahead.h"

namespace otg {
namespace {

constexpr double kAhead = 0.05;  ///< of the shape's radius: how far around it is looked for what is in the way
constexpr double kSinglePrecision = 4e-7;  ///< of the mesh's reach: single precision, in which its vertices are
constexpr double kTouched = 1e-13;         ///< of the size and the distances

/// The middle of a convex's box may be outside of it.
Vec3d insideOf(const ConvexShape& shape) {
  Vec3d sum{0, 0, 0};
  for (const Vec3d& v : shape.vertices) sum = sum + v;
  return shape.vertices.empty() ? sum : sum * (1.0 / static_cast<double>(shape.vertices.size()));
}

}  // namespace

NearSurface::NearSurface(const Query& query, const ConvexShape& shape)
    : query_(query), shape_(shape), mesh_(query.a->mesh()), placed_(shape, query.bInA, {0, 0, 0}) {
  const Vec3f &low = shape.mesh->mesh().boundsMin(), &high = shape.mesh->mesh().boundsMax();
  const Vec3d middle{0.5 * (double{low.x} + high.x), 0.5 * (double{low.y} + high.y), 0.5 * (double{low.z} + high.z)};
  frame_ = query.bInA;
  frame_.t = otgTransform(frame_, middle);
  inside_ = rear_ = otgTransform(query.bInA, insideOf(shape));
  half_ = {high.x - middle.x, high.y - middle.y, high.z - middle.z};
  const double radius = norm(half_);
  const Vec3d apart = frame_.t - Vec3d{mesh_.center().x, mesh_.center().y, mesh_.center().z};
  leastDepth_ = kTouched * (double{mesh_.radius()} + norm(apart) + radius + norm(query.bInA.t));
  const Vec3f &a = mesh_.boundsMin(), &b = mesh_.boundsMax();
  rounding_ = kSinglePrecision * std::max({std::fabs(a.x), std::fabs(a.y), std::fabs(a.z), std::fabs(b.x),
                                           std::fabs(b.y), std::fabs(b.z)});
  ahead_ = otg::isCornered(query.a) ? kAhead * radius : 0;
}

bool NearSurface::collect() {
  bool isFew = true;
  const BoxQuery box(*query_.a, frame_, half_ + Vec3d{ahead_, ahead_, ahead_});
  searchWide(query_.a->wide(), box, [&](std::uint32_t t) { isFew = isFew && add(t); });
  std::sort(touched_.data(), touched_.data() + count_);
  return isFew;
}

bool NearSurface::add(std::uint32_t t) {
  if (mesh_.isDegenerate(t)) return true;
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
