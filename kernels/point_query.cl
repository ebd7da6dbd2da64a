// SPDX-License-Identifier: BSD-3-Clause
// Arrays of points against one mesh, a work-item to a point: the nearest triangle, and on which side of a solid the
// point lies. As queries/closest_point.cpp and pointInMesh() in collide/solid/ray.cpp, through the eight-wide tree.
// Needs doubles. OTG_GROUP is the size of work-groups.
#define OTG_REAL_FLOAT
#include "shared/point_layout.h"
#undef OTG_REAL_FLOAT
#define OTG_REAL_DOUBLE
#include "shared/point_test.h"
#undef OTG_REAL_DOUBLE

#define OTG_POINT_KERNEL __kernel __attribute__((reqd_work_group_size(OTG_GROUP, 1, 1)))

inline static otg_vec3_d otgPointOf(float4 v) {
  return otgVec_d((double)v.x, (double)v.y, (double)v.z);
}

inline static otg_vec3_d otgPointAt(__global const double* points, uint i) {
  __global const double* p = points + 3 * (size_t)i;
  return otgVec_d(p[0], p[1], p[2]);
}

/// Point i of `points` (three doubles each, in the mesh's frame) -> answers[i], the nearest triangle.
OTG_POINT_KERNEL void nearestPoints(const otg_device_mesh place, __global const float4* restrict meshes,
                                    __global const double* restrict points, uint count,
                                    __global uint* restrict answers) {
  const uint i = get_global_id(0);
  if (i >= count) return;
  const otg_vec3_d p = otgPointAt(points, i);
  if (!(fabs(p.x) < OTG_POINT_FARTHEST && fabs(p.y) < OTG_POINT_FARTHEST && fabs(p.z) < OTG_POINT_FARTHEST)) {
    answers[i] = OTG_POINT_OPEN;
    return;
  }
  const otg_vec3_d centred =
      otgSub_d(p, otgVec_d((double)place.center.x, (double)place.center.y, (double)place.center.z));
  __global const float4* nodes = meshes + place.nodes;
  const double slack = otgSearchSlack_d(centred, otgPointOf(nodes[0]), otgPointOf(nodes[1]));
  double limit = INFINITY;
  uint best = OTG_POINT_NOTHING;
  // Nodes for later, and their squared distances rounded down.
  uint stack[OTG_POINT_STACK];
  float near[OTG_POINT_STACK];
  uint top = 1;
  stack[0] = 0;
  near[0] = 0;
  while (top > 0) {
    --top;
    if ((double)near[top] > limit * limit) continue;
    const uint node = 2 * stack[top];
    const uint first = as_uint(nodes[node].w);
    const int children = as_int(nodes[node + 1].w);
    if (children > 0) {
      if (top + (uint)children > OTG_POINT_STACK) {
        answers[i] = OTG_POINT_OPEN;
        return;
      }
      // The nearest child comes to lie on top; the others in no order, which costs less than it saves.
      float least = INFINITY;
      for (uint k = 0; k < (uint)children; ++k) {
        const uint child = first + k;
        const double d2 = otgBoxDistance2_d(otgPointOf(nodes[2 * child]), otgPointOf(nodes[2 * child + 1]), centred, slack);
        if (d2 > limit * limit) continue;
        const float d = convert_float_rtz(d2);
        if (d < least) {
          least = d;
          stack[top] = child;
          near[top] = d;
        } else {
          stack[top] = stack[top - 1];
          near[top] = near[top - 1];
          stack[top - 1] = child;
          near[top - 1] = d;
        }
        ++top;
      }
      continue;
    }
    for (uint k = 0; k < (uint)-children; ++k) {
      __global const float4* soup = meshes + place.soup + 3 * (first + k);
      const float4 u0 = soup[0], u1 = soup[1], u2 = soup[2];
      if (as_uint(u1.w) != 0) continue;  // no area
      const otg_vec3_d a = otgPointOf(u0), b = otgPointOf(u1), c = otgPointOf(u2);
      otg_vec3_d on;
      otgNearestOnTriangle_d(a, b, c, p, &on);
      const double distance = otgDistance_d(p, on);
      if (!(distance <= limit)) continue;
      const double search = otgSearchDistance_d(a, b, c, p, distance);
      const uint triangle = as_uint(u0.w);
      if (search < limit || (search == limit && triangle < best)) {
        limit = search;
        best = triangle;
      }
    }
  }
  answers[i] = best;
}

/// How often a ray leaves the mesh more than it enters it; with 1 in `deep` where the tree is too deep.
inline static int otgCrossings(const otg_device_mesh* place, __global const float4* restrict meshes, otg_vec3_d o,
                               otg_vec3_d centred, otg_vec3_d d, double reach, int* deep) {
  __global const float4* nodes = meshes + place->nodes;
  const otg_vec3_d inverse = otgVec_d(1 / d.x, 1 / d.y, 1 / d.z);
  const otg_vec3_d wider = otgVec_d(2 * reach, 2 * reach, 2 * reach);
  uint stack[OTG_POINT_STACK];
  uint top = 1;
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
      __global const float4* soup = meshes + place->soup + 3 * (first + k);
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

typedef struct {
  double lo[3], hi[3];
} otg_point_bounds;

/// Which points lie inside a solid: the flag of answers[i], where with `alone` nothing else is and without it what
/// nearestPoints left stays.
OTG_POINT_KERNEL void insidePoints(const otg_device_mesh place, __global const float4* restrict meshes,
                                   __global const double* restrict points, uint count, const otg_point_bounds bounds,
                                   uint alone, __global uint* restrict answers) {
  const uint i = get_global_id(0);
  if (i >= count) return;
  const otg_vec3_d p = otgPointAt(points, i);
  uint answer = alone ? OTG_POINT_NOTHING : answers[i];
  if (answer == OTG_POINT_OPEN) return;
  if (p.x >= bounds.lo[0] && p.y >= bounds.lo[1] && p.z >= bounds.lo[2] && p.x <= bounds.hi[0] &&
      p.y <= bounds.hi[1] && p.z <= bounds.hi[2]) {
    const otg_vec3_d origin = otgVec_d((double)place.center.x, (double)place.center.y, (double)place.center.z);
    const otg_vec3_d centred = otgSub_d(p, origin);
    const double reach = otgRayReach_d((double)place.radius, centred, origin);
    int votes = 0, deep = 0;
    for (int k = 0; k < 3 && votes != 2 && votes != -2; ++k) {
      votes += otgCrossings(&place, meshes, p, centred, otgParityDirection_d(k), reach, &deep) > 0 ? 1 : -1;
    }
    if (deep) {
      answer = OTG_POINT_OPEN;
    } else if (votes > 0) {
      answer |= OTG_POINT_INSIDE;
    }
  }
  answers[i] = answer;
}
