// SPDX-License-Identifier: BSD-3-Clause
// The least overlap of two polyhedra of few faces, by trying all directions that it can have.
#pragma once

#include "collide/convex/convex_pair.h"

namespace otg {

/// Whether so few directions have to be tried that this is the quickest way.
bool haveFewAxes(const ConvexPair& pair);

/// The normals of both bodies' faces, and the products of their edges. `size`: of the bodies together.
/// Source: S. Gottschalk, M. Lin, D. Manocha, "OBBTree", 1996.
ConvexAxis leastByAxes(const ConvexPair& pair, double size);

}  // namespace otg
