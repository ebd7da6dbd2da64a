// SPDX-License-Identifier: BSD-3-Clause
// The orders of contacts that every choice between them falls back on.
#pragma once

#include <tuple>

#include "collide/query.h"

namespace otg {

/// By (triangleA, triangleB, feature). One triangle pair may have several contacts of one feature, so the values
/// follow: contacts that compare equal are the same contact, and a choice between them is no choice.
inline bool contactLess(const Contact& x, const Contact& y) {
  const auto key = [](const Contact& c) {
    return std::make_tuple(c.triangleA, c.triangleB, c.feature, -c.depth, c.position.x, c.position.y, c.position.z,
                           c.normal.x, c.normal.y, c.normal.z, c.region);
  };
  return key(x) < key(y);
}

/// Deepest first, ties by contactLess.
inline bool contactDeeper(const Contact& x, const Contact& y) {
  if (x.depth != y.depth) return x.depth > y.depth;
  return contactLess(x, y);
}

}  // namespace otg
