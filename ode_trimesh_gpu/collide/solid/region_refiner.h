// SPDX-License-Identifier: BSD-3-Clause
// Who knows more of mesh B than its triangles say.
#pragma once

#include <cstddef>
#include <vector>

#include "collide/solid/escape.h"

namespace otg {

/// Called for each region of a query that names one (Query::refiner), one after the other.
class RegionRefiner {
 public:
  virtual ~RegionRefiner() = default;
  /// Before the region's contacts are made, when their directions are known: may fix another one. Returns
  /// whether it has.
  virtual bool direct(const PlacedMeshes& meshes, const OverlapRegions& all, const Region& region,
                      const RegionDirection& direction, RegionNormals& normals) = 0;
  /// After: the region's contacts are those from `first` on. May change, add and remove them.
  virtual void refine(std::vector<Contact>& contacts, std::size_t first) = 0;
};

}  // namespace otg
