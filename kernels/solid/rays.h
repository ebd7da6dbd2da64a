// SPDX-License-Identifier: BSD-3-Clause
// Ways out of a solid along a ray, through the device's trees; as collide/inside_test.cpp, one lane to a ray.
#ifndef OTG_SOLID_RAYS_H
#define OTG_SOLID_RAYS_H
#include "solid/mesh.h"
#include "walk/tree_ray.h"

#define OTG_RAY_STACK 96

/// From `o` along `d` in A's frame.
OTG_INLINED otg_tree_ray otgSolidRay(OTG_MESH* m, otg_vec3_d o, otg_vec3_d d) {
  const otg_vec3_d center = otgVec_d((double)m->center.x, (double)m->center.y, (double)m->center.z);
  return otgTreeRay(otgPointToOwn(m, o), otgDirectionToOwn(m, d), center, (double)m->radius);
}

/// Whether the ray enters the box of a node at most `limit` away.
OTG_INLINED int otgRayMeetsBox(const otg_tree_ray* ray, float4 center, float4 extent, double limit) {
  double enters;
  return otgRayEntersNode(ray, center, extent, &enters) && enters <= limit;
}

/// As exitDistance: 0 where the first surface that the ray meets is entered, -1 where it meets none, -2 where the tree
/// is too deep.
OTG_INLINED double otgExitDistance(__global const float4* meshes, OTG_MESH* m, otg_vec3_d from, otg_vec3_d along,
                                   double limit, double skin) {
  const otg_tree_ray ray = otgSolidRay(m, from, along);
  uint stack[OTG_RAY_STACK];
  uint top = 1;
  double nearest = limit;
  int found = 0, leaves = 0;
  // Of a node all children are looked at together; those that the ray meets are stacked.
  float4 center = meshes[m->nodes], extent = meshes[m->nodes + 1];
  if (!otgRayMeetsBox(&ray, center, extent, nearest)) return -1;
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
        if (otgRayMeetsBox(&ray, meshes[child], meshes[child + 1], nearest)) stack[top++] = first + k;
      }
      continue;
    }
    for (uint k = 0; k < (uint)-count; ++k) {
      double distance;
      const int hits = otgRayHitsSoup(&ray, meshes + m->soup + 3 * (first + k), &distance), leaving = hits == 2;
      if (hits == 0 || !(distance <= nearest)) continue;
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
