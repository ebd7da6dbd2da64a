// SPDX-License-Identifier: BSD-3-Clause
// Contacts of a convex shape with what is near it of a mesh's surface, without the shape's triangles.
#pragma once

#include "collide/query.h"
#include "primitives/convex_shape.h"

namespace otg {

/// Where the shape is on faces (face_contacts.h) or on a smooth surface (smooth_contacts.h): their contacts ->
/// workspace.contacts and workspace.reduced. False, with nothing remembered, for other places, shapes and pairs, and
/// where the pair remembers being behind the surface or entangled: there the stages for any solids have more to say.
bool collideSurface(const Query& query, const ConvexShape& shape, Workspace& workspace);

}  // namespace otg
