// SPDX-License-Identifier: BSD-3-Clause
#include "collide/solid/region_triangles.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/vectors.h"
#include "shared/tests/triangle_distance.h"

namespace otg {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kSameNormal = 1 - 1e-12;

}  // namespace

double RegionTriangle::beside(const Vec3d& p) const {
  double most = -kInfinity;
  for (int k = 0; k < 3; ++k) most = std::max(most, edge[k] - otgDot(inward[k], p));
  return most;
}

void RegionTriangles::collect(const PlacedMeshes& meshes, const OverlapRegions& all, const Region& region) {
  slack_ = OTG_SOLID_ON_EDGE * region.diagonal;
  behind_ = OTG_SOLID_BELOW_SURFACE * region.diagonal;
  triangles_.clear();
  planes_.clear();
  edges_.clear();
  edgesAdded_.clear();
  triangles_.reserve(region.pieceEnd - region.pieceBegin);
  planes_.reserve(region.pieceEnd - region.pieceBegin);
  for (int m = 0; m < 2; ++m) {
    for (std::uint32_t i = region.pieceBegin; i < region.pieceEnd; ++i) {
      if (all.pieces[i].mesh == m) addTriangle(meshes, all.origin, all.pieces[i]);
    }
    begin_[m + 1] = triangles_.size();
  }
  curved_.assign(triangles_.size(), Curved::kUnknown);
}

void RegionTriangles::addTriangle(const PlacedMeshes& meshes, const Vec3d& origin, const Piece& piece) {
  RegionTriangle t;
  t.normal = piece.normal;
  t.offset = piece.offset;
  const auto& v = meshes.mesh(piece.mesh).triangles()[piece.triangle].v;
  for (int k = 0; k < 3; ++k) t.corner[k] = otgSub(meshes.vertex(piece.mesh, v[k]), origin);
  for (int k = 0; k < 3; ++k) {
    t.inward[k] = unit(otgCross(t.normal, otgSub(t.corner[(k + 1) % 3], t.corner[k])));
    t.edge[k] = otgDot(t.inward[k], t.corner[k]);
  }
  triangles_.push_back(t);
  planes_.push_back({t.normal, t.offset});
  addEdges(meshes, t, piece.mesh, piece.triangle);
}

void RegionTriangles::addEdges(const PlacedMeshes& meshes, const RegionTriangle& t, std::uint8_t mesh,
                               std::uint32_t number) {
  const Topology& topology = meshes.mesh(mesh).topology();
  for (std::uint32_t k = 0; k < 3; ++k) {
    const std::uint32_t half = 3 * number + k, twin = topology.twin[half];
    if (twin == kNone) continue;
    const Vec3d ends = otgSub(t.corner[(k + 1) % 3], t.corner[k]), other = meshes.normal(mesh, twin / 3);
    if (!(otgDot(otgCross(t.normal, other), ends) > 0)) continue;
    bool isNew = false;
    edgesAdded_.insert(std::uint64_t{mesh} << 32 | std::min(half, twin), 0, &isNew);
    if (!isNew) continue;
    edges_.push_back({otgAdd(t.corner[k], otgScale(ends, 0.5)), unit(ends), 0.5 * norm(ends), {t.normal, other}, mesh});
  }
}

bool RegionTriangles::isCurved(int m, std::size_t i) const {
  if (curved_[i] == Curved::kUnknown) {
    const auto first = planes_.begin(), begin = first + static_cast<std::ptrdiff_t>(begin_[m]),
               end = first + static_cast<std::ptrdiff_t>(begin_[m + 1]);
    const bool is = std::any_of(begin, end, [&](const Plane& other) {
      const double cosine = otgDot(other.normal, planes_[i].normal);
      return cosine > OTG_SOLID_SHARP_COSINE && cosine < 1 - 1e-6;
    });
    curved_[i] = is ? Curved::kYes : Curved::kNo;
  }
  return curved_[i] == Curved::kYes;
}

