// SPDX-License-Identifier: BSD-3-Clause
// What of one triangle lies behind another one: within the prism over it, and not in front of its plane.
#pragma once

#include <array>

#include "shared/math/vec3.h"

namespace otg {

struct ClippedTriangle {
  static constexpr int kMost = 7;
  struct Corner {
    Vec3d point;
    bool isCut;  ///< no corner of the triangle that was cut
  };
  std::array<Corner, kMost> corners;
  int count = 0;

  /// Keeps what has normal . (x - on) <= 0.
  void cut(const Vec3d& on, const Vec3d& normal) {
    std::array<Corner, kMost> kept;
    int keptCount = 0;
    for (int i = 0; i < count; ++i) {
      const Corner &from = corners[std::size_t(i)], &to = corners[std::size_t((i + 1) % count)];
      const double a = otgDot(normal, otgSub(from.point, on)), b = otgDot(normal, otgSub(to.point, on));
      if (a <= 0 && keptCount < kMost) kept[std::size_t(keptCount++)] = from;
      if ((a < 0 && b > 0) || (a > 0 && b < 0)) {
        // From the inner end, whichever comes first: both triangles of an edge get one point.
        const Vec3d at = a < 0 ? otgAdd(from.point, otgScale(otgSub(to.point, from.point), a / (a - b)))
                               : otgAdd(to.point, otgScale(otgSub(from.point, to.point), b / (b - a)));
        if (keptCount < kMost) kept[std::size_t(keptCount++)] = {at, true};
      }
    }
    corners = kept;
    count = keptCount;
  }
};

/// `front`: the unit normal of the triangle `of`, to its front; its corners may be wound either way.
inline ClippedTriangle clipBehind(const Vec3d triangle[3], const Vec3d of[3], const Vec3d& front) {
  ClippedTriangle out;
  for (int k = 0; k < 3; ++k) out.corners[std::size_t(out.count++)] = {triangle[k], false};
  out.cut(of[0], front);
  for (int k = 0; k < 3 && out.count > 0; ++k) {
    const Vec3d &p = of[k], &q = of[(k + 1) % 3], &r = of[(k + 2) % 3];
    Vec3d outward = otgCross(otgSub(q, p), front);
    if (otgDot(outward, otgSub(r, p)) > 0) outward = otgScale(outward, -1.0);
    out.cut(p, outward);
  }
  return out;
}

}  // namespace otg
