// SPDX-License-Identifier: BSD-3-Clause
// The least overlap of two polyhedra of many faces.
#pragma once

#include "collide/convex/convex_pair.h"

namespace otg {

/// A polytope grows inside the body of differences, face by face towards the origin, until its nearest face is one of
/// the body's. The origin may begin outside: distances of faces have a sign, and a direction with a negative overlap
/// says that the bodies are apart. Then the normals of faces of both bodies nearest to the direction are preferred.
/// `toB`: from the middle of A to the middle of B, where the search begins; `size`: of the bodies together. Takes no
/// memory. Where rounding or the number of steps ends the search early, the overlap is that of the best direction so
/// far. That direction separates, too.
///
/// Source: G. van den Bergen, "Proximity queries and penetration depth computation on 3D game objects", 2001.
ConvexAxis leastByPolytope(const ConvexPair& pair, const Vec3d& toB, double size);

/// The face at a body's farthest vertex along a direction that faces most along it.
std::uint32_t facingFace(const ConvexPair& pair, int body, const Vec3d& direction);

}  // namespace otg
