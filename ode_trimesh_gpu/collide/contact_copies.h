// SPDX-License-Identifier: BSD-3-Clause
// Contacts of several regions that say the same.
#pragma once

#include <memory_resource>
#include <vector>

#include "collide/query.h"

namespace otg {

/// Of contacts with one normal at one place keeps the deepest, for all orders of them the same. Parts of a body that
/// share a corner have one there each, and so have regions of a shape that share a wall. The order of the others stays.
/// `size`: of the smaller body; `memory`: for the time being.
void dropCopies(std::vector<Contact>& contacts, double size, std::pmr::memory_resource* memory);

}  // namespace otg
