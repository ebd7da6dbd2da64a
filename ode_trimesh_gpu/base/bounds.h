// SPDX-License-Identifier: BSD-3-Clause
// Axis-aligned bounds of the vertices that triangles use.
#pragma once

#include <cstdint>
#include <limits>
#include <span>

#include "base/triangle.h"
#include "shared/math/vec3.h"

namespace otg {

struct Bounds {
  static constexpr float kInfinity = std::numeric_limits<float>::infinity();
  Vec3f min{kInfinity, kInfinity, kInfinity}, max{-kInfinity, -kInfinity, -kInfinity};
  bool empty() const { return min.x > max.x; }
  void add(const Vec3f& p) {
    min = {otgMin(min.x, p.x), otgMin(min.y, p.y), otgMin(min.z, p.z)};
    max = {otgMax(max.x, p.x), otgMax(max.y, p.y), otgMax(max.z, p.z)};
  }
  /// The origin when empty. In double: the sum of two floats of opposite ends may not be a float.
  Vec3d middle() const {
    if (empty()) return {0, 0, 0};
    return {0.5 * (double{min.x} + double{max.x}), 0.5 * (double{min.y} + double{max.y}),
            0.5 * (double{min.z} + double{max.z})};
  }
};

inline Bounds boundsOf(std::span<const Vec3f> vertices, std::span<const Triangle> triangles) {
  Bounds bounds;
  for (const Triangle& triangle : triangles)
    for (const std::uint32_t v : triangle.v) bounds.add(vertices[v]);
  return bounds;
}

/// Exact as long as the two exponents are within 29 binary places, else one rounding of double.
inline Vec3d relativeTo(const Vec3f& p, const Vec3d& origin) {
  return {double{p.x} - origin.x, double{p.y} - origin.y, double{p.z} - origin.z};
}

}  // namespace otg
