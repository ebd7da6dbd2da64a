// SPDX-License-Identifier: BSD-3-Clause
#include "ode/geom/mesh_join.h"

#include <cmath>
#include <limits>

#include "base/vectors.h"

namespace otg {
namespace {

/// How far two boxes are apart, squared.
double gap2(const WorldBox& x, const WorldBox& y) {
  const Vec3d apart = maximum(maximum(x.low - y.high, y.low - x.high), {0, 0, 0});
  return otgDot(apart, apart);
}

}  // namespace

WorldBox worldBox(const Vec3d& low, const Vec3d& high, const Transformd& pose) {
  const Vec3d middle = otgTransform(pose, (low + high) * 0.5), half = (high - low) * 0.5;
  const auto reach = [&](int row) {
    const double* const r = pose.r + 3 * row;
    return std::fabs(r[0]) * half.x + std::fabs(r[1]) * half.y + std::fabs(r[2]) * half.z;
  };
  const Vec3d out{reach(0), reach(1), reach(2)};
  return {middle - out, middle + out};
}

std::uint32_t MeshJoin::ownerOf(std::uint32_t callerTriangle, const Transformd& at, const Vec3d& position,
                                const WorldBox& other) const {
  const std::uint32_t own = sourceOf[callerTriangle].part;
  const auto boxOf = [&](std::uint32_t p) { return worldBox(parts[p].low, parts[p].high, at); };
  if (gap2(boxOf(own), other) <= 0) return own;
  std::uint32_t best = own;
  double least = std::numeric_limits<double>::infinity();
  for (std::uint32_t p = 0; p < parts.size(); ++p) {
    const WorldBox box = boxOf(p);
    const double distance = gap2(box, {position, position});
    if (gap2(box, other) <= 0 && distance < least) {
      best = p;
      least = distance;
    }
  }
  return best;
}

}  // namespace otg
