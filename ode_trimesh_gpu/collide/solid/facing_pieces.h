// SPDX-License-Identifier: BSD-3-Clause
// Through which piece of a region's surface a contact's normal leaves.
#pragma once

#include <cstdint>
#include <memory_resource>
#include <vector>

#include "collide/simd/surface_kernels.h"
#include "collide/solid/overlap_regions.h"

namespace otg {

class FacingPieces {
 public:
  FacingPieces(const OverlapRegions& all, const Region& region);

  /// The triangle of the piece of a mesh whose plane is the nearest ahead of a point along a direction; any where none
  /// faces along, 0 without pieces.
  std::uint32_t triangleOf(int mesh, const Vec3d& point, const Vec3d& direction) const;

 private:
  PlaneSet planes_[2];  ///< of each mesh's pieces
  std::pmr::vector<std::uint32_t> triangles_[2];
};

}  // namespace otg
