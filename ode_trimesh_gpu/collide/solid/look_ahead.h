// SPDX-License-Identifier: BSD-3-Clause
// Surfaces that a body meets on the way which its contacts request.
#pragma once

#include <optional>
#include <span>

#include "collide/query.h"
#include "shared/contacts/uneven_model.h"

namespace otg {

/// A pair is looked at a little farther on than contacts request: there surfaces that lie on each other are apart.
inline constexpr double kFartherAhead = 1.02;
/// How often it is looked at, at most.
inline constexpr int kLooksAhead = 3;
/// The way is so many times the deepest contact, at most: as the translation that parts of a region request.
inline constexpr double kLongestAhead = OTG_UNEVEN_LONGEST;

/// Whether a mesh has hollows: concave edges that are no curve's, or gaps between its components. Elsewhere a second
/// surface as near as the overlap is deep is rare.
bool isCornered(const CollisionMesh* mesh);

/// Whether lookAhead() is worth its time for a pair of meshes: one of them has hollows, and both are small.
bool mayMeetAhead(const Query& query);

/// Completes the contacts in workspace.contacts, which are those of `solid`.
///
/// Contacts describe surfaces that are touched. The shortest translation that they request may end too soon, or lead
/// into another surface, such as the second wall of an inner corner. So the pair is looked at as it is after that
/// translation. What the model says there becomes contacts here: along the same normals, as deep as the translation and
/// what is missing after it are together. This is repeated until nothing is met.
///
/// The pairs of triangles that are near each other decide whether it is begun. They are those of
/// workspace.candidates; where that is empty, they are looked for.
void lookAhead(const Query& query, Workspace& workspace);

/// B in A's frame after A has gone the way that these contacts request, in any order; none where they give none.
/// Where the meshes do not intersect there, lookAhead() adds nothing. For those who make contacts elsewhere.
std::optional<Transformd> poseAhead(const Query& query, std::span<const Contact> contacts, Workspace& workspace);

}  // namespace otg
