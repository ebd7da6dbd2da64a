// SPDX-License-Identifier: BSD-3-Clause
#include "collide/solid/region_planes.h"

#include <algorithm>
#include <cmath>

#include "base/flat_map.h"
#include "base/vectors.h"

namespace otg {
namespace {

struct Plane {
  Vec3d normal;
  double offset;
  Vec3d lo, hi;  ///< of the surface that it stands for
};

/// By place and main direction.
std::uint64_t cellKey(const Piece& p, const Vec3d& origin, double cell) {
  const auto coordinate = [&](double lo, double hi, double from) {
    return static_cast<std::uint64_t>(std::max(0.0, (0.5 * (lo + hi) - from) / cell));
  };
  const double n[3] = {p.normal.x, p.normal.y, p.normal.z};
  std::uint64_t axis = 0;
  for (std::uint64_t k = 1; k < 3; ++k) {
    if (std::fabs(n[k]) > std::fabs(n[axis])) axis = k;
  }
  return coordinate(p.lo.x, p.hi.x, origin.x) | coordinate(p.lo.y, p.hi.y, origin.y) << 8 |
         coordinate(p.lo.z, p.hi.z, origin.z) << 16 | (2 * axis + (n[axis] < 0 ? 1 : 0)) << 24;
}

void addPiece(Plane& plane, const Piece& p) {
  plane.normal = otgAdd(plane.normal, p.vector);
  plane.offset += p.offset * norm(p.vector);
  plane.lo = {std::min(plane.lo.x, p.lo.x), std::min(plane.lo.y, p.lo.y), std::min(plane.lo.z, p.lo.z)};
  plane.hi = {std::max(plane.hi.x, p.hi.x), std::max(plane.hi.y, p.hi.y), std::max(plane.hi.z, p.hi.z)};
}

}  // namespace

bool collectPlanes(const OverlapRegions& all, const Region& region, PlaneSet (&surface)[2]) {
  bool gathered = false;
  const double cell = region.diagonal / OTG_SOLID_PLANE_CELLS;
  std::pmr::vector<Plane> planes(all.memory);
  for (int m = 0; m < 2; ++m) {
    planes.clear();
    std::uint32_t count = 0;
    for (std::uint32_t i = region.pieceBegin; i < region.pieceEnd; ++i) count += all.pieces[i].mesh == m;
    planes.reserve(count);
    FlatMap index(all.memory);
    for (std::uint32_t i = region.pieceBegin; i < region.pieceEnd; ++i) {
      const Piece& p = all.pieces[i];
      if (p.mesh != m) continue;
      std::uint32_t slot = static_cast<std::uint32_t>(planes.size());
      if (count > OTG_SOLID_MOST_PLANES) {
        gathered = true;
        slot = index.insert(cellKey(p, region.lo, cell), slot);
      }
      if (slot == planes.size()) planes.push_back({{0, 0, 0}, 0, p.lo, p.hi});
      addPiece(planes[slot], p);
    }
    surface[m].reserve(planes.size());
    for (const Plane& plane : planes) {
      const double length = std::sqrt(otgDot(plane.normal, plane.normal));
      if (!(length > 0)) continue;
      surface[m].add(otgScale(plane.normal, 1 / length), plane.offset / length, plane.lo, plane.hi);
    }
  }
  return gathered;
}

}  // namespace otg
