// SPDX-License-Identifier: BSD-3-Clause
// Centre and radius of a mesh, one source for those who measure all of it and those who follow a change. Inside the
// mesh layer only.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/bounds.h"

namespace otg {

inline Vec3f middleAsFloat(const Bounds& bounds) {
  const Vec3d middle = bounds.middle();
  return {static_cast<float>(middle.x), static_cast<float>(middle.y), static_cast<float>(middle.z)};
}

/// TriMesh::origin() after vertices have moved: where it was, as long as that is within a sixteenth of the size from
/// the middle of the bounds. So boxes that did not move stay as they are. That is within a quarter of the radius, as
/// otgPairBounds takes for granted.
inline Vec3f originAfterMove(const Bounds& bounds, const Vec3f& before) {
  const Vec3d middle = bounds.middle();
  const double size = std::max(
      {double{bounds.max.x} - bounds.min.x, double{bounds.max.y} - bounds.min.y, double{bounds.max.z} - bounds.min.z});
  const double off =
      std::max({std::abs(middle.x - before.x), std::abs(middle.y - before.y), std::abs(middle.z - before.z)});
  // Boxes around a centre that is not the middle are larger: not where that might leave single precision.
  return off <= size / 16 && size < 1e37 ? before : middleAsFloat(bounds);
}

inline double distance2(const Vec3f& p, const Vec3f& center) {
  const Vec3d d = relativeTo(p, Vec3d{center.x, center.y, center.z});
  return otgDot(d, d);
}

/// No less than the root of the largest distance2().
inline float radiusFrom(double largestDistance2) {
  // A few roundings of double lie between it and the true distance; one part in 2^50 covers them.
  const double x = std::sqrt(largestDistance2) * (1 + 0x1p-50);
  const float f = static_cast<float>(std::min<double>(x, std::numeric_limits<float>::max()));
  return double{f} >= x ? f : std::nextafter(f, std::numeric_limits<float>::infinity());
}

}  // namespace otg
