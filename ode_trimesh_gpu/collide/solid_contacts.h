// SPDX-License-Identifier: BSD-3-Clause
// Contact model `solid`: contacts from the overlap of two closed surfaces as a whole. docs/contacts.md tells the model.
#pragma once

#include <memory>

#include "collide/query.h"

namespace otg {

/// workspace.intersecting -> workspace.contacts. Both meshes must be solids.
void solidContacts(const Query& query, Workspace& workspace);

}  // namespace otg
