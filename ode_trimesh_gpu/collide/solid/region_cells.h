// SPDX-License-Identifier: BSD-3-Clause
// Large regions in bounded form: their surface, their candidate points and their extent by the cells of a grid over the
// region's bounds. docs/contacts.md, "Large regions".
#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

#include "collide/solid/epoch_array.h"
#include "collide/solid/regions.h"

namespace otg {

/// A grid of at most 16 x 16 x 16 cells over the bounds of a region.
class RegionGrid {
 public:
  static constexpr std::uint32_t kCells = 4096;
  RegionGrid() = default;
  /// Cells of the region's diagonal / perDiagonal (at most 15).
  RegionGrid(const Region& region, double perDiagonal)
      : lo_(region.lo), scale_(region.diagonal > 0 ? perDiagonal / region.diagonal : 0) {}
  std::uint32_t cell(const Vec3d& p) const {
    return along(p.x - lo_.x) | along(p.y - lo_.y) << 4 | along(p.z - lo_.z) << 8;
  }

 private:
  std::uint32_t along(double x) const {
    const double c = x * scale_;
    return c > 0 ? std::min(15u, static_cast<std::uint32_t>(c)) : 0u;
  }
  Vec3d lo_{};
  double scale_ = 0;
};

/// Sums surface by cell, mesh and main direction.
class PieceCells {
 public:
  void begin(const Region& region);
  /// A part of the surface: where, how it faces, its vector area, area, sum of (normal . x) area, and its bounds.
  /// Parts may be taken off again by negative sums with the same place and direction.
  void add(int mesh, const Vec3d& place, const Vec3d& facing, std::uint32_t triangle, const Vec3d& vector, double area,
           double moment, const Vec3d& lo, const Vec3d& hi);
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
  RegionGrid grid_;
  EpochArray index_;
  std::vector<Sum> sums_;
};

/// A candidate before it is worked out.
struct PointSeed {
  Vec3d position;  ///< relative to the origin
  Vec3d span;      ///< crossings: along the inside stretch of the edge, of its length; else zero
  std::uint32_t region, feature, ordinal, crossing;
  std::uint8_t mesh;
  PointKind kind;
};

/// Keeps of each cell, mesh and kind the point that lies deepest as far as a mean direction can tell.
class PointCells {
 public:
  /// `up`: in which A is pushed.
  void begin(const Region& region, const Vec3d& up);
  void offer(const PointSeed& seed);
  const std::vector<PointSeed>& chosen() const { return chosen_; }

 private:
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
