// SPDX-License-Identifier: BSD-3-Clause
// Contacts between a convex mesh and a cylinder, without triangles.
#pragma once

#include "collide/query.h"
#include "primitives/convex_shape.h"
#include "primitives/cylinder_separation.h"

namespace otg {

/// As collideConvexPair(), with the round cylinder in place of query.b, whose mesh is only remembered: the direction of
/// the least overlap is the normal of all contacts. Their depths are those of the round body. False for other shapes
/// and pairs, and where the stages for any solids have more to say.
bool collideCylinder(const Query& query, const ConvexShape& shape, Workspace& workspace);

}  // namespace otg
