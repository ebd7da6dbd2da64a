// SPDX-License-Identifier: BSD-3-Clause
// Closed meshes that are wound inward: bodies to what is outside of them, rooms to what is inside.
#pragma once

#include "bvh/collision_mesh.h"
#include "collide/solid_options.h"

namespace otg {

/// The body that such a mesh is when it is turned round, if the other one of the pair is outside. Null if that is
/// inside, and for all other meshes. `middle`: that of the other one, in the mesh's frame. What the pair remembers of
/// the last query decides first: a body that is half through a wall is still where it came from. May throw
/// std::bad_alloc.
const CollisionMesh* bodyFromOutside(const CollisionMesh& mesh, const SolidHistory::State& before, const Vec3d& middle);

/// Of the size that stateBefore() takes: what moves by less than its size has not jumped from one side to the other.
inline constexpr double kFarFromSide = 4;

/// After a query with that body, for the next one.
void rememberOutside(const Transformd& bInA, SolidHistory& history);
/// After any query with such a mesh. `before`: what the side was decided by. Contacts forget sooner, but a query at the
/// same pose is to decide by the same.
void rememberSideBefore(const SolidHistory::State& before, SolidHistory& history);

}  // namespace otg
