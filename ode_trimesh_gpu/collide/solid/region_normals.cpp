// SPDX-License-Identifier: BSD-3-Clause
#include "collide/solid/region_normals.h"

#include <algorithm>
#include <cmath>

#include "base/flat_map.h"
#include "base/vectors.h"

namespace otg {
namespace {

constexpr double kFlat = OTG_SOLID_FLAT, kStraight = OTG_SOLID_STRAIGHT, kCurved = OTG_SOLID_CURVED;

}  // namespace

RegionNormals::RegionNormals(const OverlapRegions& all, const Region& region)
    : region_(region),
      mean_(unit(region.push)),
      radius_(otgNormalReach(region.areaA + region.areaB, region.thickness)),
      memory_(all.memory),
      elements_(all.memory),
      areas_{AreaSet(all.memory), AreaSet(all.memory)} {
  if (region.coherence >= kFlat) {
    isFlat_ = true;
    everywhere_ = mean_;
    return;
  }
  if (region.pieceEnd - region.pieceBegin > OTG_SOLID_MOST_ELEMENTS) {
    cluster(all);
  } else {
    elements_.reserve(region.pieceEnd - region.pieceBegin);
    for (std::uint32_t i = region.pieceBegin; i < region.pieceEnd; ++i) {
      const Piece& p = all.pieces[i];
      elements_.push_back({p.lo, p.hi, p.vector, p.area, p.offset * norm(p.vector), p.mesh});
    }
  }
  weighByDepth();
  // With zeros their signs would depend on the local normal.
  if (shareOfMean() >= 1 && weighted_.x != 0 && weighted_.y != 0 && weighted_.z != 0) {
    everywhere_ = notAgainstMean(unit(weighted_));
    return;
  }
  // A large part counts no more than one of the size of the reach.
  const double cap = radius_ * radius_;
  for (AreaSet& set : areas_) set.reserve(elements_.size());
  for (const Element& e : elements_) {
    const double weight = e.weight * (e.area > cap ? cap / e.area : 1.0);
    areas_[e.mesh].add(e.lo, e.hi, otgScale(e.vector, e.mesh == 0 ? -weight : weight), weight * e.area);
  }
}

void RegionNormals::weighByDepth() {
  weighted_ = mean_;
  if (!(region_.thickness > 0)) return;
  struct Plane {
    Vec3d normal;
    double offset;
  };
  std::pmr::vector<Plane> planes(memory_);
  planes.reserve(elements_.size());
  PlaneSet others[2] = {PlaneSet(memory_), PlaneSet(memory_)};
  for (PlaneSet& set : others) set.reserve(elements_.size());
  for (const Element& e : elements_) {
    const double length = norm(e.vector);
    planes.push_back(length > 0 ? Plane{otgScale(e.vector, 1 / length), e.offset / length} : Plane{{0, 0, 0}, 0});
    others[1 - e.mesh].add(planes.back().normal, planes.back().offset, e.lo, e.hi);
  }
  Vec3d sum[2] = {{0, 0, 0}, {0, 0, 0}};
  double total[2] = {0, 0};
  const double slack = OTG_SOLID_PIECE_SLACK * region_.diagonal;
  for (std::size_t i = 0; i < elements_.size(); ++i) {
    Element& e = elements_[i];
    const Vec3d& n = planes[i].normal;
    const Vec3d middle = otgScale(otgAdd(e.lo, e.hi), 0.5);
    const Vec3d from = otgAdd(middle, otgScale(n, planes[i].offset - otgDot(n, middle)));
    // Backwards to the nearest piece of the other mesh; where none lies behind, to the nearest plane of all, which is
    // right for convex overlaps.
    const PlaneSet::Way way = others[e.mesh].wayOutRound(from, otgScale(n, -1.0), slack);
    const bool found = way.nearest < region_.diagonal;
    e.weight = otgDepthWeight(found ? way.nearest : std::min(way.convex, region_.diagonal), region_.thickness);
    sum[e.mesh] = otgAdd(sum[e.mesh], otgScale(e.vector, e.weight));
    total[e.mesh] += e.weight * e.area;
  }
  double coherence[2];
  for (int m = 0; m < 2; ++m) coherence[m] = total[m] > 0 ? norm(sum[m]) / total[m] : 0;
  isFlat_ = std::max(coherence[0], coherence[1]) >= kCurved;
  chooseBetweenSides(otgScale(unit(sum[0]), -1.0), unit(sum[1]), coherence);
}

/// Where the faces of the two sides differ in direction, an edge or corner of one body is in a face of the other. The
/// face says where out is. It is found as the direction between the two that is nearest to the region's vector area,
/// which holds the sides of that edge, too. A curved side is no face.
void RegionNormals::chooseBetweenSides(const Vec3d& a, const Vec3d& b, const double coherence[2]) {
  shareOfB_ = otgShareOfB(a, b, mean_, coherence[0], coherence[1]);
  const Vec3d chosen = unit(otgAdd(otgScale(a, 1 - shareOfB_), otgScale(b, shareOfB_)));
  if (otgDot(chosen, chosen) > 0) weighted_ = chosen;
}

/// Cells of an eighth of the radius of influence, one element per cell and mesh.
void RegionNormals::cluster(const OverlapRegions& all) {
  const double cell = radius_ / 8;
  FlatMap index(memory_);
  for (std::uint32_t i = region_.pieceBegin; i < region_.pieceEnd; ++i) {
    const Piece& p = all.pieces[i];
    const auto coordinate = [&](double lo, double hi, double origin) {
      return static_cast<std::uint64_t>(std::clamp((0.5 * (lo + hi) - origin) / cell, 0.0, 1e6));
    };
    const std::uint64_t key = coordinate(p.lo.x, p.hi.x, region_.lo.x) |
                              coordinate(p.lo.y, p.hi.y, region_.lo.y) << 20 |
                              coordinate(p.lo.z, p.hi.z, region_.lo.z) << 40 | std::uint64_t{p.mesh} << 60;
    bool inserted = false;
    const std::uint32_t e = index.insert(key, static_cast<std::uint32_t>(elements_.size()), &inserted);
    const Vec3d& a = p.vector;
    if (inserted) {
      elements_.push_back({p.lo, p.hi, a, p.area, p.offset * norm(a), p.mesh});
      continue;
    }
    Element& element = elements_[e];
    element.lo = {std::min(element.lo.x, p.lo.x), std::min(element.lo.y, p.lo.y), std::min(element.lo.z, p.lo.z)};
    element.hi = {std::max(element.hi.x, p.hi.x), std::max(element.hi.y, p.hi.y), std::max(element.hi.z, p.hi.z)};
    element.vector = otgAdd(element.vector, a);
    element.area += p.area;
    element.offset += p.offset * norm(a);
  }
}

Vec3d RegionNormals::local(const Vec3d& point) const {
  // Out of B: along B's outward normals, against A's.
  const AreaSet::Sum a = areas_[0].about(point, radius_), b = areas_[1].about(point, radius_);
  const Vec3d& fallback = region_.coherence >= OTG_SOLID_COHERENT || !escape_ ? mean_ : *escape_;
  const Vec3d n = otgLocalNormal(a.vector, a.area, b.vector, b.area, shareOfB_, isLump());
  return otgDot(n, n) > 0 ? n : fallback;
}

Vec3d RegionNormals::at(const Vec3d& point) const {
  if (fixed_) return *fixed_;
  if (everywhere_) return *everywhere_;
  Vec3d n = local(point);
  if (const double w = shareOfMean(); w > 0) n = unit(otgAdd(otgScale(weighted_, w), otgScale(n, 1 - w)));
  return notAgainstMean(n);
}

/// How much one direction of the whole region counts; the local ones count the rest.
double RegionNormals::shareOfMean() const {
  return std::clamp((region_.coherence - kCurved) / (kStraight - kCurved), 0.0, 1.0);
}

Vec3d RegionNormals::notAgainstMean(const Vec3d& n) const {
  // Against the mean the way out of a lump is longer; a thin region may run around a rim.
  return isLump() && region_.coherence >= OTG_SOLID_COHERENT && otgDot(n, mean_) < -0.2 ? mean_ : n;
}

}  // namespace otg
