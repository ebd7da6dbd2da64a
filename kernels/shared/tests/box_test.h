// SPDX-License-Identifier: BSD-3-Clause
// Overlap of two boxes that are each axis-aligned in their own mesh's centred frame: separating axes with one additive
// error term per pair of meshes. Written without branches so that REAL may be a SIMD vector; callers choose how to
// leave early.
//
// Source of the method: C. Ericson, Real-Time Collision Detection (2005), 4.4.1. What differs is the error term: the
// usual enlargement of |R| scales with the boxes and misses flat ones, since rounding scales with the distance from the
// frames' origins. So a term that covers the whole computation is added to the right-hand side once.
#if defined(OTG_REAL_DOUBLE) ? !defined(OTG_SHARED_BOX_TEST_D) : !defined(OTG_SHARED_BOX_TEST_F)
#ifdef OTG_REAL_DOUBLE
#define OTG_SHARED_BOX_TEST_D
#else
#define OTG_SHARED_BOX_TEST_F
#endif
#include "shared/math/vec3.h"
//
#include "shared/math/generic_begin.h"

#ifndef __OPENCL_VERSION__
namespace otg {

/// Everything about a pair of meshes that its box tests need. Boxes of B are taken to A's frame by r and t.
template <class REAL>
struct BoxFrame {
  REAL r[9];     ///< rotation, row-major
  REAL absR[9];  ///< |r|
  Vec3<REAL> t;  ///< centre of B's frame in A's centred frame
  REAL eps;      ///< bound on the error of any gap below: boxes are apart if gap > eps. Set by makeBoxFrame (host).
};
#define OTG_BOX_FRAME BoxFrame<REAL>
#else
#define OTG_BOX_FRAME OTG_NAME(otg_box_frame)
typedef struct {
  REAL r[9];
  REAL absR[9];
  OTG_VEC3 t;
  REAL eps;
} OTG_BOX_FRAME;
#endif

/// Centre of a box of B (given in B's centred frame) in A's centred frame.
OTG_GENERIC OTG_VEC3 OTG_NAME(otgBoxCenterInA)(OTG_BOX_FRAME f, OTG_VEC3 centerB) {
  return OTG_NAME(otgVec)(f.r[0] * centerB.x + f.r[1] * centerB.y + f.r[2] * centerB.z + f.t.x,
                          f.r[3] * centerB.x + f.r[4] * centerB.y + f.r[5] * centerB.z + f.t.y,
                          f.r[6] * centerB.x + f.r[7] * centerB.y + f.r[8] * centerB.z + f.t.z);
}

/// Half-extents of the A-aligned box around a rotated box of B.
OTG_GENERIC OTG_VEC3 OTG_NAME(otgBoxExtentInA)(OTG_BOX_FRAME f, OTG_VEC3 extentB) {
  return OTG_NAME(otgVec)(f.absR[0] * extentB.x + f.absR[1] * extentB.y + f.absR[2] * extentB.z,
                          f.absR[3] * extentB.x + f.absR[4] * extentB.y + f.absR[5] * extentB.z,
                          f.absR[6] * extentB.x + f.absR[7] * extentB.y + f.absR[8] * extentB.z);
}

/// Largest gap along A's three axes. `d` = otgBoxCenterInA(B's centre) - A's centre, `extentBInA` =
/// otgBoxExtentInA(..).
OTG_GENERIC REAL OTG_NAME(otgBoxGapA)(OTG_VEC3 d, OTG_VEC3 extentA, OTG_VEC3 extentBInA) {
  REAL gx = OTG_ABS(d.x) - (extentA.x + extentBInA.x);
  REAL gy = OTG_ABS(d.y) - (extentA.y + extentBInA.y);
  REAL gz = OTG_ABS(d.z) - (extentA.z + extentBInA.z);
  return OTG_MAX(OTG_MAX(gx, gy), gz);
}

/// Half-extents of the B-aligned box around a box of A.
OTG_GENERIC OTG_VEC3 OTG_NAME(otgBoxExtentInB)(OTG_BOX_FRAME f, OTG_VEC3 extentA) {
  return OTG_NAME(otgVec)(extentA.x * f.absR[0] + extentA.y * f.absR[3] + extentA.z * f.absR[6],
                          extentA.x * f.absR[1] + extentA.y * f.absR[4] + extentA.z * f.absR[7],
                          extentA.x * f.absR[2] + extentA.y * f.absR[5] + extentA.z * f.absR[8]);
}

/// Largest gap along B's three axes. `extentAInB` = otgBoxExtentInB(..).
OTG_GENERIC REAL OTG_NAME(otgBoxGapAlongB)(OTG_BOX_FRAME f, OTG_VEC3 d, OTG_VEC3 extentAInB, OTG_VEC3 extentB) {
  REAL gx = OTG_ABS(d.x * f.r[0] + d.y * f.r[3] + d.z * f.r[6]) - (extentB.x + extentAInB.x);
  REAL gy = OTG_ABS(d.x * f.r[1] + d.y * f.r[4] + d.z * f.r[7]) - (extentB.y + extentAInB.y);
  REAL gz = OTG_ABS(d.x * f.r[2] + d.y * f.r[5] + d.z * f.r[8]) - (extentB.z + extentAInB.z);
  return OTG_MAX(OTG_MAX(gx, gy), gz);
}
OTG_GENERIC REAL OTG_NAME(otgBoxGapB)(OTG_BOX_FRAME f, OTG_VEC3 d, OTG_VEC3 extentA, OTG_VEC3 extentB) {
  return OTG_NAME(otgBoxGapAlongB)(f, d, OTG_NAME(otgBoxExtentInB)(f, extentA), extentB);
}

/// The length of a vector's positive parts, squared.
OTG_GENERIC REAL OTG_NAME(otgGapLength2)(REAL x, REAL y, REAL z) {
  const REAL gx = OTG_MAX(x, OTG_REAL(0)), gy = OTG_MAX(y, OTG_REAL(0)), gz = OTG_MAX(z, OTG_REAL(0));
  return gx * gx + gy * gy + gz * gz;
}

/// Squared, no more than the distance of two boxes: the gaps along the three axes of either box together, which are at
/// right angles, and the gap along the line of centres. Arguments as above.
OTG_GENERIC REAL OTG_NAME(otgBoxDistance2Below)(OTG_BOX_FRAME f, OTG_VEC3 d, OTG_VEC3 extentA, OTG_VEC3 extentB) {
  const OTG_VEC3 bInA = OTG_NAME(otgBoxExtentInA)(f, extentB);
  const OTG_VEC3 dB = OTG_NAME(otgVec)(OTG_ABS(d.x * f.r[0] + d.y * f.r[3] + d.z * f.r[6]),
                                       OTG_ABS(d.x * f.r[1] + d.y * f.r[4] + d.z * f.r[7]),
                                       OTG_ABS(d.x * f.r[2] + d.y * f.r[5] + d.z * f.r[8]));
  const OTG_VEC3 dA = OTG_NAME(otgVec)(OTG_ABS(d.x), OTG_ABS(d.y), OTG_ABS(d.z));
  const REAL a2 =
      OTG_NAME(otgGapLength2)(dA.x - (extentA.x + bInA.x), dA.y - (extentA.y + bInA.y), dA.z - (extentA.z + bInA.z));
  const REAL b2 = OTG_NAME(otgGapLength2)(
      dB.x - (extentB.x + (extentA.x * f.absR[0] + extentA.y * f.absR[3] + extentA.z * f.absR[6])),
      dB.y - (extentB.y + (extentA.x * f.absR[1] + extentA.y * f.absR[4] + extentA.z * f.absR[7])),
      dB.z - (extentB.z + (extentA.x * f.absR[2] + extentA.y * f.absR[5] + extentA.z * f.absR[8])));
  const REAL d2 = OTG_NAME(otgDot)(d, d);
  const REAL along = OTG_MAX(d2 - (OTG_NAME(otgDot)(dA, extentA) + OTG_NAME(otgDot)(dB, extentB)), OTG_REAL(0));
  const REAL c2 = d2 > 0 ? along * along / d2 : d2;
  return OTG_MAX(OTG_MAX(a2, b2), c2);
}

/// Gap along the cross product of A's axis i and B's axis j, times the length of that product (which needs no
/// normalising: the error term bounds the unscaled gap).
OTG_GENERIC REAL OTG_NAME(otgBoxGapEdge)(OTG_BOX_FRAME f, OTG_VEC3 d, OTG_VEC3 extentA, OTG_VEC3 extentB, int i,
                                         int j) {
  REAL dv[3], ea[3], eb[3];
  const int i1 = (i + 1) % 3, i2 = (i + 2) % 3, j1 = (j + 1) % 3, j2 = (j + 2) % 3;
  REAL gap;
  dv[0] = d.x;
  dv[1] = d.y;
  dv[2] = d.z;
  ea[0] = extentA.x;
  ea[1] = extentA.y;
  ea[2] = extentA.z;
  eb[0] = extentB.x;
  eb[1] = extentB.y;
  eb[2] = extentB.z;
  gap = OTG_ABS(dv[i2] * f.r[3 * i1 + j] - dv[i1] * f.r[3 * i2 + j]) -
        ((ea[i1] * f.absR[3 * i2 + j] + ea[i2] * f.absR[3 * i1 + j]) +
         (eb[j1] * f.absR[3 * i + j2] + eb[j2] * f.absR[3 * i + j1]));
  return gap;
}

/// Largest of the nine edge gaps.
OTG_GENERIC REAL OTG_NAME(otgBoxGapEdges)(OTG_BOX_FRAME f, OTG_VEC3 d, OTG_VEC3 extentA, OTG_VEC3 extentB) {
  REAL gap = OTG_NAME(otgBoxGapEdge)(f, d, extentA, extentB, 0, 0);
  for (int k = 1; k < 9; ++k) {
    REAL g = OTG_NAME(otgBoxGapEdge)(f, d, extentA, extentB, k / 3, k % 3);
    gap = OTG_MAX(gap, g);
  }
  return gap;
}

#undef OTG_BOX_FRAME
#ifndef __OPENCL_VERSION__
}  // namespace otg
#endif
#include "shared/math/generic_end.h"
#endif
