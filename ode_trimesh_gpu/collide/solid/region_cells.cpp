// SPDX-License-Identifier: BSD-3-Clause
#include "collide/solid/region_cells.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "collide/solid/vectors.h"

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
