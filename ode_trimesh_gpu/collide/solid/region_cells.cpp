// SPDX-License-Identifier: BSD-3-Clause
#include "collide/solid/region_cells.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "collide/solid/vectors.h"

namespace otg {
namespace {

// Cells along the region's diagonal: finer than the reach of the local normals (a quarter of it).
constexpr double kPieceGrid = 8, kPointGrid = 6, kExtentGrid = 8;

}  // namespace

void PieceCells::begin(const Region& region) {
  grid_ = RegionGrid(region, kPieceGrid);
  index_.reset(std::size_t{RegionGrid::kCells} * 16);
  sums_.clear();
}

void PieceCells::finish(std::uint32_t region, std::vector<Piece>& out) {
  for (const Sum& sum : sums_) {
    const double length = norm(sum.vector);
    // What was added and taken off again leaves rounding.
    if (!(sum.area > 1e-9 * sum.gross) || !(length > 0)) continue;
    out.push_back({region, sum.triangle, sum.mesh, otgScale(sum.vector, 1 / length), sum.vector, sum.area,
                   sum.moment / length, sum.lo, sum.hi});
  }
}

void PointCells::begin(const Region& region, const Vec3d& up) {
  grid_ = RegionGrid(region, kPointGrid);
  up_ = up;
  index_.reset(std::size_t{RegionGrid::kCells} * 16);
  chosen_.clear();
}

void PointCells::offer(const PointSeed& seed) {
  const std::uint32_t key = keyOf(seed.position, seed.kind, seed.mesh, seed.flat);
  const std::uint32_t known = index_.find(key);
  if (known == EpochArray::kMissing || depth(seed) > depth(chosen_[known])) keep(key, known, seed);
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
