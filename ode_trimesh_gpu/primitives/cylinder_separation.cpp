// SPDX-License-Identifier: BSD-3-Clause
#include "primitives/cylinder_separation.h"

#include <algorithm>
#include <cmath>

#include "collide/convex/kept_axis.h"
#include "collide/convex/polytope.h"

namespace otg {
namespace {

constexpr double kEnough = 1e-3;        ///< of the overlap: how far the polytope may be from it
constexpr double kWorthATry = 1.5;      ///< the overlap along a direction, to the least so far
constexpr double kSame = 1e-9;          ///< of the size: faces and ends are taken before others
constexpr double kArcRounding = 1e-13;  ///< of the size
constexpr int kMostHalvings = 40, kMostSteps = 16;
constexpr double kSlack = 1.01, kSizeSlack = 1e-7;  ///< as in kept_axis.cpp

struct Vec2 {
  double x, y;
};
double cross(const Vec2& a, const Vec2& b) {
  return a.x * b.y - a.y * b.x;
}
double dot(const Vec2& a, const Vec2& b) {
  return a.x * b.x + a.y * b.y;
}

/// The arc of directions between the normals of the two faces at an edge, seen along the edge. The outline of the body
/// of differences is convex there. A chord of it bounds the overlap of all directions between its ends from below.
class Arc {
 public:
  Arc(const PlacedCylinder& cylinder, const Vec3d& from, const Vec3d& along, const Vec3d& normal)
      : cylinder_(cylinder), from_(from), y_(unit(otgCross(along, normal))), x_(otgCross(y_, unit(along))) {}

  struct End {
    Vec2 direction, at;
  };
  End endOf(const Vec3d& normal) const {
    const double x = otgDot(x_, normal), y = otgDot(y_, normal), length = std::sqrt(x * x + y * y);
    return endAt({x / length, y / length});
  }
  Vec3d direction(const Vec2& d) const { return x_ * d.x + y_ * d.y; }
  /// Calls offer(m, overlap) for ever better directions between two ends; it returns the overlap that is worth a try.
  template <class Offer>
  void search(const End& first, const End& last, double rounding, const Offer& offer, int depth = 0) const {
    const Vec2 chord{last.at.x - first.at.x, last.at.y - first.at.y};
    const double length = std::sqrt(dot(chord, chord));
    if (!(length > rounding)) return;
    const Vec2 normal{chord.y / length, -chord.x / length};
    const double bound = dot(normal, first.at);
    if (!(bound < offer(Vec3d{0, 0, 0}, std::numeric_limits<double>::infinity()) - rounding)) return;
    if (!(cross(first.direction, normal) > 0) || !(cross(normal, last.direction) > 0)) return;
    const End middle = endAt(normal);
    const double overlap = dot(normal, middle.at);
    offer(direction(normal), overlap);
    if (depth == kMostHalvings || !(overlap - bound > rounding)) return;
    search(first, middle, rounding, offer, depth + 1);
    search(middle, last, rounding, offer, depth + 1);
  }

 private:
  End endAt(const Vec2& d) const {
    const Vec3d at = from_ - cylinder_.rear(direction(d));
    return {d, {otgDot(x_, at), otgDot(y_, at)}};
  }

