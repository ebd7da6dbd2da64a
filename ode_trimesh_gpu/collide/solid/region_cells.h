// SPDX-License-Identifier: BSD-3-Clause
// Large regions in bounded form: their surface, their candidate points and their extent by the cells of a grid over the
// region's bounds. docs/contacts.md, "Large regions".
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include "base/epoch_array.h"
#include "base/vectors.h"
#include "collide/placed_meshes.h"
#include "collide/solid/overlap_regions.h"
#include "mesh/adjacency.h"
#include "shared/contacts/region_grid.h"

namespace otg {

/// Units in which the surface of a region is added up.
struct SurfaceUnits {
  double area = 1, moment = 1;  ///< in one
};

/// A grid of at most 8 x 8 x 8 cells over the bounds of a region.
class RegionGrid {
 public:
  static constexpr std::uint32_t kCells = 512;
  RegionGrid() = default;
  /// Cells of the region's diagonal / perDiagonal (at most 8).
  RegionGrid(const Region& region, double perDiagonal)
      : lo_(region.lo), scale_(region.diagonal > 0 ? perDiagonal / region.diagonal : 0) {}
  std::uint32_t cell(const Vec3d& p) const { return otgGridCell(p, lo_, scale_); }

 private:
  Vec3d lo_{};
  double scale_ = 0;
};

/// Surface, added up in whole units: in any order the same.
struct SurfaceSum {
  otg_long vector[3] = {0, 0, 0};
  otg_long area = 0, gross = 0, moment = 0;  ///< gross: of areas without their signs

  void add(const Vec3d& v, double ofArea, double ofMoment, const SurfaceUnits& units) {
    const otg_long more = otgInUnits(ofArea, units.area);
    vector[0] = otgAddUnits(vector[0], otgInUnits(v.x, units.area));
    vector[1] = otgAddUnits(vector[1], otgInUnits(v.y, units.area));
    vector[2] = otgAddUnits(vector[2], otgInUnits(v.z, units.area));
    area = otgAddUnits(area, more);
    gross = otgAddUnits(gross, more < 0 ? -more : more);
    moment = otgAddUnits(moment, otgInUnits(ofMoment, units.moment));
  }
  void add(const SurfaceSum& more) {
    for (int k = 0; k < 3; ++k) vector[k] = otgAddUnits(vector[k], more.vector[k]);
    area = otgAddUnits(area, more.area);
    gross = otgAddUnits(gross, more.gross);
    moment = otgAddUnits(moment, more.moment);
  }
  Vec3d vectorIn(const SurfaceUnits& units) const {
    return {otgFromUnits(vector[0], units.area), otgFromUnits(vector[1], units.area),
            otgFromUnits(vector[2], units.area)};
  }
};

/// Sums surface by cell, mesh and main direction. In whatever order parts are added, the outcome is the same.
class PieceCells {
 public:
  void begin(const Region& region, const SurfaceUnits& units);
  /// A part of the surface: where, how it faces, its vector area, area, sum of (normal . x) area, and its bounds.
  /// Parts may be taken off again by negative sums with the same place and direction. `name`: see ofTriangle and
  /// ofVertex.
  void add(int mesh, const Vec3d& place, const Vec3d& facing, std::uint32_t name, const Vec3d& vector, double area,
           double moment, const Vec3d& lo, const Vec3d& hi) {
    const std::uint32_t key = grid_.cell(place) * 16 + otgMainDirection(facing) * 2 + static_cast<std::uint32_t>(mesh);
    std::uint32_t i = index_.find(key);
    if (i == EpochArray::kMissing) {
      i = static_cast<std::uint32_t>(cells_.size());
      index_.set(key, i);
      cells_.push_back({{}, lo, hi, key, name});
    }
    Cell& cell = cells_[i];
    cell.sum.add(vector, area, moment, units_);
    cell.lo = minimum(cell.lo, lo);
    cell.hi = maximum(cell.hi, hi);
    cell.name = std::min(cell.name, name);
  }
  /// Names for parts; a cell is named by the smallest of them.
  static std::uint32_t ofTriangle(std::uint32_t triangle) { return triangle; }
  static std::uint32_t ofVertex(std::uint32_t vertex) { return vertex | OTG_NAME_OF_VERTEX; }

  struct Cell {
    SurfaceSum sum;
    Vec3d lo, hi;
    std::uint32_t key, name;
    int mesh() const { return static_cast<int>(key & 1); }
  };
  /// All that hold anything, by key.
  const std::vector<Cell>& cells();

 private:
  RegionGrid grid_;
  SurfaceUnits units_;
  EpochArray index_;
  std::vector<Cell> cells_;
};

/// The units for a region of so many vertices and chords, whose bounds are known. `largest`: an area that none of its
/// parts exceeds, or hardly.
SurfaceUnits surfaceUnits(std::uint32_t load, double largest, const Region& region);

/// Appends the piece that stands for a cell, unless it holds rounding alone.
void addPieceOfCell(const PlacedMeshes& meshes, const PieceCells::Cell& cell, std::uint32_t region,
                    const SurfaceUnits& units, std::vector<Piece>& out);

/// The surface of a region: of cells, or of pieces in an order that is always the same.
class RegionSums {
 public:
  void add(int mesh, const Vec3d& vector, double area, double moment) {
    vector_[mesh] = vector_[mesh] + vector;
    area_[mesh] += area;
    moment_ += moment;
  }
  void add(const PieceCells::Cell& cell, const SurfaceUnits& units);
  const Vec3d& vector(int mesh) const { return vector_[mesh]; }
  /// What the sums say of the region whose bounds are known.
  void measure(Region& region) const;

