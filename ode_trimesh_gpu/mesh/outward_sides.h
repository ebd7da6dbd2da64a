// SPDX-License-Identifier: BSD-3-Clause
// Meshes that would be solids but for a few faults, as many models have.
#pragma once

#include <cstdint>
#include <vector>

#include "mesh/tri_mesh.h"

namespace otg {

struct OutwardSides {
  std::vector<std::int8_t> each;
  /// No vertex counts but those of rims: edges of one triangle, of more than two, and of two wound against each other.
  bool areOfRims = false;
};

/// Of each triangle +1 where its normal leads out of the body, and -1 where it has been turned round. Empty for solids,
/// and for meshes that mending makes no solid of.
///
/// To mend is to leave out later copies of triangles, and to turn triangles all of whose neighbours are wound against
/// them. Cracks are closed, where vertices lie on an edge of the neighbour. Holes of three edges are filled, unless
/// they are a twentieth of the surface. A larger hole may be meant: bodies may be on both sides of a vessel. Cracks and
/// holes may meet in vertices. The cost is that of a build where there is something to mend. Else it is linear time,
/// but for the sorting of rims.
OutwardSides outwardSides(const TriMesh& mesh);

}  // namespace otg
