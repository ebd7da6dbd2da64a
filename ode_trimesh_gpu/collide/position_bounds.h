// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <limits>
#include <span>

#include "collide/query.h"

namespace otg {

/// Bounds of the contacts' positions rounded to single precision (see shared/contacts/contact_choice.h).
struct PositionBounds {
  float low[3], high[3];

  explicit PositionBounds(std::span<const Contact> contacts) {
    std::fill(std::begin(low), std::end(low), std::numeric_limits<float>::infinity());
    std::fill(std::begin(high), std::end(high), -std::numeric_limits<float>::infinity());
    for (const Contact& c : contacts) {
      const float p[3] = {static_cast<float>(c.position.x), static_cast<float>(c.position.y),
                          static_cast<float>(c.position.z)};
      for (int k = 0; k < 3; ++k) {
        low[k] = std::min(low[k], p[k]);
        high[k] = std::max(high[k], p[k]);
      }
    }
  }
};

}  // namespace otg
