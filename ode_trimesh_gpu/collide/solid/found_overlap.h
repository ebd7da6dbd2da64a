// SPDX-License-Identifier: BSD-3-Clause
// The overlap of two solids as a device describes it (kernels/overlap_*), taken to the regions of the host.
#pragma once

#include <span>

#include "collide/solid/contour.h"
#include "collide/solid/inside.h"
#include "collide/solid/regions.h"
#include "shared/overlap_layout.h"

namespace otg {

/// Views of the device's results. Lists are in no order.
struct FoundOverlap {
  const otg_overlap_state* head = nullptr;
  std::span<const otg_found_cell> cells;
  std::span<const otg_found_inside> vertices, clusters;
  std::span<const otg_found_crossing> crossings;
  std::span<const otg_found_inside> small;
  std::span<const otg_found_point> points;
};

/// Scratch for small regions, which the host describes from their hits.
struct SmallRegions {
  Contour contour;
  InsideFlags inside;
  RegionBuilder builder;
  OverlapRegions regions;
  std::vector<TrianglePair> hits;
};

/// What RegionBuilder makes of the same pair. False if the two disagree about the number of regions.
bool takeOverlap(const PlacedMeshes& meshes, const FoundOverlap& found, SmallRegions& small, OverlapRegions& out);

}  // namespace otg
