// SPDX-License-Identifier: BSD-3-Clause
// The least overlap of two boxes.
#pragma once

#include "collide/convex/convex_pair.h"

namespace otg {

/// What leastByAxes() returns but for rounding, where both bodies are boxes (ConvexPolyhedron::box()): from middles and
/// halves in place of corners.
/// Source: S. Gottschalk, M. Lin, D. Manocha, "OBBTree", 1996.
ConvexAxis leastOfBoxes(const ConvexPair& pair, double size);

}  // namespace otg
