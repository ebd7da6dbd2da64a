// SPDX-License-Identifier: BSD-3-Clause
// Overlaps of an edge with an edge: the way out is across both, which no face says.
#pragma once

#include <optional>
#include <vector>

#include "collide/solid/regions.h"

namespace otg {

/// An edge of A across an edge of B, the faces beside them making up the region.
struct EdgePair {
  Vec3d direction;               ///< unit, across both, in the sense in which A gets out of B
  std::uint32_t pointA, pointB;  ///< the stretches' middles in OverlapRegions::points
  Vec3d placeA, placeB;          ///< where the edges come nearest to each other, on either
};

/// All pairs of sharp convex edges in a region that are faces of the Minkowski difference (Gregorius, "The separating
/// axis test between convex polyhedra", 2013: the arcs of their normals on the unit sphere cross). None where a side of
/// the region is made of more than the two faces of its edge.
std::vector<EdgePair> edgePairs(const PlacedMeshes& meshes, const OverlapRegions& all, const Region& region);

}  // namespace otg
