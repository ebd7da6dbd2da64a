// SPDX-License-Identifier: BSD-3-Clause
// Ways out of a solid along a ray, through the device's trees; as collide/inside_test.cpp, one lane to a ray.
#ifndef OTG_SOLID_RAYS_H
#define OTG_SOLID_RAYS_H
#include "solid/mesh.h"
//
#define OTG_REAL_DOUBLE
#include "shared/tests/point_test.h"
#undef OTG_REAL_DOUBLE

#define OTG_RAY_STACK 96

/// A ray as tests of boxes and triangles have it (shared/tests/point_test.h): from `o` along `d` in the mesh's own
/// frame, from `from` along `along` in the centred one.
typedef struct {
  otg_vec3_d o, d, from, along, inverse;
  double reach;
} otg_solid_ray;

OTG_INLINED otg_solid_ray otgSolidRay(OTG_MESH* m, otg_vec3_d o, otg_vec3_d d) {
  const otg_vec3_d origin = otgVec_d((double)m->center.x, (double)m->center.y, (double)m->center.z);
  otg_solid_ray ray;
  ray.o = o;
  ray.d = d;
  ray.from = otgSub_d(o, origin);
  ray.along = otgRayAlong_d(d);
  ray.inverse = otgVec_d(1 / ray.along.x, 1 / ray.along.y, 1 / ray.along.z);
  ray.reach = otgRayReach_d((double)m->radius, ray.from, origin);
  return ray;
}

/// Whether the ray enters the box of a node at most `limit` away.
OTG_INLINED int otgRayMeetsBox(const otg_solid_ray* ray, float4 center, float4 extent, double limit) {
  const otg_vec3_d middle = otgVec_d((double)center.x, (double)center.y, (double)center.z);
  const double wider = 2 * ray->reach;
  const otg_vec3_d sides = otgVec_d((double)extent.x + wider, (double)extent.y + wider, (double)extent.z + wider);
  double near;
  return otgRayEntersBox_d(ray->from, ray->along, ray->inverse, otgSub_d(middle, sides), otgAdd_d(middle, sides),
                           &near) &&
         near <= limit;
}

/// Where the ray hits a triangle that has an area: 1, how far, and whether it leaves the solid there.
OTG_INLINED int otgRayHitsSoup(__global const float4* meshes, uint soup, const otg_solid_ray* ray, double* distance,
                               int* leaving) {
  const float4 u0 = meshes[soup], u1 = meshes[soup + 1], u2 = meshes[soup + 2];
  if (as_uint(u1.w) != 0) return 0;  // no area
  const int hits =
      otgRayHitsTriangle_d(ray->o, ray->d, ray->along, ray->inverse, otgVec_d((double)u0.x, (double)u0.y, (double)u0.z),
                           otgVec_d((double)u1.x, (double)u1.y, (double)u1.z),
                           otgVec_d((double)u2.x, (double)u2.y, (double)u2.z), ray->reach, distance);
  *leaving = hits == 2;
  return hits != 0;
}

/// As exitDistance: 0 where the first surface that the ray meets is entered, -1 where it meets none, -2 where the tree
/// is too deep.
OTG_INLINED double otgExitDistance(__global const float4* meshes, OTG_MESH* m, otg_vec3_d from, otg_vec3_d along,
                                   double limit, double skin) {
  const otg_solid_ray ray = otgSolidRay(m, otgPointToOwn(m, from), otgDirectionToOwn(m, along));
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
      int leaving;
      if (!otgRayHitsSoup(meshes, m->soup + 3 * (first + k), &ray, &distance, &leaving)) continue;
      if (!(distance <= nearest)) continue;
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
