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
  edges_.clear();
  triangles_.reserve(region.pieceEnd - region.pieceBegin);
  for (std::uint32_t i = region.pieceBegin; i < region.pieceEnd; ++i) {
    const Piece& p = all.pieces[i];
    RegionTriangle t;
    t.normal = p.normal;
    t.offset = p.offset;
    t.mesh = p.mesh;
    for (int k = 0; k < 3; ++k) {
      t.corner[k] = otgSub(meshes.vertex(p.mesh, meshes.mesh(p.mesh).triangles()[p.triangle].v[k]), all.origin);
    }
    for (int k = 0; k < 3; ++k) {
      t.inward[k] = unit(otgCross(p.normal, otgSub(t.corner[(k + 1) % 3], t.corner[k])));
      t.edge[k] = otgDot(t.inward[k], t.corner[k]);
    }
    triangles_.push_back(t);
    addEdges(meshes, t, p.triangle);
  }
}

void RegionTriangles::addEdges(const PlacedMeshes& meshes, const RegionTriangle& t, std::uint32_t number) {
  const Topology& topology = meshes.mesh(t.mesh).topology();
  for (std::uint32_t k = 0; k < 3; ++k) {
    const std::uint32_t twin = topology.twin[3 * number + k];
    if (twin == kNone) continue;
    const Vec3d ends = otgSub(t.corner[(k + 1) % 3], t.corner[k]), other = meshes.normal(t.mesh, twin / 3);
    if (!(otgDot(otgCross(t.normal, other), ends) > 0)) continue;
    edges_.push_back(
        {otgAdd(t.corner[k], otgScale(ends, 0.5)), unit(ends), 0.5 * norm(ends), {t.normal, other}, t.mesh});
  }
}

bool RegionTriangles::isCurved(const RegionTriangle& t) const {
  return std::any_of(triangles_.begin(), triangles_.end(), [&](const RegionTriangle& other) {
    const double cosine = otgDot(other.normal, t.normal);
    return other.mesh == t.mesh && cosine > OTG_SOLID_SHARP_COSINE && cosine < 1 - 1e-6;
  });
}

const std::vector<RegionTriangles::Exit>& RegionTriangles::exitsOf(int m, const Vec3d& p) {
  exits_.clear();
  distances_.assign(triangles_.size(), kInfinity);
  double nearest = kInfinity;
  for (std::size_t i = 0; i < triangles_.size(); ++i) {
    const RegionTriangle& t = triangles_[i];
    const double depth = t.offset - otgDot(t.normal, p);
    if (t.mesh != m || depth > nearest + slack_) continue;
    const Vec3d d = otgSub(otgPointOnTriangle(t.corner[0], t.corner[1], t.corner[2], p), p);
    distances_[i] = norm(d);
    nearest = std::min(nearest, distances_[i]);
  }
  for (std::size_t i = 0; i < triangles_.size(); ++i) {
    const RegionTriangle& t = triangles_[i];
    const double depth = t.offset - otgDot(t.normal, p);
    if (!(distances_[i] <= nearest * (1 + 1e-9) + slack_) || !(depth > -slack_)) continue;
    if (std::any_of(exits_.begin(), exits_.end(),
                    [&](const Exit& e) { return otgDot(e.normal, t.normal) > kSameNormal; }))
      continue;
    exits_.push_back({t.normal, std::max(depth, 0.0), isCurved(t)});
  }
  return exits_;
}

std::vector<RegionTriangles::StretchExit> RegionTriangles::facesOver(int m, const Vec3d& from, const Vec3d& to) const {
  std::vector<StretchExit> found;
  for (const RegionTriangle& t : triangles_) {
    if (t.mesh != m) continue;
    const double first = t.offset - otgDot(t.normal, from), last = t.offset - otgDot(t.normal, to);
    const double depth = std::max({first, last, 0.0});
    if (std::max(first, last) < -slack_) continue;
    const auto isOver = [&](const Vec3d& p, double way) {
      return t.beside(otgAdd(p, otgScale(t.normal, way))) <= std::max(way, slack_);
    };
    if (!isOver(from, first) && !isOver(to, last)) continue;
    const StretchExit exit{{t.normal, depth, isCurved(t)}, last > first};
    const auto same = std::find_if(found.begin(), found.end(),
                                   [&](const StretchExit& e) { return otgDot(e.exit.normal, t.normal) > kSameNormal; });
    if (same == found.end()) {
      found.push_back(exit);
    } else if (depth < same->exit.depth) {
      *same = exit;
    }
  }
  return found;
}

double RegionTriangles::wayOut(int m, const Vec3d& from, const Vec3d& direction) const {
  double nearest = kInfinity;
  for (const RegionTriangle& t : triangles_) {
    const double cosine = otgDot(t.normal, direction);
    if (t.mesh != m || !(cosine > 0.05)) continue;
    const double ahead = t.offset - otgDot(t.normal, from);
    if (ahead < -behind_) continue;
    const double way = std::max(0.0, ahead / cosine);
    if (way < nearest && t.beside(otgAdd(from, otgScale(direction, way))) <= slack_) nearest = way;
  }
  return nearest;
}

double RegionTriangles::distanceToFacing(int m, const Vec3d& p, const Vec3d& direction) const {
  double nearest = kInfinity;
  for (const RegionTriangle& t : triangles_) {
    if (t.mesh != m || otgDot(t.normal, direction) < OTG_SOLID_FACING) continue;
    if (std::fabs(t.offset - otgDot(t.normal, p)) >= nearest) continue;
    nearest = std::min(nearest, norm(otgSub(otgPointOnTriangle(t.corner[0], t.corner[1], t.corner[2], p), p)));
  }
  return nearest;
}

}  // namespace otg
