// SPDX-License-Identifier: BSD-3-Clause
// Exact boxes of triangles, and the float boxes in the centred frame that are sure to contain them.
#pragma once

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

#include "bvh/tree.h"

namespace otg {

/// x, y, z and an unused zero. The vector types of GCC and Clang compile to SSE or NEON without intrinsics; builds
/// spend their time in these minima and maxima.
using Float4 = float __attribute__((vector_size(16)));

inline Float4 lanewiseMin(Float4 a, Float4 b) {
  return b < a ? b : a;
}
inline Float4 lanewiseMax(Float4 a, Float4 b) {
  return a < b ? b : a;
}

/// Bounds in the mesh's own frame, where they are exact: minima and maxima of floats are floats.
struct MeshBox {
  static constexpr float kInfinity = std::numeric_limits<float>::infinity();
  Float4 lo{kInfinity, kInfinity, kInfinity, 0}, hi{-kInfinity, -kInfinity, -kInfinity, 0};

  void grow(const MeshBox& other) {
    lo = lanewiseMin(lo, other.lo);
    hi = lanewiseMax(hi, other.hi);
  }
  void grow(Float4 point) {
    lo = lanewiseMin(lo, point);
    hi = lanewiseMax(hi, point);
  }
  /// Halved before adding, so that nothing overflows.
  Float4 middle() const { return 0.5f * lo + 0.5f * hi; }
  /// Half the surface area, in double because squares of floats overflow and underflow float. Not for empty boxes.
  double halfArea() const {
    const double x = double{hi[0]} - lo[0], y = double{hi[1]} - lo[1], z = double{hi[2]} - lo[2];
    return x * y + y * z + z * x;
  }
};

inline MeshBox boxOfTriangle(const TriMesh& mesh, std::uint32_t triangle) {
  MeshBox box;
  for (const std::uint32_t v : mesh.triangles()[triangle].v) {
    const Vec3f& p = mesh.vertices()[v];
    box.grow(Float4{p.x, p.y, p.z, 0});
  }
  return box;
}

/// One axis of a box [center - extent, center + extent] in the centred frame. It contains [lo, hi] - origin in exact
/// arithmetic, and its extent is finite.
inline void encloseAxis(float lo, float hi, float origin, float& center, float& extent) {
  constexpr float kLargest = std::numeric_limits<float>::max();
  center = static_cast<float>(0.5 * lo + 0.5 * hi - origin);
  // origin + center == sum + rest exactly (Knuth's two-sum).
  const double c = center, o = origin, sum = c + o, virtualO = sum - c;
  const double rest = (c - (sum - virtualO)) + (o - virtualO);
  const double reach = std::max(hi - sum, sum - lo) + std::fabs(rest);
  // The step up covers the conversion to float and the two roundings of double before it. It is not needed at zero
  // (a difference is only zero when it is exact), and must not lead to infinity: the true reach is at most the largest
  // float. For |center| + reach is no farther out than the mesh's bounds, up to the rounding of `center`, for which
  // |center| leaves room.
  const float nearest = static_cast<float>(std::min(reach, double{kLargest}));
  const float up = std::bit_cast<float>(std::bit_cast<std::uint32_t>(nearest) + 1);
  extent = reach > 0 ? std::min(up, kLargest) : 0.0f;
}

inline void enclose(const MeshBox& box, const Vec3f& origin, BvhNode& node) {
  encloseAxis(box.lo[0], box.hi[0], origin.x, node.center.x, node.extent.x);
  encloseAxis(box.lo[1], box.hi[1], origin.y, node.center.y, node.extent.y);
  encloseAxis(box.lo[2], box.hi[2], origin.z, node.center.z, node.extent.z);
}

}  // namespace otg
