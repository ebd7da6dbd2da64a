// SPDX-License-Identifier: BSD-3-Clause
// The direction that a convex pair had at its last query, where it still is the result.
#pragma once

#include "collide/convex/convex_pair.h"
#include "collide/solid_options.h"

namespace otg {

/// Whether leastByPolytope() is sure to return the normal of the same face -> `axis`, with the same bytes. False
/// says nothing. The face has to be far larger around the other body's farthest vertex than the overlap is deep: then
/// no other direction has so small an overlap. All faces beside it must be tilted clearly.
bool isStillLeast(const ConvexPair& pair, const SolidHistory::KeptAxis& kept, double size, ConvexAxis& axis);

/// The body of differences of two bodies has a face with the normal m, at the distance `overlap`. Around the origin's
/// foot it holds a disc of this radius. `far` is its farthest point against m. Whether no other direction has so small
/// an overlap. False says nothing.
bool isLeastAround(const Vec3d& m, double overlap, double radius, const Vec3d& far);
/// Whether all faces beside a face are tilted clearly.
bool isAlone(const ConvexPolyhedron& shape, std::uint32_t face);

/// Whether it is of these very bodies.
bool isOfPair(const ConvexPair& pair, const SolidHistory::KeptAxis& kept);
/// Whether it is of this pose to the last bit, too.
bool isOfPose(const ConvexPair& pair, const SolidHistory::KeptAxis& kept);

}  // namespace otg
