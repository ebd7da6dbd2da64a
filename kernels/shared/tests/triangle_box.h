// SPDX-License-Identifier: BSD-3-Clause
// A triangle against an axis-aligned box, conservatively: three box axes, the plane of the triangle, and on request the
// nine cross products of edges. Each axis has its own bound on what errors of `error` per corner coordinate can do to
// it. Source of the method: T. Akenine-Moeller, "Fast 3D Triangle-Box Overlap Testing", JGT 6(1), 2001.
#if defined(OTG_REAL_DOUBLE) ? !defined(OTG_SHARED_TRIANGLE_BOX_D) : !defined(OTG_SHARED_TRIANGLE_BOX_F)
#ifdef OTG_REAL_DOUBLE
#define OTG_SHARED_TRIANGLE_BOX_D
#else
#define OTG_SHARED_TRIANGLE_BOX_F
#endif
#include "shared/math/vec3.h"
//
#include "shared/math/generic_begin.h"

#ifndef __OPENCL_VERSION__
namespace otg {
#endif

/// Gap between three projections and the interval [-r, r], minus the error bound e: positive when certainly apart.
OTG_GENERIC REAL OTG_NAME(otgIntervalGap)(REAL p0, REAL p1, REAL p2, REAL r, REAL e) {
  REAL lo = OTG_MIN(OTG_MIN(p0, p1), p2), hi = OTG_MAX(OTG_MAX(p0, p1), p2);
  return OTG_MAX(lo, -hi) - (r + e);
}

/// 1 when the triangle is certainly apart from the box. `error` bounds the error of each corner coordinate relative to
/// the frame of the box, including one rounding of a difference of two such coordinates.
OTG_GENERIC int OTG_NAME(otgTriangleApartFromBox)(const OTG_VEC3* corner, OTG_VEC3 center, OTG_VEC3 extent, REAL error,
                                                  int edges) {
  OTG_VEC3 v[3], e[3], n;
  REAL size = 0, reach, en;
  for (int k = 0; k < 3; ++k) v[k] = OTG_NAME(otgSub)(corner[k], center);
  if (OTG_NAME(otgIntervalGap)(v[0].x, v[1].x, v[2].x, extent.x, error) > 0) return 1;
  if (OTG_NAME(otgIntervalGap)(v[0].y, v[1].y, v[2].y, extent.y, error) > 0) return 1;
  if (OTG_NAME(otgIntervalGap)(v[0].z, v[1].z, v[2].z, extent.z, error) > 0) return 1;
  for (int k = 0; k < 3; ++k) {
    e[k] = OTG_NAME(otgSub)(v[(k + 1) % 3], v[k]);
    size = OTG_MAX(size, OTG_ABS(v[k].x) + OTG_ABS(v[k].y) + OTG_ABS(v[k].z));
  }
  // 1-norms: of any corner (`size`), of corners and extents together (`reach`). Edges are known to 2 error, so a
  // normal's coordinate is off by at most 4 error |e| (1-norm) + rounding. Its projections are off by that times
  // `reach`, plus the corner's own error times |n|_1 <= |e0| |e1|. All constants are doubled for the roundings of the
  // evaluation.
  reach = size + extent.x + extent.y + extent.z + error;
  n = OTG_NAME(otgCross)(e[0], e[1]);
  en = 16 * error * (2 * size + error) * reach;
  if (OTG_ABS(OTG_NAME(otgDot)(n, v[0])) -
          (OTG_ABS(n.x) * extent.x + OTG_ABS(n.y) * extent.y + OTG_ABS(n.z) * extent.z) >
      en)
    return 1;
  if (!edges) return 0;
  en = 16 * error * reach;
  for (int k = 0; k < 3; ++k) {
    // Axes unit_i x e: (0, -e.z, e.y), (e.z, 0, -e.x), (-e.y, e.x, 0).
    REAL ex = OTG_ABS(e[k].x), ey = OTG_ABS(e[k].y), ez = OTG_ABS(e[k].z);
    if (OTG_NAME(otgIntervalGap)(v[0].z * e[k].y - v[0].y * e[k].z, v[1].z * e[k].y - v[1].y * e[k].z,
                                 v[2].z * e[k].y - v[2].y * e[k].z, extent.y * ez + extent.z * ey, en) > 0)
      return 1;
    if (OTG_NAME(otgIntervalGap)(v[0].x * e[k].z - v[0].z * e[k].x, v[1].x * e[k].z - v[1].z * e[k].x,
                                 v[2].x * e[k].z - v[2].z * e[k].x, extent.x * ez + extent.z * ex, en) > 0)
      return 1;
    if (OTG_NAME(otgIntervalGap)(v[0].y * e[k].x - v[0].x * e[k].y, v[1].y * e[k].x - v[1].x * e[k].y,
                                 v[2].y * e[k].x - v[2].x * e[k].y, extent.x * ey + extent.y * ex, en) > 0)
      return 1;
  }
  return 0;
}

#ifndef __OPENCL_VERSION__
}  // namespace otg
#endif
#include "shared/math/generic_end.h"
#endif
