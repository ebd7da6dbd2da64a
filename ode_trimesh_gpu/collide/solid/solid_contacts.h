// SPDX-License-Identifier: BSD-3-Clause
// Contact model `solid`: contacts from the overlap of two closed surfaces as a whole. docs/contacts.md has the model.
#pragma once

#include <memory>

#include "collide/query.h"

namespace otg {

/// workspace.intersecting -> workspace.contacts. For two solids, and for a solid with a sheet: a shell whose triangles
/// agree in their winding and share edges by twos at most. A sheet's inside is what lies behind it. False, and no
/// contacts, for other meshes and where the contour does not close because it runs over the sheet's rim.
bool solidContacts(const Query& query, Workspace& workspace);

/// Whether a mesh consists of parts (CollisionMesh::parts()). Only solidContacts() without a description makes contacts
/// of such pairs: each part has its own contour with the other mesh.
bool haveParts(const Query& query);

/// The same where a device has described the overlap: of meshes without components wholly inside the other, whose
/// contour closes. False, and no contacts, where the CPU does not agree with the description.
struct FoundOverlap;
bool solidContactsOf(const Query& query, const FoundOverlap& found, Workspace& workspace);

/// The same where the device has made the contacts of the large regions, too, for motionBefore(query): those of small
/// ones are made here, in their places. False, and nothing remembered, also where a region was left out.
struct FoundContacts;
bool solidContactsOf(const Query& query, const FoundContacts& found, Workspace& workspace);
/// What the pair's motion and history say before the query.
struct PairMotion;
PairMotion motionBefore(const Query& query);

/// For those who compute such contacts elsewhere, with stateBefore(query). Whether what the pair remembers changes
/// nothing, as long as no region is entangled or contained, but for the direction of its last deep region;
bool isUnburdened(const SolidHistory::State& before);
/// which is this, in A's frame, or zero;
Vec3d deepDirectionBefore(const Query& query);
/// and what such a query leaves in query.history, if there is one. `deep`: the direction of its own last deep region,
/// or zero.
void rememberPlain(const Query& query, const SolidHistory::State& before, bool hasContacts, const Vec3d& deep);

}  // namespace otg