const std::pmr::vector<RegionTriangles::Exit>& RegionTriangles::exitsOf(int m, const Vec3d& p) {
  exits_.clear();
  distances_.assign(triangles_.size(), kInfinity);
  double nearest = kInfinity;
  for (std::size_t i = begin_[m]; i < begin_[m + 1]; ++i) {
    if (depthBelow(i, p) > nearest + slack_) continue;
    const RegionTriangle& t = triangles_[i];
    distances_[i] = norm(otgSub(otgPointOnTriangle(t.corner[0], t.corner[1], t.corner[2], p), p));
    nearest = std::min(nearest, distances_[i]);
  }
  for (std::size_t i = begin_[m]; i < begin_[m + 1]; ++i) {
    if (!(distances_[i] <= nearest * (1 + 1e-9) + slack_)) continue;
    const double depth = depthBelow(i, p);
    const Vec3d& normal = planes_[i].normal;
    if (!(depth > -slack_)) continue;
    if (std::any_of(exits_.begin(), exits_.end(),
                    [&](const Exit& e) { return otgDot(e.normal, normal) > kSameNormal; }))
      continue;
    exits_.push_back({normal, std::max(depth, 0.0), isCurved(m, i)});
  }
  return exits_;
}

std::pmr::vector<RegionTriangles::StretchExit> RegionTriangles::facesOver(int m, const Vec3d& from,
                                                                          const Vec3d& to) const {
  std::pmr::vector<StretchExit> found(triangles_.get_allocator());
  for (std::size_t i = begin_[m]; i < begin_[m + 1]; ++i) {
    const double first = depthBelow(i, from), last = depthBelow(i, to);
    const double depth = std::max({first, last, 0.0});
    if (std::max(first, last) < -slack_) continue;
    const RegionTriangle& t = triangles_[i];
    const auto isOver = [&](const Vec3d& p, double way) {
      return t.beside(otgAdd(p, otgScale(t.normal, way))) <= std::max(way, slack_);
    };
    if (!isOver(from, first) && !isOver(to, last)) continue;
    const auto same = std::find_if(found.begin(), found.end(),
                                   [&](const StretchExit& e) { return otgDot(e.exit.normal, t.normal) > kSameNormal; });
    if (same != found.end() && !(depth < same->exit.depth)) continue;
    const StretchExit exit{{t.normal, depth, isCurved(m, i)}, last > first};
    if (same == found.end()) {
      found.push_back(exit);
    } else {
      *same = exit;
    }
  }
  return found;
}

void RegionTriangles::lookFrom(const Vec3d& from) {
  from_ = from;
  for (int m = 0; m < 2; ++m) {
    ahead_[m].clear();
    for (std::size_t i = begin_[m]; i < begin_[m + 1]; ++i) {
      if (const double depth = depthBelow(i, from); depth >= -behind_) ahead_[m].push_back({depth, i});
    }
    std::sort(ahead_[m].begin(), ahead_[m].end(), [](const Ahead& x, const Ahead& y) {
      return x.depth != y.depth ? x.depth < y.depth : x.triangle < y.triangle;
    });
  }
}

double RegionTriangles::wayOut(int m, const Vec3d& direction, double limit) const {
  double nearest = limit;
  for (const auto& [depth, i] : ahead_[m]) {
    if (!(depth < nearest)) break;  // no way is shorter than the distance from the plane
    const double cosine = otgDot(planes_[i].normal, direction);
    if (!(cosine > 0.05) || depth >= nearest * cosine) continue;
    const double way = std::max(0.0, depth / cosine);
    if (triangles_[i].beside(otgAdd(from_, otgScale(direction, way))) <= slack_) nearest = way;
  }
  return nearest < limit ? nearest : kInfinity;
}

double RegionTriangles::distanceToFacing(int m, const Vec3d& p, const Vec3d& direction) const {
  double nearest = kInfinity;
  for (std::size_t i = begin_[m]; i < begin_[m + 1]; ++i) {
    if (otgDot(planes_[i].normal, direction) < OTG_SOLID_FACING || std::fabs(depthBelow(i, p)) >= nearest) continue;
    const RegionTriangle& t = triangles_[i];
    nearest = std::min(nearest, norm(otgSub(otgPointOnTriangle(t.corner[0], t.corner[1], t.corner[2], p), p)));
  }
  return nearest;
}

}  // namespace otg
