// SPDX-License-Identifier: BSD-3-Clause
// Arrays of rays against one mesh, a work-item to a ray: the triangle that it hits first. As queries/ray_cast.cpp,
// through the eight-wide tree. Needs doubles. OTG_GROUP is the size of work-groups.
#define OTG_REAL_FLOAT
#include "shared/layout/ray_layout.h"
#undef OTG_REAL_FLOAT
#include "walk/tree_ray.h"
//
#include "shared/layout/queries_given.h"

/// The triangle that is hit first so far, and where.
typedef struct {
  double limit;
  uint triangle;
} otg_ray_found;

/// The first of the triangles of a leaf and what was found before.
inline static otg_ray_found otgFirstOfLeaf(__global const float4* soups, uint count, const otg_tree_ray* ray,
                                           uint cullBack, otg_ray_found found) {
  for (uint k = 0; k < count; ++k) {
    double at;
    const int hits = otgRayHitsSoup(ray, soups + 3 * k, &at);
    if (hits == 0 || !(at <= found.limit) || (cullBack && hits == 2)) continue;
    const uint triangle = as_uint(soups[3 * k].w);
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
  const otg_vec3_d center = otgVec_d((double)place.center.x, (double)place.center.y, (double)place.center.z);
  const otg_tree_ray line = otgTreeRay(o, d, center, (double)place.radius);
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
        if (!otgRayEntersNode(&line, nodes[2 * child], nodes[2 * child + 1], &enters) || enters > found.limit) continue;
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
