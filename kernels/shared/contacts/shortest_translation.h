// SPDX-License-Identifier: BSD-3-Clause
// The shortest translation that gets a body out of half-spaces: t with normal . t >= depth for each.
//
// Seidel's incremental method for linear programs of low dimension, with the length in place of a linear objective:
// the shortest one touches the half-space that it does not satisfy yet, and at most two of those before.
//
// As OpenCL C the half-spaces lie in local memory.
#if defined(OTG_REAL_DOUBLE) ? !defined(OTG_SHARED_SHORTEST_TRANSLATION_D) : !defined(OTG_SHARED_SHORTEST_TRANSLATION_F)
#ifdef OTG_REAL_DOUBLE
#define OTG_SHARED_SHORTEST_TRANSLATION_D
#else
#define OTG_SHARED_SHORTEST_TRANSLATION_F
#endif
#include "shared/math/vec3.h"
//
#include "shared/math/generic_begin.h"

/// Part of a depth that is more than rounding.
#define OTG_TRANSLATION_WHOLE (1 - 1e-6)
/// Sine of the angle below which two boundaries are parallel: where they meet is too far away to be a way out.
#define OTG_TRANSLATION_PARALLEL 1e-4

#ifdef __OPENCL_VERSION__
#define OTG_HALF_SPACE OTG_NAME(otg_half_space)
#define OTG_HALF_SPACES __local const OTG_HALF_SPACE*
typedef struct {
  OTG_VEC3 normal;
  REAL depth;
} OTG_HALF_SPACE;
#else
namespace otg {
template <class REAL>
struct HalfSpace {
  Vec3<REAL> normal;  ///< unit
  REAL depth;
};
#define OTG_HALF_SPACE HalfSpace<REAL>
#define OTG_HALF_SPACES const HalfSpace<REAL>*
#endif

/// Whether a translation gets a body out of a half-space.
OTG_GENERIC int OTG_NAME(otgIsOut)(OTG_VEC3 normal, REAL depth, OTG_VEC3 t) {
  return OTG_NAME(otgDot)(normal, t) >= OTG_REAL(OTG_TRANSLATION_WHOLE) * depth;
}

/// The shortest one on a line; `foot` is its place nearest to the origin. 0 where none satisfies all half-spaces.
OTG_GENERIC int OTG_NAME(otgShortestOnLine)(OTG_HALF_SPACES all, otg_uint count, OTG_VEC3 foot, OTG_VEC3 along,
                                            OTG_VEC3* t) {
  REAL low = -OTG_REAL(INFINITY), high = OTG_REAL(INFINITY), slack = 0;
  for (otg_uint i = 0; i < count; ++i) {
    const OTG_HALF_SPACE h = all[i];
    const REAL slope = OTG_NAME(otgDot)(h.normal, along), missing = h.depth - OTG_NAME(otgDot)(h.normal, foot);
    const REAL grain = (1 - OTG_REAL(OTG_TRANSLATION_WHOLE)) * h.depth;
    slack = slack < grain ? grain : slack;
    if (OTG_ABS(slope) < OTG_REAL(OTG_TRANSLATION_PARALLEL)) {
      if (missing > grain) return 0;
    } else if (slope > 0) {
      low = low < missing / slope ? missing / slope : low;
    } else {
      high = missing / slope < high ? missing / slope : high;
    }
  }
  if (low > high + slack) return 0;
  *t = OTG_NAME(otgAdd)(foot, OTG_NAME(otgScale)(along, low > 0 ? low : high < 0 ? high : OTG_REAL(0)));
  return 1;
}

/// The shortest one on the boundary of a half-space that satisfies all of the others. 0 where none does.
OTG_GENERIC int OTG_NAME(otgShortestOnBoundary)(OTG_HALF_SPACES all, otg_uint count, OTG_VEC3 normal, REAL depth,
                                                OTG_VEC3* t) {
  const OTG_VEC3 start = OTG_NAME(otgScale)(normal, depth);
  OTG_VEC3 x = start;
  for (otg_uint i = 0; i < count; ++i) {
    const OTG_HALF_SPACE h = all[i];
    if (OTG_NAME(otgIsOut)(h.normal, h.depth, x)) continue;
    const REAL cosine = OTG_NAME(otgDot)(normal, h.normal);
    const OTG_VEC3 along = OTG_NAME(otgCross)(normal, h.normal);
    const REAL sine2 = OTG_NAME(otgDot)(along, along);
    if (sine2 < OTG_REAL(OTG_TRANSLATION_PARALLEL * OTG_TRANSLATION_PARALLEL)) return 0;
    const OTG_VEC3 inPlane =
        OTG_NAME(otgScale)(OTG_NAME(otgSub)(h.normal, OTG_NAME(otgScale)(normal, cosine)), 1 / sine2);
    const OTG_VEC3 foot = OTG_NAME(otgAdd)(start, OTG_NAME(otgScale)(inPlane, h.depth - cosine * depth));
    if (!OTG_NAME(otgShortestOnLine)(all, i, foot, OTG_NAME(otgScale)(along, 1 / OTG_SQRT(sine2)), &x)) return 0;
  }
  *t = x;
  return 1;
}

#undef OTG_HALF_SPACES
#undef OTG_HALF_SPACE
#ifndef __OPENCL_VERSION__
}  // namespace otg
#endif
#include "shared/math/generic_end.h"
#endif
