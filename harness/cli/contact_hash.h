// SPDX-License-Identifier: BSD-3-Clause
// What the benchmarks of dCollide() hash of a contact.
#pragma once

#include <ode/contact.h>

#include "cli/command.h"

namespace otg::cli {

/// Position, normal and depth. The sides, where they count, are added by the caller.
inline void addToHash(Fnv1a& hash, const dContactGeom& contact) {
  for (int k = 0; k < 3; ++k) {
    hash.add(contact.pos[k]);
    hash.add(contact.normal[k]);
  }
  hash.add(contact.depth);
}

}  // namespace otg::cli
