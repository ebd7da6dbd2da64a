// SPDX-License-Identifier: BSD-3-Clause
#include "primitives/convex_patch.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/vectors.h"

namespace otg {
namespace {

// More planes than these are no patch whose least way out is worth a search.
constexpr std::size_t kMostPlanes = 256;
constexpr double kSamePlane = 1 - 1e-12;
// A pair of edges has to be this much better than a face, as ODE's dBoxBox has it: faces hold bodies in more places.
constexpr double kEdgeHandicap = 1.05;
constexpr int kArcSamples = 8, kArcSteps = 30;

}  // namespace

double toleranceOf(const PlacedMeshes& meshes, const Region& region) {
  // Vertices are single precision numbers in A's frame: that is how flat a flat face is.
  const Vec3f& low = meshes.mesh(0).boundsMin();
  const Vec3f& high = meshes.mesh(0).boundsMax();
  const double reach = std::max(
      {std::fabs(low.x), std::fabs(low.y), std::fabs(low.z), std::fabs(high.x), std::fabs(high.y), std::fabs(high.z)});
  return 4e-7 * reach + 1e-6 * region.diagonal + 0.02 * region.thickness;
}

bool ConvexPatch::read(const PlacedMeshes& meshes, const OverlapRegions& all, const Region& region) {
  planes_.clear();
  edges_.clear();
  triangles_.clear();
  points_.clear();
  corners_.clear();
  dense_ = nullptr;
  origin_ = all.origin;
  if (region.cellBegin != region.cellEnd || region.pieceEnd - region.pieceBegin > ConvexPatch::kMostPieces)
    return false;
  tolerance_ = toleranceOf(meshes, region);

  std::pmr::vector<std::pair<std::uint32_t, std::uint32_t>> planeOf(memory_);  // triangle, plane
  for (std::uint32_t i = region.pieceBegin; i < region.pieceEnd; ++i) {
    const Piece& p = all.pieces[i];
    if (p.mesh != 0) continue;
    auto same = std::find_if(planes_.begin(), planes_.end(),
                             [&](const Plane& q) { return otgDot(q.normal, p.normal) > kSamePlane; });
    // Parallel faces of one convex patch are one plane; a step between them is found not to be convex below.
    if (same == planes_.end()) {
      if (planes_.size() == kMostPlanes) return false;
      // At once: most patches that are not convex show it in the first planes.
      for (std::uint32_t k = region.pointBegin; k < region.pointEnd; ++k) {
        if (otgDot(p.normal, all.points[k].position) > p.offset + tolerance_) return false;
      }
      planes_.push_back({p.normal, p.offset});
      same = planes_.end() - 1;
    }
    if (p.offset < same->offset - tolerance_ || p.offset > same->offset + tolerance_) return false;
    same->offset = std::max(same->offset, p.offset);
    planeOf.emplace_back(p.triangle, static_cast<std::uint32_t>(same - planes_.begin()));
  }
  if (planes_.empty()) return false;
  for (std::uint32_t i = region.pointBegin; i < region.pointEnd; ++i) {
    const SupportPoint& p = all.points[i];
    if (p.kind == PointKind::kCrossing || p.mesh == 0) points_.push_back(p.position);
    if (p.kind == PointKind::kVertex && p.mesh == 0) corners_.push_back(p.position);
  }
  std::sort(planeOf.begin(), planeOf.end());
  anyTriangle_ = planeOf.front().first;
  readEdges(meshes, planeOf);
  return true;
}

void ConvexPatch::readEdges(const PlacedMeshes& meshes,
                            const std::pmr::vector<std::pair<std::uint32_t, std::uint32_t>>& planeOf) {
  const TriMesh& mesh = meshes.mesh(0);
  for (const auto& [triangle, plane] : planeOf) {
    for (std::uint32_t k = 0; k < 3; ++k) {
      const std::uint32_t half = 3 * triangle + k, twin = mesh.topology().twin[half];
      if (twin == kNone || twin < half) continue;
      const auto other = std::lower_bound(planeOf.begin(), planeOf.end(), std::pair{twin / 3, 0u});
      if (other == planeOf.end() || other->first != twin / 3) continue;
      const Vec3d &n1 = planes_[plane].normal, &n2 = planes_[other->second].normal;
      if (otgDot(n1, n2) > kFlatEdge) continue;
      const Vec3d a = meshes.vertex(0, mesh.triangles()[triangle].v[k]) - origin_;
      const Vec3d b = meshes.vertex(0, mesh.triangles()[triangle].v[(k + 1) % 3]) - origin_;
      edges_.push_back({a, unit(b - a), n1, n2});
    }
  }
}

double ConvexPatch::wayOut(const Vec3d& point, const Vec3d& d) const {
  double least = std::numeric_limits<double>::infinity();
  for (const Plane& plane : planes_) {
    const double cosine = otgDot(plane.normal, d);
    if (cosine > 0.05) least = std::min(least, (plane.offset - otgDot(plane.normal, point)) / cosine);
  }
  return least;
}

/// Whether d is a sum of the normals, none taken less than zero times, of the planes that the point is on.
bool ConvexPatch::isInCone(const Vec3d& d, const Vec3d& at) const {
  constexpr double kRounding = 1e-6;
  constexpr std::size_t kMostActive = 12;
  Vec3d active[kMostActive];
  std::size_t count = 0;
  for (const Plane& plane : planes_) {
    if (plane.offset - otgDot(plane.normal, at) > tolerance_) continue;
    if (count == kMostActive) return false;
    active[count++] = plane.normal;
  }
  // A cone is the union of those of three of its directions (or of two, or one).
  for (std::size_t i = 0; i < count; ++i) {
    if (otgDot(active[i], d) > 1 - 1e-12) return true;
    for (std::size_t j = 0; j < i; ++j) {
      const Vec3d n = otgCross(active[i], active[j]);
      const double nn = otgDot(n, n);
      if (!(nn > 1e-12)) continue;
      const double u = otgDot(otgCross(d, active[j]), n) / nn, v = otgDot(otgCross(active[i], d), n) / nn;
      const bool isBetween = u >= -kRounding && v >= -kRounding;
      if (isBetween && std::fabs(otgDot(n, d)) <= kRounding * std::sqrt(nn)) return true;
      // Beside the two may still be between the three: the third has a part along these.
      for (std::size_t k = 0; k < j; ++k) {
        const double det = otgDot(n, active[k]);
        if (std::fabs(det) < 1e-9) continue;
        const double w = otgDot(n, d) / det;
        const Vec3d rest = d - active[k] * w;
        const double a = otgDot(otgCross(rest, active[j]), n) / nn, b = otgDot(otgCross(active[i], rest), n) / nn;
        if (w >= -kRounding && a >= -kRounding && b >= -kRounding) return true;
      }
    }
  }
  return false;
}

/// Whether the patch has a supporting plane with normal d, and where.
bool ConvexPatch::hasSupport(const Vec3d& d, double& height) const {
  const Vec3d* best = nullptr;
  for (const Vec3d& p : points_) {
    if (best == nullptr || otgDot(d, p) > otgDot(d, *best)) best = &p;
  }
  if (best == nullptr) return false;
  height = otgDot(d, *best);
  // All faces of a corner are in the region: where nothing is higher, it is the patch's highest point.
  const bool isCorner = std::any_of(corners_.begin(), corners_.end(), [&](const Vec3d& p) { return p == *best; });
  return isCorner || isInCone(d, *best);
}

void ConvexPatch::offer(const PlacedShape& shape, const Vec3d& d, double height, double handicap, WayOut& best) const {
  const double depth = height - shape.rearAlong(d);
  if (depth * handicap >= best.depth) return;
  best = {};
  best.direction = d;
  best.depth = depth;
}

void ConvexPatch::tryEdge(const PlacedShape& shape, const Edge& edge, WayOut& best) const {
  const auto offerEdge = [&](const Vec3d& d, double handicap, const Vec3d& alongShape) {
    const double before = best.depth;
    offer(shape, d, otgDot(d, edge.point), handicap, best);
    if (best.depth < before) {
      best.overEdges = true;
      best.onMesh = edge.point;
      best.alongMesh = edge.direction;
      best.alongShape = alongShape;
    }
  };
  const Vec3d across = otgCross(edge.normal1, edge.normal2);
  if (!shape.shape().isCurved()) {
    for (const Vec3d& local : shape.shape().edgeDirections) {
      const Vec3d along = shape.direction(local);
      Vec3d d = unit(otgCross(edge.direction, along));
      if (!(otgDot(d, d) > 0)) continue;
      if (otgDot(d, edge.normal1 + edge.normal2) < 0) d = d * -1.0;
      const bool between =
          otgDot(otgCross(edge.normal1, d), across) >= 0 && otgDot(otgCross(d, edge.normal2), across) >= 0;
      if (between) offerEdge(d, kEdgeHandicap, along);
    }
    return;
  }
  const double angle = std::acos(std::clamp(otgDot(edge.normal1, edge.normal2), -1.0, 1.0));
  const double sine = std::sin(angle);
  if (!(sine > 1e-9)) return;  // a knife's edge
  const auto directionAt = [&](double t) {
    return unit(edge.normal1 * std::sin((1 - t) * angle) + edge.normal2 * std::sin(t * angle));
  };
  const auto depthAt = [&](double t) {
    const Vec3d d = directionAt(t);
    return otgDot(d, edge.point) - shape.rearAlong(d);
  };
  int least = 0;
  double depths[kArcSamples + 1];
  for (int i = 0; i <= kArcSamples; ++i) {
    depths[i] = depthAt(static_cast<double>(i) / kArcSamples);
    if (depths[i] < depths[least]) least = i;
  }
  // The way changes by no more than the shape's farthest point is away, for each radian: between the samples it cannot
  // become shorter than the shortest so far.
  const double reach = norm(shape.fromLocal({0, 0, 0}) - edge.point) + shape.shape().radius + shape.shape().length;
  if (depths[least] - reach * angle * (0.5 / kArcSamples) * (1 + 1e-6) >= best.depth) return;
  double low = std::max(0, least - 1), high = std::min(kArcSamples, least + 1);
  low /= kArcSamples;
  high /= kArcSamples;
  constexpr double kGolden = 0.6180339887498949;
  double x = high - kGolden * (high - low), y = low + kGolden * (high - low);
  double fx = depthAt(x), fy = depthAt(y);
  for (int i = 0; i < kArcSteps; ++i) {
    if (fx < fy) {
      high = y;
      y = x;
      fy = fx;
      fx = depthAt(x = high - kGolden * (high - low));
    } else {
      low = x;
      x = y;
      fx = fy;
      fy = depthAt(y = low + kGolden * (high - low));
    }
  }
  const Vec3d d = directionAt(0.5 * (low + high));
  // Where the shape's straight side leads, any point of it is as far back as the other ones.
  const Vec3d axis = shape.direction({0, 0, 1});
  offerEdge(d, 1.0, std::fabs(otgDot(d, axis)) < 1e-3 ? axis : Vec3d{0, 0, 0});
}

Vec3d wayToRoundSide(const PlacedShape& shape, const Vec3d& point) {
  Vec3d local = shape.toLocal(point);
  if (shape.shape().kind == ConvexShape::Kind::kCapsule) {
    local.z -= std::clamp(local.z, -shape.shape().length, shape.shape().length);
  } else {
    local.z = 0;
  }
  return unit(shape.direction(local) * -1.0);
}

WayOut ConvexPatch::leave(const PlacedShape& shape, const Vec3d& out) const {
  if (isDense()) return leaveDense(shape, out);
  WayOut best;
  best.depth = std::numeric_limits<double>::infinity();
  const auto isOut = [&](const Vec3d& d) { return otgDot(d, out) >= 0; };
  for (const Plane& plane : planes_) {
    if (isOut(plane.normal)) offer(shape, plane.normal, plane.offset, 1.0, best);
  }
  for (const Vec3d& local : shape.shape().faceNormals) {
    const Vec3d d = shape.direction(local) * -1.0;
    double height = 0;
    if (isOut(d) && hasSupport(d, height)) offer(shape, d, height, 1.0, best);
  }
  for (const Edge& edge : edges_) tryEdge(shape, edge, best);
  if (shape.shape().isCurved()) {
    for (const Vec3d& corner : corners_) {
      const Vec3d d = wayToRoundSide(shape, corner);
      if (otgDot(d, d) > 0 && isOut(d) && isInCone(d, corner)) offer(shape, d, otgDot(d, corner), 1.0, best);
    }
  }
  return best;
}

}  // namespace otg
