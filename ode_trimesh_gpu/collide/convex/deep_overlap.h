// SPDX-License-Identifier: BSD-3-Clause
// Convex bodies that are deep in each other.
#pragma once

#include "collide/convex/convex_pair.h"
#include "collide/query.h"

namespace otg {

/// Of a body's width: what a pair remembers may say that an overlap that is deeper ends by another way than the least.
inline constexpr double kMostShallow = 0.5;

/// Whether such an overlap ends by its least way, as far as what the pair remembers shows. A thin plate that falls past
/// the edge of a box is below its top: the least way is back up. One that is more than half through a floor is not to
/// leave it at the bottom. `normal`: out of B, in A's frame. Where nothing is remembered the least way it is. For
/// bodies of which neither is wholly inside the other: those leave by Escape (collide/solid/escape.cpp).
bool endsByLeastWay(const Query& query, const Vec3d& normal);

/// Whether one body is wholly inside the other: all of it is behind each face of that.
bool isContained(const ConvexPair& pair);

}  // namespace otg
