// SPDX-License-Identifier: BSD-3-Clause
#include "collide/solid/facing_pieces.h"

namespace otg {

FacingPieces::FacingPieces(const OverlapRegions& all, const Region& region)
    : planes_{PlaneSet(all.memory), PlaneSet(all.memory)},
      triangles_{std::pmr::vector<std::uint32_t>(all.memory), std::pmr::vector<std::uint32_t>(all.memory)} {
  for (int m = 0; m < 2; ++m) {
    planes_[m].reserve(region.pieceEnd - region.pieceBegin);
    triangles_[m].reserve(region.pieceEnd - region.pieceBegin);
  }
  for (std::uint32_t i = region.pieceBegin; i < region.pieceEnd; ++i) {
    const Piece& p = all.pieces[i];
    planes_[p.mesh].add(p.normal, p.offset, p.lo, p.hi);
    triangles_[p.mesh].push_back(p.triangle);
  }
}

std::uint32_t FacingPieces::triangleOf(int mesh, const Vec3d& point, const Vec3d& direction) const {
  const std::pmr::vector<std::uint32_t>& triangles = triangles_[mesh];
  if (triangles.empty()) return 0;
  const std::uint32_t facing = planes_[mesh].facing(point, direction);
  return facing < triangles.size() ? triangles[facing] : triangles.back();
}

}  // namespace otg
