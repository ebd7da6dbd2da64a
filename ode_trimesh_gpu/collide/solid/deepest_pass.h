// SPDX-License-Identifier: BSD-3-Clause
// Where edges of two meshes pass each other within an overlap.
#pragma once

#include <optional>

#include "collide/solid/overlap_regions.h"

namespace otg {

/// Where an edge of A passes one of B, seen along a normal.
struct EdgePass {
  const SupportPoint* stretch;  ///< that A's edge has there; null: the edge is inside from end to end
  std::uint32_t edge;           ///< of A
  Vec3d middle, along;          ///< of its part inside; unit direction
  double reach;                 ///< half the length of that
  double at;                    ///< how far from the middle the two pass
  double way;                   ///< how deep the overlap is there
};

/// The deepest place where edges pass each other in a region, if it is deeper than `least`; of several the first in the
/// order of A's points. An overlap of facets is deepest there or at a vertex. Not looked for where no edge is inside
/// from end to end, as all others are candidates, nor where there are many. `normal`: unit, out of B. Only of regions
/// that are described piece by piece.
std::optional<EdgePass> deepestPass(const PlacedMeshes& meshes, const OverlapRegions& all, const Region& region,
                                    const Vec3d& normal, double least);

}  // namespace otg
