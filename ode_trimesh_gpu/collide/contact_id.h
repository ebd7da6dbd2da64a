// SPDX-License-Identifier: BSD-3-Clause
// Names for contacts that stay while the features that they were made from do.
#pragma once

#include <cstdint>

#include "collide/query.h"

namespace otg {

/// Never 0, and different for all contacts of one query, but for two at one crossing of a deep region. Made of the
/// feature's kind and mesh (4 bits). For vertices and edges their number (32 bits) and Contact::ordinal (28 bits)
/// follow, else the two triangles (28 bits each; meshes have no more) and the ordinal (4 bits). Nothing in it
/// depends on places in a list, on the pose or on what else touches.
inline std::uint64_t contactId(const Contact& c) {
  const std::uint64_t kind = (static_cast<std::uint64_t>(c.feature) + 1) << 60;
  if (c.element != kNone) return kind | std::uint64_t{c.element} << 28 | c.ordinal;
  return kind | std::uint64_t{c.triangleA} << 32 | std::uint64_t{c.triangleB} << 4 | c.ordinal;
}

}  // namespace otg
