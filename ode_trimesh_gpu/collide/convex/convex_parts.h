// SPDX-License-Identifier: BSD-3-Clause
// Contacts between solids of overlapping components that are all convex: each pair of components as two convex bodies.
#pragma once

#include "collide/query.h"

namespace otg {

/// Contacts of all pairs of parts that touch -> workspace.contacts and workspace.reduced, in the meshes' own numbers of
/// triangles: of a mesh of convex parts (CollisionMesh::parts()) and another one, or one that is convex. Contacts with
/// walls inside are left out, and surfaces ahead are there as in any other query of solids. No triangles are looked at,
/// but for those.
///
/// False, with nothing remembered, for other pairs, and where the stages for any solids have more to say of two parts.
/// May throw std::bad_alloc, and throws what middlePhase throws.
bool convexPartContacts(const Query& query, Workspace& workspace);

/// Whether a pair is one of these, whatever is between its parts. May throw std::bad_alloc.
bool areConvexParts(const Query& query);

/// The whole query at once, as collideConvexPair() does it for two convex meshes.
bool collideConvexParts(const Query& query, Workspace& workspace);

}  // namespace otg
