// SPDX-License-Identifier: BSD-3-Clause
// Boxes in float that are sure to contain what they stand for.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>

#include "bvh/tree.h"

namespace otg {

/// Bounds in double, in a mesh's centred frame.
struct Bounds {
  double lo[3] = {std::numeric_limits<double>::infinity(), std::numeric_limits<double>::infinity(),
                  std::numeric_limits<double>::infinity()};
  double hi[3] = {-std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity(),
                  -std::numeric_limits<double>::infinity()};
  void grow(const Bounds& other) {
    for (int k = 0; k < 3; ++k) {
      lo[k] = std::min(lo[k], other.lo[k]);
      hi[k] = std::max(hi[k], other.hi[k]);
    }
  }
  double halfArea() const {
    const double x = hi[0] - lo[0], y = hi[1] - lo[1], z = hi[2] - lo[2];
    return x >= 0 ? x * y + y * z + z * x : 0;
  }
};

/// Bounds of a triangle minus the mesh's centre. The difference of two floats is a double up to one rounding in absurd
/// ranges of magnitude; boxOf adds a step in float, which covers that too.
inline Bounds boundsOf(const TriMesh& mesh, std::uint32_t triangle) {
  Bounds b;
  const Triangle& t = mesh.triangles()[triangle];
  const double c[3] = {mesh.center().x, mesh.center().y, mesh.center().z};
  for (std::uint32_t v : t.v) {
    const Vec3f& p = mesh.vertices()[v];
    const double x[3] = {p.x - c[0], p.y - c[1], p.z - c[2]};
    for (int k = 0; k < 3; ++k) {
      b.lo[k] = std::min(b.lo[k], x[k]);
      b.hi[k] = std::max(b.hi[k], x[k]);
    }
  }
  return b;
}

/// One axis of a float box [center - extent, center + extent] that contains [lo, hi] in exact arithmetic.
inline void boxAxis(double lo, double hi, float& center, float& extent) {
  center = static_cast<float>(0.5 * lo + 0.5 * hi);
  const double reach = std::max(hi - double{center}, double{center} - lo);
  // Two steps up: one for the conversion to float, one for the roundings of double above.
  const float up = std::numeric_limits<float>::infinity();
  extent = reach > 0 ? std::nextafter(std::nextafter(static_cast<float>(reach), up), up) : 0.0f;
}

inline void boxOf(const Bounds& b, Vec3f& center, Vec3f& extent) {
  boxAxis(b.lo[0], b.hi[0], center.x, extent.x);
  boxAxis(b.lo[1], b.hi[1], center.y, extent.y);
  boxAxis(b.lo[2], b.hi[2], center.z, extent.z);
}

}  // namespace otg
