// SPDX-License-Identifier: BSD-3-Clause
// How the parts of an uneven region leave it: each vertex and each stretch of an edge that lies inside the other mesh,
// by faces of that mesh or across its edges. One short translation shall do it for all.
#pragma once

#include <cstdint>
#include <vector>

#include "collide/solid/region_triangles.h"

namespace otg {

/// One part of a region and a half-space that holds it: A moved along `normal` by `depth` gets it out there.
struct Leave {
  const SupportPoint* point;
  Vec3d at;      ///< of the part the deepest place, relative to OverlapRegions::origin
  Vec3d normal;  ///< unit, out of B
  double depth;
  bool curved;  ///< the face is a facet of a curved surface
};

/// What holds the vertices and stretches among `points` (places in OverlapRegions::points).
///
/// A vertex leaves by the faces on which the nearest place of the other surface lies. A stretch leaves by the face, or
/// across the edge, that is the shortest way out for all of it. Beside a convex edge there are several ways, and the
/// soonest of each part by itself may contradict each other: a bar in a groove of its own length has corners that are
/// nearer to the groove's ends than to its floor. So the deepest part chooses first. Each next one that is not out yet,
/// when A has been moved by the shortest translation that satisfies those before, adds its own. In the end each part is
/// held by the soonest of its ways that this translation satisfies.
std::pmr::vector<Leave> leavesOf(RegionTriangles& triangles, const OverlapRegions& all,
                                 const std::pmr::vector<std::uint32_t>& points);

}  // namespace otg
