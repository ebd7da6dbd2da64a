// SPDX-License-Identifier: BSD-3-Clause
// Large regions in bounded form: their surface, their candidate points and their extent by the cells of a grid over the
// region's bounds. docs/contacts.md, "Large regions".
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include "collide/solid/epoch_array.h"
#include "collide/solid/regions.h"
#include "collide/solid/vectors.h"
#include "mesh/adjacency.h"

namespace otg {

/// A grid of at most 8 x 8 x 8 cells over the bounds of a region.
class RegionGrid {
 public:
  static constexpr std::uint32_t kCells = 512;
  RegionGrid() = default;
  /// Cells of the region's diagonal / perDiagonal (at most 8).
  RegionGrid(const Region& region, double perDiagonal)
      : lo_(region.lo), scale_(region.diagonal > 0 ? perDiagonal / region.diagonal : 0) {}
  std::uint32_t cell(const Vec3d& p) const {
    return along(p.x - lo_.x) | along(p.y - lo_.y) << 3 | along(p.z - lo_.z) << 6;
  }

 private:
  std::uint32_t along(double x) const {
    const double c = x * scale_;
    return c > 0 ? std::min(7u, static_cast<std::uint32_t>(c)) : 0u;
  }
  Vec3d lo_{};
  double scale_ = 0;
};

/// Sums surface by cell, mesh and main direction.
class PieceCells {
 public:
  void begin(const Region& region);
  /// A part of the surface: where, how it faces, its vector area, area, sum of (normal . x) area, and its bounds.
  /// Parts may be taken off again by negative sums with the same place and direction. triangle() names one of it.
  template <class TriangleOf>
  void add(int mesh, const Vec3d& place, const Vec3d& facing, const TriangleOf& triangle, const Vec3d& vector,
           double area, double moment, const Vec3d& lo, const Vec3d& hi) {
    const std::uint32_t key = grid_.cell(place) * 16 + mainDirection(facing) * 2 + static_cast<std::uint32_t>(mesh);
    std::uint32_t i = index_.find(key);
    if (i == EpochArray::kMissing) {
      i = static_cast<std::uint32_t>(sums_.size());
      index_.set(key, i);
      sums_.push_back({{0, 0, 0}, 0, 0, 0, lo, hi, triangle(), static_cast<std::uint8_t>(mesh)});
    }
    Sum& sum = sums_[i];
    sum.vector = otgAdd(sum.vector, vector);
    sum.area += area;
    sum.gross += std::fabs(area);
    sum.moment += moment;
    sum.lo = minimum(sum.lo, lo);
    sum.hi = maximum(sum.hi, hi);
  }
  /// Appends one piece for each cell that holds any surface.
  void finish(std::uint32_t region, std::vector<Piece>& out);

 private:
  struct Sum {
    Vec3d vector;
    double area, gross, moment;
    Vec3d lo, hi;
    std::uint32_t triangle;
    std::uint8_t mesh;
  };
  /// 0 to 5: which axis a direction is nearest to, and in which sense.
  static std::uint32_t mainDirection(const Vec3d& d) {
    const double x = std::fabs(d.x), y = std::fabs(d.y), z = std::fabs(d.z);
    if (x >= y && x >= z) return d.x < 0;
    if (y >= z) return 2 + (d.y < 0);
    return 4 + (d.z < 0);
  }
  RegionGrid grid_;
  EpochArray index_;
  std::vector<Sum> sums_;
};

/// A candidate before it is worked out.
struct PointSeed {
  Vec3d position;  ///< relative to the origin
  Vec3d span;      ///< crossings: along the inside stretch of the edge, of its length; middles: half of that; else zero
  std::uint32_t region, feature, ordinal, crossing;
  std::uint8_t mesh;
  PointKind kind;
  bool flat;
};

/// Keeps of each cell, mesh and kind, flat or not, the point that lies deepest as far as a mean direction can tell.
class PointCells {
 public:
  /// `up`: in which A is pushed.
  void begin(const Region& region, const Vec3d& up);
  void offer(const PointSeed& seed);
  /// As if every vertex of a cluster lay in the middle of it: offers the deepest that is flat and the deepest that is
  /// not. [lo, hi] are their bounds, vertex(i) is the position of number cluster.first <= i < end.
  template <class Vertex, class IsFlat, class MakeSeed>
  void offerDeepest(int mesh, const Vec3d& lo, const Vec3d& hi, const Adjacency::Cluster& cluster, std::uint32_t end,
                    const Vertex& vertex, const IsFlat& isFlat, const MakeSeed& makeSeed) {
    const Vec3d middle = otgScale(otgAdd(lo, hi), 0.5), half = otgScale(otgSub(hi, lo), 0.5);
    const std::uint32_t key[2] = {keyOf(middle, PointKind::kVertex, mesh, false),
                                  keyOf(middle, PointKind::kVertex, mesh, true)};
    const bool any[2] = {cluster.anyCorner, cluster.anyFlat};
    std::uint32_t known[2] = {EpochArray::kMissing, EpochArray::kMissing};
    double best[2] = {1e300, 1e300};  // what there is none of cannot win
    for (int flat = 0; flat < 2; ++flat) {
      if (!any[flat]) continue;
      known[flat] = index_.find(key[flat]);
      best[flat] = known[flat] == EpochArray::kMissing ? -1e300 : depth(chosen_[known[flat]]);
    }
    const double sign = mesh == 0 ? -1 : 1, least = std::min(best[0], best[1]);
    if (sign * otgDot(up_, middle) + std::fabs(up_.x) * half.x + std::fabs(up_.y) * half.y +
            std::fabs(up_.z) * half.z <=
        least) {
      return;
    }
    std::uint32_t deepest[2] = {end, end};
    for (std::uint32_t i = cluster.first; i < end; ++i) {
      const double d = sign * otgDot(up_, vertex(i));
      if (!(d > std::min(best[0], best[1]))) continue;
      const int flat = any[0] && (!any[1] || !isFlat(i)) ? 0 : 1;
      if (!(d > best[flat])) continue;
      best[flat] = d;
      deepest[flat] = i;
    }
    for (int flat = 0; flat < 2; ++flat) {
      if (deepest[flat] < end) keep(key[flat], known[flat], makeSeed(deepest[flat]));
    }
  }
  const std::vector<PointSeed>& chosen() const { return chosen_; }

 private:
  std::uint32_t keyOf(const Vec3d& place, PointKind kind, int mesh, bool flat) const {
    return grid_.cell(place) * 16 + static_cast<std::uint32_t>(kind) * 4 + static_cast<std::uint32_t>(mesh) * 2 +
           (flat ? 1 : 0);
  }
  void keep(std::uint32_t key, std::uint32_t known, const PointSeed& seed) {
    if (known != EpochArray::kMissing) {
      chosen_[known] = seed;
      return;
    }
    index_.set(key, static_cast<std::uint32_t>(chosen_.size()));
    chosen_.push_back(seed);
  }
  double depth(const PointSeed& s) const { return (s.mesh == 0 ? -1 : 1) * otgDot(up_, s.position); }
  RegionGrid grid_;
  Vec3d up_{};
  EpochArray index_;
  std::vector<PointSeed> chosen_;
};

/// Counting sort of positions into the cells of a grid, with tight boxes.
void addExtentCells(Region& region, const std::vector<Vec3d>& positions, std::vector<std::uint32_t>& scratch,
                    ExtentCells& out);

}  // namespace otg
