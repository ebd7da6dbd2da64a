// SPDX-License-Identifier: BSD-3-Clause
// Arrays of rays against one mesh, a work-item to a ray: the triangle that it hits first. As queries/ray_cast.cpp,
// through the eight-wide tree. Needs doubles. OTG_GROUP is the size of work-groups.
#define OTG_REAL_FLOAT
#include "shared/layout/ray_layout.h"
#undef OTG_REAL_FLOAT
#define OTG_REAL_DOUBLE
#include "shared/tests/point_test.h"
#undef OTG_REAL_DOUBLE
#include "shared/layout/queries_given.h"

inline static otg_vec3_d otgPointOf(float4 v) {
  return otgVec_d((double)v.x, (double)v.y, (double)v.z);
}

/// A ray as the tests want it: from its origin `o` along `d` and, in the centred frame, from `from` along `along`.
typedef struct {
  otg_vec3_d o, d, from, along, inverse;
  double reach;
} otg_long_ray;

inline static otg_long_ray otgLongRay(otg_vec3_d o, otg_vec3_d d, const otg_device_mesh* place) {
  const otg_vec3_d origin = otgPointOf((float4)(place->center.x, place->center.y, place->center.z, 0));
  otg_long_ray ray;
  ray.o = o;
  ray.d = d;
  ray.from = otgSub_d(o, origin);
  ray.along = otgRayAlong_d(d);
  ray.inverse = otgVec_d(1 / ray.along.x, 1 / ray.along.y, 1 / ray.along.z);
  ray.reach = otgRayReach_d((double)place->radius, ray.from, origin);
  return ray;
}

/// Whether the ray meets the box of a node, and where it enters it.
inline static int otgRayEntersNode(__global const float4* node, const otg_long_ray* ray, double* enters) {
  const otg_vec3_d wider = otgVec_d(2 * ray->reach, 2 * ray->reach, 2 * ray->reach);
  const otg_vec3_d center = otgPointOf(node[0]), extent = otgAdd_d(otgPointOf(node[1]), wider);
  return otgRayEntersBox_d(ray->from, ray->along, ray->inverse, otgSub_d(center, extent), otgAdd_d(center, extent),
                           enters);
}

/// The triangle that is hit first so far, and where.
typedef struct {
  double limit;
  uint triangle;
} otg_ray_found;

/// The first of the triangles of a leaf and what was found before.
inline static otg_ray_found otgFirstOfLeaf(__global const float4* soups, uint count, const otg_long_ray* ray,
                                           uint cullBack, otg_ray_found found) {
  for (uint k = 0; k < count; ++k) {
    __global const float4* soup = soups + 3 * k;
    const float4 u0 = soup[0], u1 = soup[1], u2 = soup[2];
    if (as_uint(u1.w) != 0) continue;  // no area
    double at;
    const int meets = otgRayHitsTriangle_d(ray->o, ray->d, ray->along, ray->inverse, otgPointOf(u0), otgPointOf(u1),
                                           otgPointOf(u2), ray->reach, &at);
    if (meets == 0 || !(at <= found.limit) || (cullBack && meets == 2)) continue;
    const uint triangle = as_uint(u0.w);
    if (at < found.limit || triangle < found.triangle) {
      found.limit = at;
      found.triangle = triangle;
    }
  }
  return found;
}

/// Ray i of `rays` (OTG_RAY_DOUBLES each) -> answers[i]. With `cullBack` triangles hit from behind do not count.
__kernel __attribute__((reqd_work_group_size(OTG_GROUP, 1, 1))) void castRays(OTG_GIVEN(CastRays)) {
  const uint i = get_global_id(0);
  if (i >= count) return;
  __global const double* ray = rays + OTG_RAY_DOUBLES * (size_t)i;
  const otg_vec3_d o = otgVec_d(ray[0], ray[1], ray[2]), d = otgVec_d(ray[3], ray[4], ray[5]);
  if (!(fabs(o.x) < OTG_RAY_FARTHEST && fabs(o.y) < OTG_RAY_FARTHEST && fabs(o.z) < OTG_RAY_FARTHEST)) {
    answers[i] = OTG_RAY_OPEN;
    return;
  }
  const otg_long_ray line = otgLongRay(o, d, &place);
  __global const float4* nodes = meshes + place.nodes;
  otg_ray_found found = {ray[6], OTG_RAY_NOTHING};
  // Nodes for later, and where the ray enters them, rounded down.
  uint stack[OTG_RAY_STACK];
  float near[OTG_RAY_STACK];
  uint top = 1;
  stack[0] = 0;
  near[0] = 0;
  while (top > 0) {
    --top;
    if ((double)near[top] > found.limit) continue;
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
        double enters;
        if (!otgRayEntersNode(nodes + 2 * child, &line, &enters) || enters > found.limit) continue;
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
    found = otgFirstOfLeaf(meshes + place.soup + 3 * first, (uint)-children, &line, cullBack, found);
  }
  answers[i] = found.triangle;
}
