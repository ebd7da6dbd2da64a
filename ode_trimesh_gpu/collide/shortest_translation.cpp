// SPDX-License-Identifier: BSD-3-Clause
#include "collide/shortest_translation.h"

namespace otg {

bool ShortestTranslation::add(const Vec3d& normal, double depth, double longest) {
  if (!satisfies(normal, depth)) {
    const auto count = static_cast<otg_uint>(all_.size());
    Vec3d t{};
    if (otgShortestOnBoundary(all_.data(), count, normal, depth, &t) == 0) return false;
    if (otgDot(t, t) > longest * longest) return false;
    t_ = t;
  }
  all_.push_back({normal, depth});
  return true;
}

}  // namespace otg
