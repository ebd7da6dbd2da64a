// SPDX-License-Identifier: BSD-3-Clause
// Makes the connected overlap regions of two solids.
//
// Cost is linear in the triangles inside. What later stages look at is bounded: a region of more than kLargeRegion
// triangles and vertices is described by the cells of a grid instead (solid/region_cells.h), unless it is uneven.
#pragma once

#include <memory>

#include "collide/solid/contour.h"
#include "collide/solid/inside.h"
#include "collide/solid/overlap_regions.h"

namespace otg {

struct RegionScratch;

/// Makes the regions of one overlap after another; keeps its memory between them.
class RegionBuilder {
 public:
  RegionBuilder();
  ~RegionBuilder();
  RegionBuilder(const RegionBuilder&) = delete;
  RegionBuilder& operator=(const RegionBuilder&) = delete;
  void build(const PlacedMeshes& meshes, const Contour& contour, const InsideFlags& inside, OverlapRegions& out);
  /// The same for a part of a contour, relative to an origin that belongs to all of it.
  void build(const PlacedMeshes& meshes, const Contour& contour, const InsideFlags& inside, const Vec3d& origin,
             OverlapRegions& out);

 private:
  std::unique_ptr<RegionScratch> scratch_;
};

/// Whether a region that is described by cells goes round a corner and is small enough to be described by its single
/// triangles instead. `load`: its vertices and clipped triangles.
bool needsTriangles(const OverlapRegions& all, const Region& region, std::uint32_t load);

}  // namespace otg
