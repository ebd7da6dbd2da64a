// SPDX-License-Identifier: BSD-3-Clause
// Contacts between two convex solids: a way of their own in the model `solid`.
#pragma once

#include "collide/query.h"

namespace otg {

/// Whether a query is one of these: of the model `solid`, between two meshes that are convex (CollisionMesh::convex()),
/// and SolidOptions::convexPath is set. May throw std::bad_alloc.
bool isConvexPair(const Query& query);

/// Contacts from the direction of the least overlap, which is the normal of all -> workspace.contacts and
/// workspace.reduced. The latter is the result, with the meshes' own triangle numbers. No triangles are looked at.
/// docs/contacts.md describes the model. Takes memory only where the workspace's is too small. Throws what middlePhase
/// throws.
///
/// False, with nothing remembered, where the stages for any solids have more to say: the overlap is deep, so that more
/// than the shape shows the way out; the pair remembers being entangled; or the bodies touch to rounding, which exact
/// arithmetic decides.
bool convexPairContacts(const Query& query, Workspace& workspace);

/// What the way of convex pairs says of two bodies.
enum class ConvexAnswer : std::uint8_t {
  kApart,
  kTouching,  ///< there are contacts
  kOther      ///< the stages for any solids have more to say
};
/// The first two steps alone, of two meshes that are convex, which no pair remembers: the contacts come after those
/// that are in workspace.contacts. None unless they touch.
ConvexAnswer addConvexContacts(const Query& query, Workspace& workspace);

/// The whole query at once, without the two phases that find triangles: workspace.candidates and workspace.intersecting
/// are left empty. False if it is none of those above.
bool collideConvexPair(const Query& query, Workspace& workspace);

}  // namespace otg
