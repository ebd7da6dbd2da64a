// SPDX-License-Identifier: BSD-3-Clause
// Which contacts belong to one connected overlap.
#pragma once

#include "collide/query.h"

namespace otg {

/// Fills Contact::region of workspace.contacts. Two intersecting triangle pairs are connected when their A triangles
/// are equal or share an edge and so do their B triangles; a region is a connected component of workspace.intersecting
/// (which must be ascending and hold every contact's pair). Regions that have a contact are numbered from 0 in the
/// order of their smallest pairs.
void assignRegions(const Query& query, Workspace& workspace);

}  // namespace otg