  const PlacedCylinder& cylinder_;
  const Vec3d from_, y_, x_;
};

}  // namespace

CylinderSeparation::CylinderSeparation(const ConvexPolyhedron& body, const PlacedCylinder& cylinder, double size)
    : body_(body), cylinder_(cylinder), size_(size) {}

double CylinderSeparation::overlapOfFace(std::uint32_t face) const {
  return body_.face(face).offset + cylinder_.reachBack(body_.face(face).normal);
}

void CylinderSeparation::separate(const Vec3d& m) {
  apart_ = true;
  apartAlong_ = m;
}

void CylinderSeparation::offer(Of of, const Vec3d& m, double overlap, std::uint32_t feature) {
  if (overlap < 0) separate(m);
  const double slack = kSame * size_;
  const bool isBetter =
      of < best_.of ? overlap <= best_.overlap + slack : overlap < best_.overlap - (of > best_.of ? slack : 0);
  if (best_.of == Of::kNone || isBetter) best_ = {of, m, overlap, feature};
}

/// The arc of the edge that begins at a corner of a face.
void CylinderSeparation::tryCorner(std::uint32_t corner) {
  const ConvexPolyhedron::Corner& edge = body_.corner(corner);
  const Vec3d from = body_.vertices()[edge.vertex], along = body_.vertices()[edge.next] - from;
  const Vec3d &left = body_.face(edge.face).normal, &right = body_.face(edge.across).normal;
  const Arc arc(cylinder_, from, along, left);
  arc.search(arc.endOf(left), arc.endOf(right), kArcRounding * size_, [&](const Vec3d& m, double overlap) {
    if (std::isfinite(overlap)) offer(Of::kEdge, m, overlap, corner);
    return apart_ ? -size_ : best_.overlap;
  });
}

/// Out through the nearest point of the round side.
void CylinderSeparation::tryVertex(std::uint32_t vertex) {
  const Vec3d at = body_.vertices()[vertex], aside = cylinder_.across(at - cylinder_.middle);
  const double length = norm(aside), overlap = cylinder_.radius - length;
  if (!(length > 0) || !(overlap < best_.overlap)) return;
  const Vec3d m = aside * (-1 / length);
  for (const std::uint32_t c : body_.cornersAt(vertex)) {
    if (otgDot(body_.vertices()[body_.corner(c).next] - at, m) > 0) return;
  }
  offer(Of::kCorner, m, overlap, vertex);
}

/// All directions of a vertex. False if it has been here before.
bool CylinderSeparation::visit(std::uint32_t vertex) {
  const auto begin = visited_.begin(), end = begin + static_cast<std::ptrdiff_t>(visitedCount_);
  if (visitedCount_ == kMostVisited || std::find(begin, end, vertex) != end) return false;
  const std::span<const std::uint32_t> corners = body_.cornersAt(vertex);
  for (const std::uint32_t c : corners) {
    const std::uint32_t face = body_.corner(c).face;
    offer(Of::kFace, body_.face(face).normal, overlapOfFace(face), face);
  }
  for (const std::uint32_t c : corners) {
    if (!apart_ && std::find(begin, end, body_.corner(c).next) == end) tryCorner(c);
  }
  if (!apart_) tryVertex(vertex);
  visited_[visitedCount_++] = vertex;
  return true;
}

/// From vertex to vertex, as long as they are new.
void CylinderSeparation::descend(Vec3d m) {
  for (int i = 0; i < kMostSteps && !apart_ && visit(body_.support(m)); ++i) m = best_.m;
}

bool CylinderSeparation::look(const Vec3d& m, const Difference& difference) {
  const double overlap = otgDot(m, difference.at);
  if (overlap < 0) separate(m);
  if (!apart_ && overlap < kWorthATry * best_.overlap) visit(difference.vertex);
  if (!apart_ && overlap < best_.overlap) offer(Of::kOther, m, overlap, kNone);
  return !apart_;
}

bool CylinderSeparation::isEnough(double overlap, double distance, double rounding) const {
  return std::min(overlap, best_.overlap) - distance <= std::max(kEnough * best_.overlap, rounding);
}

/// Whether the body of differences has a large face around the origin's foot.
bool CylinderSeparation::isSure(const CylinderAxis& axis) const {
  double radius = 0;
  if (axis.of == Of::kEnd) {
    radius = cylinder_.radius - norm(cylinder_.across(body_.vertices()[axis.feature] - cylinder_.middle));
  } else if (axis.of == Of::kFace) {
    const Vec3d at = cylinder_.rear(axis.m);
    radius = std::numeric_limits<double>::infinity();
    for (const ConvexPolyhedron::Corner& corner : body_.corners(axis.feature)) {
      const Vec3d from = body_.vertices()[corner.vertex];
      const Vec3d outward = otgCross(body_.vertices()[corner.next] - from, axis.m);
      radius = std::min(radius, -otgDot(outward, at - from) / norm(outward));
    }
  }
  const double most = kSlack * axis.overlap + kSizeSlack * size_;
  return radius > most && isLeastAround(axis.m, most, radius, difference(otgScale(axis.m, -1.0)).at);
}

bool CylinderSeparation::isStillLeast(std::uint32_t face, CylinderAxis& axis) const {
  if (!isAlone(body_, face)) return false;
  axis = {Of::kFace, body_.face(face).normal, overlapOfFace(face), face};
  return axis.overlap > 0 && isSure(axis);
}

CylinderAxis CylinderSeparation::find(const Vec3d& toB) {
  for (const double sign : {1.0, -1.0}) {
    const Vec3d m = cylinder_.axis * sign;
    const std::uint32_t vertex = body_.support(m);
    offer(Of::kEnd, m, otgDot(m, body_.vertices()[vertex]) + cylinder_.reachBack(m), vertex);
  }
  if (!apart_) descend(norm(toB) > 0 ? toB : Vec3d{0, 0, 1});
  if (!apart_ && !isSure(best_)) {
    Polytope<CylinderSeparation>(*this, best_.m, size_).run();
    descend(best_.m);
  }
  return apart_ ? CylinderAxis{} : best_;
}

}  // namespace otg
