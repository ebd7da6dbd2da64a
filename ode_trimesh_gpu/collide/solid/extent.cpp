// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <limits>

#include "collide/solid/regions.h"

namespace otg {
namespace {

/// Branch and bound over the cells' boxes; the box that reaches farthest first.
double ofCells(const ExtentCells& extents, const Vec3d& origin, const Region& region, const Vec3d& d) {
  const PlacedMeshes meshes(*extents.query);
  const auto bound = [&](const ExtentCells::Cell& c, double sign) {
    const double middle = 0.5 * (d.x * (c.lo.x + c.hi.x) + d.y * (c.lo.y + c.hi.y) + d.z * (c.lo.z + c.hi.z));
    const double half = 0.5 * (std::fabs(d.x) * (c.hi.x - c.lo.x) + std::fabs(d.y) * (c.hi.y - c.lo.y) +
                               std::fabs(d.z) * (c.hi.z - c.lo.z));
    return sign * middle + half;
  };
  double reach[2];
  for (int side = 0; side < 2; ++side) {
    const double sign = side == 0 ? 1 : -1;
    double best = -std::numeric_limits<double>::infinity();
    const auto scan = [&](const ExtentCells::Cell& c) {
      for (std::uint32_t i = c.begin; i < c.end; ++i) {
        const Vec3d p = c.mesh < 0 ? extents.positions[i]
                                   : otgSub(meshes.vertex(c.mesh, meshes.adjacency(c.mesh).clusterVertices[i]), origin);
        best = std::max(best, sign * otgDot(p, d));
      }
    };
    std::uint32_t first = region.cellBegin;
    double farthest = -std::numeric_limits<double>::infinity();
    for (std::uint32_t k = region.cellBegin; k < region.cellEnd; ++k) {
      const double b = bound(extents.cells[k], sign);
      if (b > farthest) {
        farthest = b;
        first = k;
      }
    }
    scan(extents.cells[first]);
    for (std::uint32_t k = region.cellBegin; k < region.cellEnd; ++k) {
      if (k != first && bound(extents.cells[k], sign) > best) scan(extents.cells[k]);
    }
    reach[side] = best;
  }
  return reach[0] + reach[1];
}

}  // namespace

double extentOfPoints(const OverlapRegions& all, const Region& region, const Vec3d& direction) {
  if (region.pointBegin == region.pointEnd) return 0;
  double lo = std::numeric_limits<double>::infinity(), hi = -lo;
  for (std::uint32_t i = region.pointBegin; i < region.pointEnd; ++i) {
    const double x = otgDot(all.points[i].position, direction);
    lo = std::min(lo, x);
    hi = std::max(hi, x);
  }
  return hi - lo;
}

double extentAlong(const OverlapRegions& all, const Region& region, const Vec3d& direction) {
  if (region.cellBegin < region.cellEnd) return ofCells(all.extents, all.origin, region, direction);
  return extentOfPoints(all, region, direction);
}

}  // namespace otg
