// SPDX-License-Identifier: BSD-3-Clause
#include "collide/solid/region_cells.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/vectors.h"

namespace otg {
namespace {

constexpr double kExtentGrid = 8;

}  // namespace

void PieceCells::begin(const Region& region, const SurfaceUnits& units) {
  grid_ = RegionGrid(region, OTG_PIECE_GRID);
  units_ = units;
  index_.reset(OTG_GRID_KEYS);
  cells_.clear();
}

const std::vector<PieceCells::Cell>& PieceCells::cells() {
  std::sort(cells_.begin(), cells_.end(), [](const Cell& x, const Cell& y) { return x.key < y.key; });
  return cells_;
}

SurfaceUnits surfaceUnits(std::uint32_t load, double largest, const Region& region) {
  const otg_int count = otgTermBits(load), area = otgBitsOf(largest);
  return {otgUnitsInOne(count, area), otgUnitsInOne(count, otgMomentBits(area, region.lo, region.hi))};
}

void addPieceOfCell(const PlacedMeshes& meshes, const PieceCells::Cell& cell, std::uint32_t region,
                    const SurfaceUnits& units, std::vector<Piece>& out) {
  const Vec3d vector = cell.sum.vectorIn(units);
  const double area = otgFromUnits(cell.sum.area, units.area), gross = otgFromUnits(cell.sum.gross, units.area);
  const double length = norm(vector);
  // What was added and taken off again leaves rounding.
  if (!(area > 1e-9 * gross) || !(length > 0)) return;
  std::uint32_t triangle = cell.name;
  if ((cell.name & OTG_NAME_OF_VERTEX) != 0) {
    const Adjacency& adjacency = meshes.adjacency(cell.mesh());
    triangle = adjacency.halfEdges[adjacency.first[cell.name & ~OTG_NAME_OF_VERTEX]] / 3;
  }
  const Vec3d zero{0, 0, 0};  // -0 and 0 are one bound
  out.push_back({region, triangle, static_cast<std::uint8_t>(cell.mesh()), vector * (1 / length), vector, area,
                 otgFromUnits(cell.sum.moment, units.moment) / length, cell.lo + zero, cell.hi + zero});
}

void RegionSums::add(const PieceCells::Cell& cell, const SurfaceUnits& units) {
  units_[cell.mesh()].add(cell.sum);
  for (int m = 0; m < 2; ++m) {
    vector_[m] = units_[m].vectorIn(units);
    area_[m] = otgFromUnits(units_[m].area, units.area);
  }
  moment_ = otgFromUnits(otgAddUnits(units_[0].moment, units_[1].moment), units.moment);
}

void RegionSums::measure(Region& region) const {
  const RegionMeasure<double> m =
      otgMeasureRegion(vector_[0], vector_[1], area_[0], area_[1], moment_, region.lo, region.hi);
  region.areaA = area_[0];
  region.areaB = area_[1];
  region.volume = m.volume;
  region.push = m.push;
  region.thickness = m.thickness;
  region.coherence = m.coherence;
  region.bad = m.bad != 0;
}

PartBox boxOfCluster(const PlacedMeshes& meshes, int m, const Adjacency::Cluster& cluster, const Vec3d& origin) {
  const Vec3d lo{cluster.lo.x, cluster.lo.y, cluster.lo.z}, hi{cluster.hi.x, cluster.hi.y, cluster.hi.z};
  if (m == 0) return {lo - origin, hi - origin};
  const Vec3d middle = meshes.fromLocal(m, (lo + hi) * 0.5) - origin;
  const Vec3d half = (hi - lo) * 0.5;
  const double* r = meshes.query().bInA.r;
  const auto along = [&](int row) {
    return std::fabs(r[3 * row]) * half.x + std::fabs(r[3 * row + 1]) * half.y + std::fabs(r[3 * row + 2]) * half.z;
  };
  const Vec3d reach{along(0), along(1), along(2)};
  return {middle - reach, middle + reach};
}

void PointCells::begin(const Region& region, const Vec3d& up) {
  grid_ = RegionGrid(region, OTG_POINT_GRID);
  up_ = up;
  index_.reset(OTG_GRID_KEYS);
  chosen_.clear();
}

void PointCells::offer(const PointSeed& seed) {
  const std::uint32_t key = keyOf(seed.position, seed.kind, seed.mesh, seed.flat);
  const std::uint32_t known = index_.find(key);
  if (known != EpochArray::kMissing) {
    const PointSeed& other = chosen_[known].seed;
    const double mine = depth(seed), theirs = depth(other);
    const bool isBefore = seed.feature != other.feature ? seed.feature < other.feature : seed.ordinal < other.ordinal;
    if (!(mine > theirs || (mine == theirs && isBefore))) return;
  }
  keep(key, known, seed);
}

const std::vector<PointCells::Chosen>& PointCells::chosen() {
  std::sort(chosen_.begin(), chosen_.end(), [](const Chosen& x, const Chosen& y) { return x.key < y.key; });
  return chosen_;
}

void addExtentCells(Region& region, const std::vector<Vec3d>& positions, std::vector<std::uint32_t>& scratch,
                    ExtentCells& out) {
  const RegionGrid grid(region, kExtentGrid);
  scratch.assign(RegionGrid::kCells + 1, 0);
  for (const Vec3d& p : positions) ++scratch[grid.cell(p) + 1];
  const double inf = std::numeric_limits<double>::infinity();
  const auto first = static_cast<std::uint32_t>(out.cells.size());
  auto at = static_cast<std::uint32_t>(out.positions.size());
  for (std::uint32_t c = 0; c < RegionGrid::kCells; ++c) {
    const std::uint32_t count = scratch[c + 1];
    scratch[c] = at;
    if (count == 0) continue;
    out.cells.push_back({{inf, inf, inf}, {-inf, -inf, -inf}, at, at + count, -1});
    at += count;
  }
  region.cellEnd = static_cast<std::uint32_t>(out.cells.size());
  out.positions.resize(at);
  for (const Vec3d& p : positions) out.positions[scratch[grid.cell(p)]++] = p;
  for (std::uint32_t k = first; k < region.cellEnd; ++k) {
    ExtentCells::Cell& cell = out.cells[k];
    for (std::uint32_t i = cell.begin; i < cell.end; ++i) {
      cell.lo = minimum(cell.lo, out.positions[i]);
      cell.hi = maximum(cell.hi, out.positions[i]);
    }
  }
}

}  // namespace otg
