// SPDX-License-Identifier: BSD-3-Clause
// Arrays of rays against one mesh, a work-item to a ray: the triangle that it hits first. As queries/ray_cast.cpp,
// through the eight-wide tree. Needs doubles. OTG_GROUP is the size of work-groups.
#define OTG_REAL_FLOAT
#include "shared/layout/ray_layout.h"
#undef OTG_REAL_FLOAT
#define OTG_REAL_DOUBLE
#include "shared/tests/point_test.h"
#undef OTG_REAL_DOUBLE

inline static otg_vec3_d otgPointOf(float4 v) {
  return otgVec_d((double)v.x, (double)v.y, (double)v.z);
}

/// Ray i of `rays` (OTG_RAY_DOUBLES each) -> answers[i]. With `cullBack` triangles hit from behind do not count.
__kernel __attribute__((reqd_work_group_size(OTG_GROUP, 1, 1))) void castRays(
    const otg_device_mesh place, __global const float4* restrict meshes, __global const double* restrict rays,
    uint count, uint cullBack, __global uint* restrict answers) {
  const uint i = get_global_id(0);
  if (i >= count) return;
  __global const double* ray = rays + OTG_RAY_DOUBLES * (size_t)i;
  const otg_vec3_d o = otgVec_d(ray[0], ray[1], ray[2]), d = otgVec_d(ray[3], ray[4], ray[5]);
  if (!(fabs(o.x) < OTG_RAY_FARTHEST && fabs(o.y) < OTG_RAY_FARTHEST && fabs(o.z) < OTG_RAY_FARTHEST)) {
    answers[i] = OTG_RAY_OPEN;
    return;
  }
  const otg_vec3_d origin = otgPointOf((float4)(place.center.x, place.center.y, place.center.z, 0));
  const otg_vec3_d from = otgSub_d(o, origin), along = otgRayAlong_d(d);
  const otg_vec3_d inverse = otgVec_d(1 / along.x, 1 / along.y, 1 / along.z);
  const double reach = otgRayReach_d((double)place.radius, from, origin);
  const otg_vec3_d wider = otgVec_d(2 * reach, 2 * reach, 2 * reach);
  __global const float4* nodes = meshes + place.nodes;
  double limit = ray[6];
  uint best = OTG_RAY_NOTHING;
  // Nodes for later, and where the ray enters them, rounded down.
  uint stack[OTG_RAY_STACK];
  float near[OTG_RAY_STACK];
  uint top = 1;
  stack[0] = 0;
  near[0] = 0;
  while (top > 0) {
    --top;
    if ((double)near[top] > limit) continue;
    const uint node = 2 * stack[top];
    const uint first = as_uint(nodes[node].w);
    const int children = as_int(nodes[node + 1].w);
    if (children > 0) {
      if (top + (uint)children > OTG_RAY_STACK) {
        answers[i] = OTG_RAY_OPEN;
        return;
      }
      // The nearest child comes to lie on top; the others in no order, which costs less than it saves.
      float least = INFINITY;
      for (uint k = 0; k < (uint)children; ++k) {
        const uint child = first + k;
        const otg_vec3_d center = otgPointOf(nodes[2 * child]);
        const otg_vec3_d extent = otgAdd_d(otgPointOf(nodes[2 * child + 1]), wider);
        double enters;
        if (!otgRayEntersBox_d(from, along, inverse, otgSub_d(center, extent), otgAdd_d(center, extent), &enters) ||
            enters > limit) {
          continue;
        }
        const float at = convert_float_rtz(enters);
        if (at < least) {
          least = at;
          stack[top] = child;
          near[top] = at;
        } else {
          stack[top] = stack[top - 1];
          near[top] = near[top - 1];
          stack[top - 1] = child;
          near[top - 1] = at;
        }
        ++top;
      }
      continue;
    }
    for (uint k = 0; k < (uint)-children; ++k) {
      __global const float4* soup = meshes + place.soup + 3 * (first + k);
      const float4 u0 = soup[0], u1 = soup[1], u2 = soup[2];
      if (as_uint(u1.w) != 0) continue;  // no area
      double at;
      const int meets =
          otgRayHitsTriangle_d(o, d, along, inverse, otgPointOf(u0), otgPointOf(u1), otgPointOf(u2), reach, &at);
      if (meets == 0 || !(at <= limit) || (cullBack && meets == 2)) continue;
      const uint triangle = as_uint(u0.w);
      if (at < limit || triangle < best) {
        limit = at;
        best = triangle;
      }
    }
  }
  answers[i] = best;
}
