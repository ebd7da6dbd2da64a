// SPDX-License-Identifier: BSD-3-Clause
// Whether a point lies inside a solid: as pointInMesh() in collide/inside_test.cpp, through the eight-wide tree. Needs
// doubles.
#ifndef OTG_POINT_INSIDE_H
#define OTG_POINT_INSIDE_H
#define OTG_REAL_FLOAT
#include "shared/layout/point_layout.h"
#undef OTG_REAL_FLOAT
#define OTG_REAL_DOUBLE
#include "shared/tests/point_test.h"
#undef OTG_REAL_DOUBLE

inline static otg_vec3_d otgPointOf(float4 v) {
  return otgVec_d((double)v.x, (double)v.y, (double)v.z);
}

/// How often a ray leaves the mesh more than it enters it; with 1 in `deep` where the tree is too deep. Without `works`
/// it looks at nothing.
inline static int otgCrossings(__global const float4* nodes, __global const float4* soups, otg_vec3_d o,
                               otg_vec3_d centred, otg_vec3_d d, double reach, int works, int* deep) {
  const otg_vec3_d inverse = otgVec_d(1 / d.x, 1 / d.y, 1 / d.z);
  const otg_vec3_d wider = otgVec_d(2 * reach, 2 * reach, 2 * reach);
  uint stack[OTG_POINT_STACK];
  uint top = works ? 1 : 0;
  int balance = 0;
  stack[0] = 0;
  while (top > 0) {
    const uint node = 2 * stack[--top];
    const uint first = as_uint(nodes[node].w);
    const int children = as_int(nodes[node + 1].w);
    if (children > 0) {
      if (top + (uint)children > OTG_POINT_STACK) {
        *deep = 1;
        return 0;
      }
      for (uint k = 0; k < (uint)children; ++k) {
        const otg_vec3_d center = otgPointOf(nodes[2 * (first + k)]);
        const otg_vec3_d extent = otgAdd_d(otgPointOf(nodes[2 * (first + k) + 1]), wider);
        if (otgRayPassesBox_d(centred, d, inverse, otgSub_d(center, extent), otgAdd_d(center, extent))) {
          stack[top++] = first + k;
        }
      }
      continue;
    }
    for (uint k = 0; k < (uint)-children; ++k) {
      __global const float4* soup = soups + 3 * (first + k);
      const float4 u0 = soup[0], u1 = soup[1], u2 = soup[2];
      if (as_uint(u1.w) != 0) continue;  // no area
      const otg_vec3_d a = otgPointOf(u0), b = otgPointOf(u1), c = otgPointOf(u2);
      double at = 0;
      const int meets = otgRayMeetsTriangle_d(o, d, a, b, c, &at);
      if (meets == 0 || !(at >= 0) || !otgRayPassesTriangleBox_d(o, d, inverse, a, b, c, reach)) continue;
      balance += meets == 2 ? 1 : -1;
    }
  }
  return balance;
}

/// A point in the frame of the mesh whose nodes and triangles are at these places: 1 inside, 0 outside, -1 where the
/// tree is too deep. By the first two of up to three rays that agree. Lanes that have no point call it with `works` 0:
/// PoCL 3.1 does not cope with these loops below a condition in kernels with barriers.
inline static int otgIsPointInside(__global const float4* meshes, uint nodes, uint soup, otg_pair_point center,
                                   float radius, otg_vec3_d p, int works) {
  const otg_vec3_d origin = otgVec_d((double)center.x, (double)center.y, (double)center.z);
  const otg_vec3_d centred = otgSub_d(p, origin);
  const double reach = otgRayReach_d((double)radius, centred, origin);
  int votes = 0, deep = 0;
  for (int k = 0; k < 3 && votes != 2 && votes != -2; ++k) {
    const otg_vec3_d d = otgParityDirection_d(k);
    votes += otgCrossings(meshes + nodes, meshes + soup, p, centred, d, reach, works, &deep) > 0 ? 1 : -1;
  }
  return deep ? -1 : votes > 0;
}

#endif  // OTG_POINT_INSIDE_H
