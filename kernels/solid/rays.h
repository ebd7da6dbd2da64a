// SPDX-License-Identifier: BSD-3-Clause
// Ways out of a solid along a ray, through the device's trees; as collide/inside_test.cpp, one lane to a ray.
#ifndef OTG_SOLID_RAYS_H
#define OTG_SOLID_RAYS_H
#include "solid/mesh.h"

#define OTG_RAY_STACK 96

OTG_INLINED int otgRayMeetsSlab(double o, double d, double inverse, double c, double e, double* near, double* far) {
  if (d == 0) return !(fabs(o - c) > e);
  double t0 = (c - e - o) * inverse, t1 = (c + e - o) * inverse;
  if (t0 > t1) {
    const double t = t0;
    t0 = t1;
    t1 = t;
  }
  *near = otgMax_d(*near, t0 - 1e-12 * fabs(t0));
  *far = otgMin_d(*far, t1 + 1e-12 * fabs(t1));
  return !(*near > *far);
}

/// `inverse`: one by each component of the direction d.
OTG_INLINED int otgRayMeetsBox(otg_vec3_d o, otg_vec3_d d, otg_vec3_d inverse, float4 center, float4 extent,
                               double limit) {
  double near = 0, far = limit;
  return otgRayMeetsSlab(o.x, d.x, inverse.x, (double)center.x, (double)extent.x, &near, &far) &&
         otgRayMeetsSlab(o.y, d.y, inverse.y, (double)center.y, (double)extent.y, &near, &far) &&
         otgRayMeetsSlab(o.z, d.z, inverse.z, (double)center.z, (double)extent.z, &near, &far);
}

/// Where the ray meets a triangle that has an area: 1, how far, and whether it leaves the solid there.
OTG_INLINED int otgRayMeetsTriangle(__global const float4* meshes, uint soup, otg_vec3_d o, otg_vec3_d d,
                                    double* distance, int* leaving) {
  const float4 u0 = meshes[soup], u1 = meshes[soup + 1], u2 = meshes[soup + 2];
  if (as_uint(u1.w) != 0) return 0;  // no area
  const otg_vec3_d p0 = otgVec_d((double)u0.x, (double)u0.y, (double)u0.z);
  const otg_vec3_d e1 = otgSub_d(otgVec_d((double)u1.x, (double)u1.y, (double)u1.z), p0);
  const otg_vec3_d e2 = otgSub_d(otgVec_d((double)u2.x, (double)u2.y, (double)u2.z), p0);
  const otg_vec3_d h = otgCross_d(d, e2);
  const double det = otgDot_d(e1, h);
  if (det == 0) return 0;
  const otg_vec3_d s = otgSub_d(o, p0), r = otgCross_d(s, e1);
  const double x = otgDot_d(s, h) / det, y = otgDot_d(d, r) / det;
  if (x < -1e-9 || y < -1e-9 || x + y > 1 + 1e-9) return 0;
  *distance = otgDot_d(e2, r) / det;
  *leaving = det < 0;
  return 1;
}

/// As exitDistance: 0 where the first surface that the ray meets is entered, -1 where it meets none, -2 where the tree
/// is too deep.
OTG_INLINED double otgExitDistance(__global const float4* meshes, OTG_MESH* m, otg_vec3_d from, otg_vec3_d along,
                                   double limit, double skin) {
  const otg_vec3_d o = otgPointToOwn(m, from), d = otgDirectionToOwn(m, along);
  const otg_vec3_d centred = otgSub_d(o, otgVec_d((double)m->center.x, (double)m->center.y, (double)m->center.z));
  const otg_vec3_d inverse = otgVec_d(1 / d.x, 1 / d.y, 1 / d.z);
  uint stack[OTG_RAY_STACK];
  uint top = 1;
  double nearest = limit;
  int found = 0, leaves = 0;
  // Of a node all children are looked at together; those that the ray meets are stacked.
  float4 center = meshes[m->nodes], extent = meshes[m->nodes + 1];
  if (!otgRayMeetsBox(centred, d, inverse, center, extent, nearest)) return -1;
  stack[0] = 0;
  while (top > 0) {
    const uint node = m->nodes + 2 * stack[--top];
    center = meshes[node];
    extent = meshes[node + 1];
    const int count = as_int(extent.w);
    const uint first = as_uint(center.w);
    if (count > 0) {
      if (top + (uint)count > OTG_RAY_STACK) return -2;
      for (uint k = 0; k < (uint)count; ++k) {
        const uint child = m->nodes + 2 * (first + k);
        if (otgRayMeetsBox(centred, d, inverse, meshes[child], meshes[child + 1], nearest)) stack[top++] = first + k;
      }
      continue;
    }
    for (uint k = 0; k < (uint)-count; ++k) {
      double distance;
      int leaving;
      if (!otgRayMeetsTriangle(meshes, m->soup + 3 * (first + k), o, d, &distance, &leaving)) continue;
      if (!(distance >= 0 && distance <= nearest)) continue;
      if (!leaving && distance <= skin) continue;
      if (found && distance == nearest && leaves) continue;  // an edge that both sides share: leaving wins
      found = 1;
      leaves = leaving;
      nearest = distance;
    }
  }
  return !found ? -1 : leaves ? nearest : 0;
}

#endif  // OTG_SOLID_RAYS_H
