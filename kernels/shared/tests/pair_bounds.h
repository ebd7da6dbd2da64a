// SPDX-License-Identifier: BSD-3-Clause
// From the pose of a pair of meshes to what its float filters need: where B's centre lies, and error bounds. Computed
// in double, once per query.
#if defined(OTG_REAL_DOUBLE) ? !defined(OTG_SHARED_PAIR_BOUNDS_D) : !defined(OTG_SHARED_PAIR_BOUNDS_F)
#ifdef OTG_REAL_DOUBLE
#define OTG_SHARED_PAIR_BOUNDS_D
#else
#define OTG_SHARED_PAIR_BOUNDS_F
#endif
#include "shared/math/vec3.h"
//
#include "shared/math/generic_begin.h"

#ifndef OTG_PAIR_BOUNDS_LIMITS
#define OTG_PAIR_BOUNDS_LIMITS
/// See rotation_tolerance.h.
#define OTG_ROTATION_TOLERANCE 1e-3
#define OTG_RELATIVE_ROTATION_TOLERANCE (OTG_ROTATION_TOLERANCE * (2 + OTG_ROTATION_TOLERANCE))
/// In float the cube of the size must not overflow. The filter would only leave the pair undecided, but inf - inf in a
/// box gap must not arise either.
#define OTG_LARGEST_SCALE 1e37
#endif

#ifndef __OPENCL_VERSION__
namespace otg {
template <class REAL>
struct PairBounds {
  Vec3<REAL> t;    ///< centre of B's frame in A's centred frame
  REAL eps;        ///< for BoxFrame::eps, rounded up
  REAL delta;      ///< for FilterError<float>::delta, rounded up
  REAL scale;      ///< no coordinate of either mesh in A's centred frame is larger
  REAL rowNorm;    ///< of the longest row of R
  REAL placement;  ///< more than what double rounds of where a corner is
};
#define OTG_PAIR_BOUNDS PairBounds<REAL>
#else
#define OTG_PAIR_BOUNDS OTG_NAME(otg_pair_bounds)
typedef struct {
  OTG_VEC3 t;
  REAL eps, delta, scale, rowNorm, placement;
} OTG_PAIR_BOUNDS;
#endif

/// The squared Frobenius norm of R^T R - 1; -1 where R mirrors or is singular. May be NaN or infinite where R is.
OTG_GENERIC REAL OTG_NAME(otgRotationDefectSquared)(OTG_TRANSFORM m) {
  REAL squares = 0, determinant;
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      const REAL off = m.r[i] * m.r[j] + m.r[3 + i] * m.r[3 + j] + m.r[6 + i] * m.r[6 + j] - OTG_REAL(i == j ? 1 : 0);
      squares = squares + off * off;
    }
  }
  determinant = m.r[0] * (m.r[4] * m.r[8] - m.r[5] * m.r[7]) - m.r[1] * (m.r[3] * m.r[8] - m.r[5] * m.r[6]) +
                m.r[2] * (m.r[3] * m.r[7] - m.r[4] * m.r[6]);
  return determinant > 0 ? squares : OTG_REAL(-1);
}

OTG_GENERIC REAL OTG_NAME(otgLength)(OTG_VEC3 v) {
  return OTG_SQRT(OTG_NAME(otgDot)(v, v));
}

/// `defect` of m: sqrt(otgRotationDefectSquared). Origins of the centred frames are TriMesh::origin, radii as
/// TriMesh::radius.
OTG_GENERIC OTG_PAIR_BOUNDS OTG_NAME(otgPairBounds)(OTG_TRANSFORM m, REAL defect, OTG_VEC3 originA, REAL radiusA,
                                                    OTG_VEC3 originB, REAL radiusB) {
  OTG_PAIR_BOUNDS out;
  const REAL floatUnit = OTG_REAL(0x1p-24), doubleUnit = OTG_REAL(0x1p-53);
  // The centred frames: x = v - origin. Both the transform of B's origin and the difference are taken in double.
  out.t = OTG_NAME(otgSub)(OTG_NAME(otgTransform)(m, originB), originA);
  // An origin may be a quarter of the radius from the middle that the radius is meant about.
  radiusA *= OTG_REAL(1.25);
  radiusB *= OTG_REAL(1.25);
  out.rowNorm = 0;
  for (int i = 0; i < 3; ++i) {
    const OTG_VEC3 row = OTG_NAME(otgVec)(m.r[3 * i], m.r[3 * i + 1], m.r[3 * i + 2]);
    out.rowNorm = OTG_MAX(out.rowNorm, OTG_NAME(otgLength)(row));
  }
  out.scale = radiusA + radiusB * out.rowNorm + OTG_NAME(otgLength)(out.t);
  // Boxes: a gap along a face or edge axis is a sum of at most 17 rounded terms. Their magnitudes add up to `scale` at
  // most: rows of R have norm 1, so Cauchy-Schwarz bounds the rotated centre and extents by the radius; 21 u scale for
  // the face axes of B and 32 u scale for edge axes bound the whole.
  //
  // A matrix is used as given. Where R is not orthonormal the tests still take its columns r_j for B's axes and for
  // each other's cross products. Let E = R^T R - 1, and e be the extents of a box of B. B reaches sum_k e_k |(1 +
  // E)_kj| along r_j, not e_j: off by |e| |E| at most. Along a_i x r_j it reaches e_k |cof(R)_il| + .., not e_k |R_il|
  // + ..; the singular values s of R differ from its cofactors' by s2 s3 - s1, about half of the sum of E's
  // eigenvalues. So this is off by less than |e| |E|, too (0.87, and 0.003 for the second order at the largest defect).
  // A box lies within the mesh's bounds, so |e| <= sqrt(3) radius: 2 > sqrt(3) covers both.
  out.placement =
      16 * doubleUnit * (OTG_NAME(otgLength)(originA) + OTG_NAME(otgLength)(originB) * out.rowNorm + out.scale);
  // The last term is for numbers so small that a device flushes them to zero.
  out.eps = 32 * floatUnit * out.scale + 2 * defect * radiusB + out.placement + OTG_REAL(1e-36);
  // Triangles: centring rounds once (u r), the transform costs at most 8 u scale on top of R's and t's own rounding.
  out.delta = OTG_REAL(2.1) * (16 * floatUnit * out.scale + out.placement);
  return out;
}

#undef OTG_PAIR_BOUNDS
#ifndef __OPENCL_VERSION__
}  // namespace otg
#endif
#include "shared/math/generic_end.h"
#endif
