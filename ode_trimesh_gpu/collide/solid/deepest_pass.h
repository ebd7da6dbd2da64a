// SPDX-License-Identifier: BSD-3-Clause
// Where edges of two meshes pass each other within an overlap.
#pragma once

#include <optional>

#include "collide/placed_meshes.h"
#include "collide/solid/overlap_regions.h"

namespace otg {

/// Where an edge of A passes one of B, seen along a normal.
struct EdgePass {
  const SupportPoint* point;    ///< the middle of the stretch that A's edge has there, or null
  std::uint32_t edge, ordinal;  ///< of A; of its stretches inside, as SupportPoint::ordinal of a middle
  Vec3d middle, along;          ///< of the stretch; unit direction
  double reach;                 ///< half its length
  double at = 0;                ///< how far from the middle the two pass
  double way = 0;               ///< how deep the overlap is there
};

/// The deepest place where edges pass each other in a region, if it is deeper than `least`; of several the first in the
/// order of A's points. An overlap of facets is deepest there or at a vertex. Flat edges count: bodies at rest overlap
/// by less than their faces are flat. Not looked for where there are many vertices. `normal`: unit, out of B. Only of
/// regions that are described piece by piece.
std::optional<EdgePass> deepestPass(const PlacedMeshes& meshes, const OverlapRegions& all, const Region& region,
                                    const Vec3d& normal, double least);

}  // namespace otg
