// SPDX-License-Identifier: BSD-3-Clause
// The overlap of two solids as a device describes it (kernels/solid/large/), taken to the regions of the CPU.
#pragma once

#include <span>

#include "collide/query.h"
#include "collide/solid/contour.h"
#include "collide/solid/inside.h"
#include "collide/solid/regions.h"
#include "shared/layout/overlap_contacts_layout.h"

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

/// Scratch for small regions, which the CPU describes from their hits.
struct SmallRegions {
  Contour contour;
  InsideFlags inside;
  RegionBuilder builder;
  OverlapRegions regions;
  std::vector<TrianglePair> hits;
  std::vector<otg_found_inside> shared;  ///< edges and triangles that are crossed in large regions, too
};

/// The contacts that a device made of the large regions (kernels/solid/large/choose.cl). Views of its results.
struct FoundContacts {
  const otg_contacts_head* head = nullptr;
  std::span<const Contact> contacts;  ///< those that regions' `first` numbers, in the meshes' own numbers of triangles
  std::span<const otg_found_inside> small;  ///< hits of small regions
};

/// Whether the description is of no use, because the CPU describes some large region by its single triangles.
bool isApart(const otg_contacts_head& head);

/// Describes the small regions from their hits. False if they are not as many as the device counted, or not for
/// themselves.
bool describeSmall(const PlacedMeshes& meshes, const otg_overlap_state& head, std::span<const otg_found_inside> hits,
                   SmallRegions& small);

/// A region of a pair: a large one by its number in the description, or a small one by that in SmallRegions.
struct FoundRegion {
  std::uint64_t first;  ///< as Region::first
  std::uint32_t number;
  bool isLarge;
};
/// All regions in the CPU's order, after describeSmall().
std::vector<FoundRegion> regionsInOrder(const otg_overlap_state& head, const SmallRegions& small);

/// What RegionBuilder makes of the same pair. False if the two disagree about the number of regions.
bool takeOverlap(const PlacedMeshes& meshes, const FoundOverlap& found, SmallRegions& small, OverlapRegions& out);

}  // namespace otg
