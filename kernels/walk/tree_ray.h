// SPDX-License-Identifier: BSD-3-Clause
// A ray against the nodes and triangles of a packed tree: what all searches along rays need. Needs doubles. Which
// triangles count, and where, depends on the ray and the triangle alone, so that every search finds the same nearest
// one.
#ifndef OTG_TREE_RAY_H
#define OTG_TREE_RAY_H
#include "solid/inlined.h"
//
#define OTG_REAL_DOUBLE
#include "shared/tests/point_test.h"
#undef OTG_REAL_DOUBLE

/// As tests of boxes and triangles have it: from `o` along `d` in the mesh's own frame, from `from` along `along` in
/// the centred one.
typedef struct {
  otg_vec3_d o, d, from, along, inverse;
  double reach;
} otg_tree_ray;

OTG_INLINED otg_vec3_d otgUnitInDouble(float4 v) {
  return otgVec_d((double)v.x, (double)v.y, (double)v.z);
}

/// From `o` along `d` in the frame of a mesh with this centre and radius.
OTG_INLINED otg_tree_ray otgTreeRay(otg_vec3_d o, otg_vec3_d d, otg_vec3_d center, double radius) {
  otg_tree_ray ray;
  ray.o = o;
  ray.d = d;
  ray.from = otgSub_d(o, center);
  ray.along = otgRayAlong_d(d);
  ray.inverse = otgVec_d(1 / ray.along.x, 1 / ray.along.y, 1 / ray.along.z);
  ray.reach = otgRayReach_d(radius, ray.from, center);
  return ray;
}

/// Whether the ray meets the box of a node, and where it enters it.
OTG_INLINED int otgRayEntersNode(const otg_tree_ray* ray, float4 center, float4 extent, double* enters) {
  const otg_vec3_d middle = otgUnitInDouble(center), wider = otgVec_d(2 * ray->reach, 2 * ray->reach, 2 * ray->reach);
  const otg_vec3_d sides = otgAdd_d(otgUnitInDouble(extent), wider);
  return otgRayEntersBox_d(ray->from, ray->along, ray->inverse, otgSub_d(middle, sides), otgAdd_d(middle, sides),
                           enters);
}

/// How the ray hits the triangle at a place in a soup, and how far: 2 where it faces along the ray, 1 where against
/// it; 0 where it is not hit or has no area.
OTG_INLINED int otgRayHitsSoup(const otg_tree_ray* ray, __global const float4* soup, double* distance) {
  const float4 u0 = soup[0], u1 = soup[1], u2 = soup[2];
  if (as_uint(u1.w) != 0) return 0;  // no area
  return otgRayHitsTriangle_d(ray->o, ray->d, ray->along, ray->inverse, otgUnitInDouble(u0), otgUnitInDouble(u1),
                              otgUnitInDouble(u2), ray->reach, distance);
}

#endif  // OTG_TREE_RAY_H
