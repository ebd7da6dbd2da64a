// SPDX-License-Identifier: BSD-3-Clause
// A bare triangle of one mesh against a box of the other: what the no-leaf traversal tests at its leaves.
#pragma once

#include "collide/pair_frame.h"
#include "shared/tests/triangle_box.h"

namespace otg {

class TriangleBoxTest {
 public:
  TriangleBoxTest(const Query& query, const PairFrame& frame)
      : query_(query), frame_(frame), error_(frame.floatError.delta), edges_(query.options.middle.axes > 6) {}

  /// Triangle of A against a box of B (in B's centred frame): true when they are certainly apart. R transposed stands
  /// for R's inverse: a point b of the box is then missed by (R^T R - 1) b, which boxes.eps covers, wherever the
  /// corners are.
  bool apartA(std::uint32_t triangle, const Vec3f& center, const Vec3f& extent) const {
    Vec3f corner[3];
    centred(query_.a->mesh(), triangle, corner);
    for (Vec3f& c : corner) c = otgRotateBack(frame_.trianglesInA, otgSub(c, frame_.trianglesInA.t));
    return otgTriangleApartFromBox(corner, center, extent, error_ + frame_.boxes.eps, edges_ ? 1 : 0) != 0;
  }
  /// Triangle of B against a box of A (in A's centred frame).
  bool apartB(std::uint32_t triangle, const Vec3f& center, const Vec3f& extent) const {
    Vec3f corner[3];
    centred(query_.b->mesh(), triangle, corner);
    for (Vec3f& c : corner) c = otgTransform(frame_.trianglesInA, c);
    return otgTriangleApartFromBox(corner, center, extent, error_, edges_ ? 1 : 0) != 0;
  }

 private:
  static void centred(const TriMesh& mesh, std::uint32_t triangle, Vec3f out[3]) {
    for (int k = 0; k < 3; ++k) out[k] = otgSub(mesh.vertices()[mesh.triangles()[triangle].v[k]], mesh.origin());
  }
  const Query& query_;
  const PairFrame& frame_;
  float error_;  ///< of any corner coordinate, with room for the roundings of the test itself
  bool edges_;
};

}  // namespace otg
