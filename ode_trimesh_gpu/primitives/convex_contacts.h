// SPDX-License-Identifier: BSD-3-Clause
// A mesh against a convex shape: box, capsule, cylinder, polyhedron.
#pragma once

#include "collide/query.h"
#include "primitives/convex_shape.h"

namespace otg {

/// Contacts -> workspace.reduced, with the mesh's own triangle numbers and kNone for the shape. `query` has the mesh as
/// A, the shape's mesh as B, and everything else as for two meshes.
///
/// Regions of overlap and places of contact are those of the model for two meshes (docs/contacts.md). So is what is
/// done about deep, entangled and contained bodies. Two things are the shape's own. Where the mesh's surface in a
/// region is convex, all contacts get the direction of the least way out, exactly (ConvexPatch). And capsules and
/// cylinders are round: their facets only find the region; places move to the round surface and depths are measured to
/// it, so that they roll.
///
/// A box or polyhedron on a mesh that is convex as a whole is a convex pair instead (collide/convex/).
///
/// Throws what collide() throws.
void convexContacts(const Query& query, const ConvexShape& shape, Workspace& workspace);

}  // namespace otg
