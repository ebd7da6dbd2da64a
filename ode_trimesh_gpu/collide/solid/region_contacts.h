// SPDX-License-Identifier: BSD-3-Clause
// Contacts of one overlap region: choose places by estimated depth, thin them out, measure those that survive by rays.
#pragma once

#include <vector>

#include "collide/solid/extent.h"
#include "collide/solid/region_normals.h"
#include "collide/solid/regions.h"

namespace otg {

struct RegionTask {
  const PlacedMeshes& meshes;
  const OverlapRegions& all;
  const Region& region;
  std::uint32_t regionIndex;
  const RegionNormals& normals;
  RegionExtent& extent;
  int maxContacts;
  double leastDepth;  ///< of the deepest contact
  double mostDepth;   ///< of any, where that is known; else infinity, and the region's extent limits it
  double extraDepth;  ///< added to the clamp of depths by the region's own extent (escaping bodies: way of one step)
};

/// Whether nothing of the region's surface shows which way is out: its normals cancel each other. In layers of overlap
/// each part of it shows it, as the flanks of a thread do.
bool contradictsItself(const Region& region);

/// Whether the region is far deeper at one place than it is on the whole, or goes round a corner: a thin contact and
/// beside it a wedge or another wall; or thin and coherent nowhere. One direction does not hold for all of it. Regions
/// described by cells never are.
bool isUneven(const Region& region, const RegionNormals& normals, RegionExtent& extent);

/// Appends contacts (frame A), deepest first. Whether the region is uneven.
bool contactsOfRegion(const RegionTask& task, std::vector<Contact>& out);

}  // namespace otg