 private:
  Vec3d vector_[2] = {{0, 0, 0}, {0, 0, 0}};
  double area_[2] = {0, 0};
  double moment_ = 0;  ///< sum of (normal . x) area
  SurfaceSum units_[2];
};

struct PartBox {
  Vec3d lo, hi;
};
/// Encloses the vertices of a cluster, relative to the origin; not tight where B is turned.
PartBox boxOfCluster(const PlacedMeshes& meshes, int mesh, const Adjacency::Cluster& cluster, const Vec3d& origin);

/// A candidate before it is worked out.
struct PointSeed {
  Vec3d position;  ///< relative to the origin
  Vec3d span;      ///< crossings: along the inside stretch of the edge, of its length; middles: half of that; else zero
  std::uint32_t region, feature, ordinal, crossing;
  std::uint8_t mesh;
  PointKind kind;
  bool flat;
};

/// Keeps of each cell, mesh and kind, flat or not, the point that lies deepest as far as a mean direction can show; of
/// those that lie equally deep the one of the smallest feature and ordinal. So the order of offers is of no account.
class PointCells {
 public:
  /// `up`: in which A is pushed.
  void begin(const Region& region, const Vec3d& up);
  void offer(const PointSeed& seed);
  /// As if every vertex of a cluster lay in the middle of it: offers the deepest that is flat and the deepest that is
  /// not. [lo, hi] are their bounds, vertex(i) is the position of number cluster.first <= i < end, name(i) the vertex.
  template <class Vertex, class NameOf, class IsFlat, class MakeSeed>
  void offerDeepest(int mesh, const Vec3d& lo, const Vec3d& hi, const Adjacency::Cluster& cluster, std::uint32_t end,
                    const Vertex& vertex, const NameOf& name, const IsFlat& isFlat, const MakeSeed& makeSeed) {
    const Vec3d middle = (lo + hi) * 0.5, half = (hi - lo) * 0.5;
    const std::uint32_t key[2] = {keyOf(middle, PointKind::kVertex, mesh, false),
                                  keyOf(middle, PointKind::kVertex, mesh, true)};
    const bool any[2] = {cluster.anyCorner, cluster.anyFlat};
    std::uint32_t known[2] = {EpochArray::kMissing, EpochArray::kMissing}, named[2] = {kNone, kNone};
    double best[2] = {1e300, 1e300};  // what there is none of cannot win
    for (int flat = 0; flat < 2; ++flat) {
      if (!any[flat]) continue;
      known[flat] = index_.find(key[flat]);
      best[flat] = -1e300;
      if (known[flat] == EpochArray::kMissing) continue;
      best[flat] = depth(chosen_[known[flat]].seed);
      named[flat] = chosen_[known[flat]].seed.feature;
    }
    const double sign = mesh == 0 ? -1 : 1;
    const double reach = std::fabs(up_.x) * half.x + std::fabs(up_.y) * half.y + std::fabs(up_.z) * half.z;
    // The bound rounds, too.
    if (sign * otgDot(up_, middle) + reach + 1e-12 * (reach + norm(middle)) < std::min(best[0], best[1])) return;
    std::uint32_t deepest[2] = {end, end};
    for (std::uint32_t i = cluster.first; i < end; ++i) {
      const double d = sign * otgDot(up_, vertex(i));
      if (!(d >= std::min(best[0], best[1]))) continue;
      const int flat = any[0] && (!any[1] || !isFlat(i)) ? 0 : 1;
      if (!(d > best[flat] || (d == best[flat] && name(i) < named[flat]))) continue;
      best[flat] = d;
      named[flat] = name(i);
      deepest[flat] = i;
    }
    for (int flat = 0; flat < 2; ++flat) {
      if (deepest[flat] < end) keep(key[flat], known[flat], makeSeed(deepest[flat]));
    }
  }
  struct Chosen {
    std::uint32_t key;
    PointSeed seed;
  };
  /// By key.
  const std::vector<Chosen>& chosen();

 private:
  std::uint32_t keyOf(const Vec3d& place, PointKind kind, int mesh, bool flat) const {
    return grid_.cell(place) * 16 + static_cast<std::uint32_t>(kind) * 4 + static_cast<std::uint32_t>(mesh) * 2 +
           (flat ? 1 : 0);
  }
  void keep(std::uint32_t key, std::uint32_t known, const PointSeed& seed) {
    if (known != EpochArray::kMissing) {
      chosen_[known].seed = seed;
      return;
    }
    index_.set(key, static_cast<std::uint32_t>(chosen_.size()));
    chosen_.push_back({key, seed});
  }
  double depth(const PointSeed& s) const { return (s.mesh == 0 ? -1 : 1) * otgDot(up_, s.position); }
  RegionGrid grid_;
  Vec3d up_{};
  EpochArray index_;
  std::vector<Chosen> chosen_;
};

/// Counting sort of positions into the cells of a grid, with tight boxes.
void addExtentCells(Region& region, const std::vector<Vec3d>& positions, std::vector<std::uint32_t>& scratch,
                    ExtentCells& out);

}  // namespace otg
