// SPDX-License-Identifier: BSD-3-Clause
// Overlaps of an edge with an edge: the way out is across both, which no face says.
#pragma once

#include <vector>

#include "collide/solid/regions.h"

namespace otg {

/// A convex edge of A across one of B: a face of the Minkowski difference (shared/contacts/edge_pair.h).
struct EdgePair {
  Vec3d direction;  ///< across both; in the sense in which A gets out of B
  double depth;     ///< how far A goes along it to get past B's edge
  bool isAll;       ///< the region is made of the two faces of either edge and of nothing else: it is left like that
};

/// The pairs of edges in a region: those that are all of it, or any where the overlap is a lump.
std::pmr::vector<EdgePair> edgePairsOf(const PlacedMeshes& meshes, const OverlapRegions& all, const Region& region);

/// Of the pairs that are all of their region the one that is left soonest; null if there are none.
const EdgePair* wholePair(const std::pmr::vector<EdgePair>& pairs);

}  // namespace otg
