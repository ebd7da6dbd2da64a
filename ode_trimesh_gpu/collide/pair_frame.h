// SPDX-License-Identifier: BSD-3-Clause
// What a pair of meshes in relative pose needs for its float filters: the box frame and the error bounds, once per
// query.
#pragma once

#include "collide/query.h"
#include "collide/simd/near_frame.h"
#include "shared/tests/box_test.h"
#include "shared/tests/plane_test.h"

namespace otg {

struct PairFrame {
  BoxFrame<float> boxes;            ///< centred frame of B to centred frame of A
  Transformf trianglesInA;          ///< the same transform for vertices (centred frames)
  FilterError<float> floatError;    ///< for triangles whose corners are centred floats, B's moved by trianglesInA
  NearFilterError nearError;        ///< for triangles whose corners are floats beside a place near them
  FilterError<double> doubleError;  ///< for the defining double corners (no input error)
  bool finite = false;  ///< false when the pose is not finite or far too large for float: nothing can be decided
};

/// FilterError of single precision; only `delta` depends on the pair.
FilterError<float> floatFilterError(float delta);

PairFrame makePairFrame(const Query& query);

/// Corners of a triangle of A as exact doubles, in A's frame.
inline void cornersOfA(const TriMesh& mesh, std::uint32_t triangle, Vec3d out[3]) {
  const Triangle& t = mesh.triangles()[triangle];
  for (int k = 0; k < 3; ++k) {
    const Vec3f& v = mesh.vertices()[t.v[k]];
    out[k] = {v.x, v.y, v.z};
  }
}

/// Corners of a triangle of B in A's frame: the doubles that define where B is.
inline void cornersOfB(const TriMesh& mesh, const Transformd& bInA, std::uint32_t triangle, Vec3d out[3]) {
  const Triangle& t = mesh.triangles()[triangle];
  for (int k = 0; k < 3; ++k) {
    const Vec3f& v = mesh.vertices()[t.v[k]];
    out[k] = otgTransform<double>(bInA, {v.x, v.y, v.z});
  }
}

}  // namespace otg
