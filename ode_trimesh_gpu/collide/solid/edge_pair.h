// SPDX-License-Identifier: BSD-3-Clause
// Overlaps of an edge with an edge: the way out is across both, which no face says.
#pragma once

#include <vector>

#include "collide/solid/regions.h"

namespace otg {

/// Directions across pairs of sharp convex edges in a region that are faces of the Minkowski difference. See Gregorius,
/// "The separating axis test between convex polyhedra" (2013: the arcs of their normals on the unit sphere cross), in
/// the sense in which A gets out of B. None where a side of the region is made of more than the two faces of its edge.
std::pmr::vector<Vec3d> directionsAcross(const PlacedMeshes& meshes, const OverlapRegions& all, const Region& region);

}  // namespace otg
