// SPDX-License-Identifier: BSD-3-Clause
// A bare triangle of one mesh against a box of the other: what the no-leaf traversal tests at its leaves.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "collide/pair_frame.h"
#include "shared/tests/triangle_box.h"

namespace otg {

/// Works in a unit near the size of the pair, a power of two: products of three lengths neither overflow nor underflow.
class TriangleBoxTest {
 public:
  TriangleBoxTest(const Query& query, const PairFrame& frame)
      : query_(query),
        unit_(unitFor(frame.floatError.delta)),
        turn_(frame.trianglesInA),
        edges_(query.options.middle.axes > 6) {
    turn_.t = otgScale(turn_.t, unit_);
    error_ = unit_ * frame.floatError.delta;
    errorOfA_ = error_ + unit_ * frame.boxes.eps;
  }

  /// Triangle of A against a box of B (in B's centred frame): true when they are certainly apart. R transposed stands
  /// for R's inverse: a point b of the box is then missed by (R^T R - 1) b, which boxes.eps covers, wherever the
  /// corners are.
  bool apartA(std::uint32_t triangle, const Vec3f& center, const Vec3f& extent) const {
    Vec3f corner[3];
    centred(query_.a->mesh(), triangle, corner);
    for (Vec3f& c : corner) c = otgRotateBack(turn_, otgSub(otgScale(c, unit_), turn_.t));
    return otgTriangleApartFromBox(corner, otgScale(center, unit_), otgScale(extent, unit_), errorOfA_,
                                   edges_ ? 1 : 0) != 0;
  }
  /// Triangle of B against a box of A (in A's centred frame).
  bool apartB(std::uint32_t triangle, const Vec3f& center, const Vec3f& extent) const {
    Vec3f corner[3];
    centred(query_.b->mesh(), triangle, corner);
    for (Vec3f& c : corner) c = otgTransform(turn_, otgScale(c, unit_));
    return otgTriangleApartFromBox(corner, otgScale(center, unit_), otgScale(extent, unit_), error_, edges_ ? 1 : 0) !=
           0;
  }

 private:
  static void centred(const TriMesh& mesh, std::uint32_t triangle, Vec3f out[3]) {
    for (int k = 0; k < 3; ++k) out[k] = otgSub(mesh.vertices()[mesh.triangles()[triangle].v[k]], mesh.origin());
  }
  /// `delta` is some 2^-19 of the largest coordinate.
  static float unitFor(float delta) {
    const std::int64_t exponent = -19 - std::int64_t{std::ilogb(delta)};
    return std::ldexp(1.0F, static_cast<int>(std::clamp<std::int64_t>(exponent, -126, 126)));
  }
  const Query& query_;
  const float unit_;
  Transformf turn_;  ///< B to A, in this unit
  /// Of any corner coordinate, with room for the roundings of the test itself. Of A's, in B's frame, R's defect too.
  float error_, errorOfA_;
  bool edges_;
};

}  // namespace otg
