// SPDX-License-Identifier: BSD-3-Clause
// Regions of contact of one pair that lie close together as one.
#pragma once

#include <vector>

#include "collide/query.h"

namespace otg {

/// Two regions count as one if contacts of both are at most `distance` (>= 0, frame A) apart, with normals within 18
/// degrees; so do regions that a chain of such pairs joins. They get one number, counted in the order of their first
/// contacts, and together no more than `most` contacts (limitContacts). Other contacts stay as they are. Contacts of
/// one region follow each other, before and after.
void mergeRegions(double distance, int most, std::vector<Contact>& contacts);

}  // namespace otg
