// SPDX-License-Identifier: BSD-3-Clause
// Joining geoms, and their pairs while they are joined.
#pragma once

#include <span>
#include <vector>

#include "collide/query.h"
#include "ode/geom/mesh_side.h"

namespace otg {

/// Joins geoms that are alive and have meshes, and forgets what they were joined to before. `placed`: as many. Returns
/// how many of them are joined to another one now. May throw std::bad_alloc, after which nothing has changed.
int joinGeoms(std::span<MeshGeom> geoms, std::span<const WorldPose> poses);
/// Puts the whole surface, and its pose, in place of the mesh of a geom that is joined. Not where callbacks are called
/// for triangles.
void enterJoin(MeshGeom& side, WorldPose& pose);

/// Takes out contacts that belong to other geoms of a join, and numbers the geom's triangles as the callers of its own
/// mesh do. `sideOf`: 0 if the geom's mesh is A of the contacts, else 1. `frame`: theirs to the world. `at`: the pose
/// that enterJoin() gave. `other`: the box of the geom that it meets. Returns whether any was taken out.
bool keepOwn(const MeshGeom& side, int sideOf, const Transformd& frame, const Transformd& at, const WorldBox& other,
             std::vector<Contact>& contacts);

}  // namespace otg
