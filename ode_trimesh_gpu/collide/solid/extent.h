// SPDX-License-Identifier: BSD-3-Clause
// How far a region reaches along a direction.
#pragma once

#include <vector>

#include "collide/simd/surface_kernels.h"
#include "collide/solid/overlap_regions.h"

namespace otg {

class RegionExtent {
 public:
  RegionExtent(const OverlapRegions& all, const Region& region);
  /// Of the region, along a unit direction.
  double along(const Vec3d& direction);
  /// Of its OverlapRegions::points alone: quicker, and in large regions not more than the extent.
  double ofPoints(const Vec3d& direction) const { return points_.extent(direction); }

 private:
  double ofCells(const Vec3d& direction);
  const OverlapRegions& all_;
  const Region& region_;
  PointSet points_;
  BoxSet boxes_;
  std::pmr::vector<double> lo_, hi_;  ///< scratch
  Vec3d last_{0, 0, 0};
  double length_ = 0;  ///< along last_
};

}  // namespace otg
