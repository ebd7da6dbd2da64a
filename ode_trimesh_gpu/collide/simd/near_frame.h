// SPDX-License-Identifier: BSD-3-Clause
// Where the float filter of the narrow phase looks at triangles: beside a corner of A, so that what float rounds away
// is small beside the triangles, however large their meshes are. Plain data: see wide_kernels.h.
#pragma once

#include "shared/math/vec3.h"
#include "shared/tests/plane_test.h"

namespace otg {

/// The same place in both meshes' frames, to rounding. A corner b of B is at R (b - centerB) + t from centerA.
struct NearFrame {
  Vec3f centerA, centerB;
  Vec3f t;
};

[[gnu::always_inline]] inline NearFrame nearFrame(const Transformd& bInA, const Vec3f& cornerOfA) {
  const Vec3d at{cornerOfA.x, cornerOfA.y, cornerOfA.z};
  const Vec3d inB = otgRotateBack(bInA, otgSub(at, bInA.t));
  const Vec3f b{static_cast<float>(inB.x), static_cast<float>(inB.y), static_cast<float>(inB.z)};
  const Vec3d t = otgSub(otgTransform(bInA, Vec3d{b.x, b.y, b.z}), at);
  return {cornerOfA, b, {static_cast<float>(t.x), static_cast<float>(t.y), static_cast<float>(t.z)}};
}

/// With the distance of the corners from the place grows what float rounds.
struct NearFilterError {
  FilterError<float> least;  ///< for what is rounded in double
  float perLengthA;          ///< what its delta grows by: A's corners round once,
  float perLengthB;          ///< B's through the rotation
};

/// Of a pair of triangles there. `a`, `b`: corners less the centers, neither of them rotated.
template <class Real>
[[gnu::always_inline]] inline FilterError<Real> nearFilterError(const NearFilterError& e, const Vec3<Real>* a,
                                                                const Vec3<Real>* b, const Vec3<Real>& t) {
  const Real ofA = otgMax(otgNorm1(a[0]), otgMax(otgNorm1(a[1]), otgNorm1(a[2])));
  const Real ofB = otgMax(otgNorm1(b[0]), otgMax(otgNorm1(b[1]), otgNorm1(b[2])));
  const Real most = otgMax(Real(e.perLengthA) * ofA, Real(e.perLengthB) * (ofB + otgNorm1(t)));
  const Real delta = most + Real(e.least.delta);
  return {Real(e.least.unit), delta, Real(e.least.tiny)};
}

}  // namespace otg
