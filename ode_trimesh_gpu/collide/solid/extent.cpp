// SPDX-License-Identifier: BSD-3-Clause
#include "collide/solid/extent.h"

#include <algorithm>
#include <limits>

#include "base/vectors.h"
#include "collide/placed_meshes.h"

namespace otg {

RegionExtent::RegionExtent(const OverlapRegions& all, const Region& region)
    : all_(all), region_(region), points_(all.memory), boxes_(all.memory), lo_(all.memory), hi_(all.memory) {
  points_.reserve(region.pointEnd - region.pointBegin);
  for (std::uint32_t i = region.pointBegin; i < region.pointEnd; ++i) points_.add(all.points[i].position);
  for (std::uint32_t k = region.cellBegin; k < region.cellEnd; ++k) {
    boxes_.add(all.extents.cells[k].lo, all.extents.cells[k].hi);
  }
}

double RegionExtent::along(const Vec3d& direction) {
  if (direction == last_) return length_;
  last_ = direction;
  length_ = region_.cellBegin < region_.cellEnd ? ofCells(direction) : points_.extent(direction);
  return length_;
}

/// Branch and bound over the cells' boxes; the box that reaches farthest first.
double RegionExtent::ofCells(const Vec3d& d) {
  boxes_.ranges(d, lo_, hi_);
  const PlacedMeshes meshes(*all_.extents.query);
  const ExtentCells& extents = all_.extents;
  // Boxes' ranges round, too: none is left out that may hold the farthest point, however they are cut.
  const double slack = 1e-12 * (norm(region_.lo) + norm(region_.hi));
  double reach[2];
  for (int side = 0; side < 2; ++side) {
    double best = -std::numeric_limits<double>::infinity();
    const double sign = side == 0 ? 1 : -1;
    const auto bound = [&](std::size_t k) { return side == 0 ? hi_[k] : -lo_[k]; };
    const auto scan = [&](std::size_t k) {
      const ExtentCells::Cell& c = extents.cells[region_.cellBegin + k];
      for (std::uint32_t i = c.begin; i < c.end; ++i) {
        const Vec3d p = c.mesh < 0 ? extents.positions[i]
                                   : meshes.vertex(c.mesh, meshes.adjacency(c.mesh).clusterVertices[i]) - all_.origin;
        best = std::max(best, sign * otgDot(p, d));
      }
    };
    std::size_t first = 0;
    for (std::size_t k = 1; k < hi_.size(); ++k) {
      if (bound(k) > bound(first)) first = k;
    }
    scan(first);
    for (std::size_t k = 0; k < hi_.size(); ++k) {
      if (k != first && bound(k) > best - slack) scan(k);
    }
    reach[side] = best;
  }
  return reach[0] + reach[1];
}

}  // namespace otg
