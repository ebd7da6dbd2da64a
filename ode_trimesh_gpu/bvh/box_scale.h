// SPDX-License-Identifier: BSD-3-Clause
// Boxes of a scaled image of a mesh, from those of the mesh: what lets all images share its trees.
// Plain formulas, always inlined: see collide/simd/wide_kernels.h for who must not see more.
#pragma once

#include "shared/math/vec3.h"

namespace otg {

struct BoxOf {
  Vec3f center, extent;
};

/// A box of the mesh (in its centred frame) becomes one of the image (in that one's centred frame):
///
///     center' = factor center + shift              extent' = growth extent + (slope |center'| + pad)
///
/// It holds the image's vertices, which are the mesh's times the factors, rounded to float. Along one axis: u is a
/// rounding of float (2^-24), o and o' are the origins of the frames. v is a vertex in the box, and w = s v + r, |r| <=
/// u |s v|, is its image.
///
///     w - o' - center' = s (v - o - center) + (s o - o' - shift) + (s center + shift - center') + r
///
/// whose four terms are at most |s| extent, what shift was rounded by, u (|center'| (2 + u) + |shift|) for the product
/// and the sum, and u |s v| <= u (|s o| + |s| extent + |center'| (1 + 3 u) + |shift| (1 + 2 u)). Together that is
/// extent' with growth = |s| (1 + u), slope = 3.1 u and a pad that depends on factors and origins alone; makeBoxScale()
/// takes 8 u for both, which leaves room for the roundings of extent' itself. It adds to the pad what products lose
/// that underflow, also where the processor flushes them to zero.
template <class REAL>
struct BoxScale {
  Vec3<REAL> factor, shift, growth, pad;
  REAL slope;
};

/// Boxes as they are.
inline constexpr BoxScale<float> kSameBoxes{{1, 1, 1}, {0, 0, 0}, {1, 1, 1}, {0, 0, 0}, 0};

template <class REAL>
[[gnu::always_inline]] inline Vec3<REAL> scaledCenter(const BoxScale<REAL>& s, const Vec3<REAL>& center) {
  return {s.factor.x * center.x + s.shift.x, s.factor.y * center.y + s.shift.y, s.factor.z * center.z + s.shift.z};
}

/// `center`: as scaledCenter() gave it.
template <class REAL>
[[gnu::always_inline]] inline Vec3<REAL> scaledExtent(const BoxScale<REAL>& s, const Vec3<REAL>& extent,
                                                      const Vec3<REAL>& center) {
  return {s.growth.x * extent.x + (s.slope * otgAbs(center.x) + s.pad.x),
          s.growth.y * extent.y + (s.slope * otgAbs(center.y) + s.pad.y),
          s.growth.z * extent.z + (s.slope * otgAbs(center.z) + s.pad.z)};
}

[[gnu::always_inline]] inline BoxOf scaledBox(const BoxScale<float>& s, const Vec3f& center, const Vec3f& extent) {
  const Vec3f c = scaledCenter(s, center);
  return {c, scaledExtent(s, extent, c)};
}

/// How walks of a tree take its boxes: those that are given one of these are compiled for each.
struct BoxesAsTheyAre {
  /// Of anything with a centre and an extent.
  template <class Node>
  [[gnu::always_inline]] const Node& operator()(const Node& node) const {
    return node;
  }
};
struct BoxesScaled {
  BoxScale<float> scale;
  template <class Node>
  [[gnu::always_inline]] BoxOf operator()(const Node& node) const {
    return scaledBox(scale, node.center, node.extent);
  }
};

/// Calls `walk` with the boxes of a mesh; of two meshes, each scaled if one of them is. `scale` as
/// CollisionMesh::boxScale().
template <class Walk>
decltype(auto) withBoxes(const BoxScale<float>* scale, const Walk& walk) {
  return scale == nullptr ? walk(BoxesAsTheyAre{}) : walk(BoxesScaled{*scale});
}
template <class Walk>
decltype(auto) withBoxes(const BoxScale<float>* a, const BoxScale<float>* b, const Walk& walk) {
  return a == nullptr && b == nullptr
             ? walk(BoxesAsTheyAre{}, BoxesAsTheyAre{})
             : walk(BoxesScaled{a == nullptr ? kSameBoxes : *a}, BoxesScaled{b == nullptr ? kSameBoxes : *b});
}

}  // namespace otg
