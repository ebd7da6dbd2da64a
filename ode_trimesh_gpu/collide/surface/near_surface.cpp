// SPDX-License-Identifier: BSD-3-Clause
#include "collide/surface/near_surface.h"

#include <algorithm>
#include <cmath>

#include "bvh/wide_search.h"

namespace otg {
namespace {

constexpr double kTouched = 1e-13;  ///< of the size and the distances
constexpr double kRound = 0.8;      ///< of the box's half diagonal: with less reach a shape is like a ball

/// A box of the shape's frame, in the mesh's.
BoxQuery boxQuery(const Query& query, const Vec3d& low, const Vec3d& high) {
  Transformd frame = query.bInA;
  frame.t = otgTransform(frame, (low + high) * 0.5);
  return {*query.a, frame, (high - low) * 0.5};
}

}  // namespace

double vertexRounding(const TriMesh& mesh) {
  constexpr double kSinglePrecision = 4e-7;  // of the mesh's reach
  const Vec3f &a = mesh.boundsMin(), &b = mesh.boundsMax();
  const float reach =
      std::max({std::fabs(a.x), std::fabs(a.y), std::fabs(a.z), std::fabs(b.x), std::fabs(b.y), std::fabs(b.z)});
  return kSinglePrecision * double{reach};
}

NearSurface::NearSurface(const Query& query, const ConvexGeometry& shape, bool looksAhead, double longestWay)
    : query_(query),
      shape_(shape),
      mesh_(query.a->mesh()),
      placed_(shape, query.bInA, {0, 0, 0}),
      inside_(otgTransform(query.bInA, shape.middle)),
      rear_(inside_),
      longestWay_(longestWay),
      looksAhead_(looksAhead) {
  const Vec3d apart = inside_ - Vec3d{mesh_.center().x, mesh_.center().y, mesh_.center().z};
  const double radius = 0.5 * norm(shape.high - shape.low);
  leastDepth_ = kTouched * (double{mesh_.radius()} + norm(apart) + radius + norm(query.bInA.t));
  rounding_ = vertexRounding(mesh_);
}

NearSurface::Around::Around(const NearSurface& near, const Vec3d& way)
    : near_(near),
      low_(near.shape_.low + minimum(near.placed_.directionToLocal(way), {0, 0, 0})),
      high_(near.shape_.high + maximum(near.placed_.directionToLocal(way), {0, 0, 0})),
      box_(boxQuery(near.query_, low_, high_)),
      ball_(*near.query_.a, near.inside_ + way * 0.5, near.shape_.reach + 0.5 * norm(way)),
      isRound_(near.shape_.reach < kRound * 0.5 * norm(near.shape_.high - near.shape_.low)) {}

unsigned NearSurface::Around::operator()(const WideNode& node) const {
  const unsigned bits = box_(node);
  return isRound_ && bits != 0 ? bits & ball_(node) : bits;
}

bool NearSurface::Around::isBeside(std::uint32_t t) const {
  const PlacedBody& placed = near_.placed_;
  const Vec3d a = placed.toLocal(near_.corner(t, 0)), b = placed.toLocal(near_.corner(t, 1)),
              c = placed.toLocal(near_.corner(t, 2));
  const Vec3d apart = maximum(minimum(minimum(a, b), c) - high_, low_ - maximum(maximum(a, b), c));
  return std::max({apart.x, apart.y, apart.z}) > near_.rounding_;
}

bool NearSurface::isInFrontOf(std::uint32_t t, const Vec3d& way, double slack, Vec3d& rear) const {
  const Vec3d& n = query_.a->adjacency().normal[t];
  const double offset = otgDot(n, corner(t, 0) - way) - slack;
  // Neighbours mostly have the same rear.
  if (otgDot(n, rear) < offset) return false;
  rear = placed_.rear(n);
  return otgDot(n, rear) >= offset;
}

/// All of the shape, where it is.
bool NearSurface::isBehind(std::uint32_t t) const {
  const Vec3d& n = query_.a->adjacency().normal[t];
  const double offset = otgDot(n, corner(t, 0));
  return otgDot(n, inside_) < offset && -placed_.rearAlong(n * -1.0) < offset;
}

bool NearSurface::collect() {
  const Around around(*this, {0, 0, 0});
  const bool areFew = searchWide(
      query_.a->wide(), around, [&](std::uint32_t t) { return mesh_.isDegenerate(t) || around.isBeside(t) || add(t); });
  std::sort(touched_.data(), touched_.data() + count_);
  return areFew;
}

bool NearSurface::add(std::uint32_t t) {
  if (isInFrontOf(t, {0, 0, 0}, 0, rear_) || isBehind(t)) return true;
  if (count_ == kMostTriangles) return false;
  touched_[count_++] = t;
  return true;
}

}  // namespace otg
