// SPDX-License-Identifier: BSD-3-Clause
// Arrays of points against one mesh, a work-item to a point: the nearest triangle, and on which side of a solid the
// point lies. As queries/closest_point.cpp and pointInMesh() in collide/inside_test.cpp, through the eight-wide tree.
// Needs doubles. OTG_GROUP is the size of work-groups.
#include "queries/point_inside.h"
#include "shared/layout/queries_given.h"

#define OTG_POINT_KERNEL __kernel __attribute__((reqd_work_group_size(OTG_GROUP, 1, 1)))

inline static otg_vec3_d otgPointAt(__global const double* points, uint i) {
  __global const double* p = points + 3 * (size_t)i;
  return otgVec_d(p[0], p[1], p[2]);
}

/// Of a search: the nearest triangle so far, and no farther ones are looked for.
typedef struct {
  double limit;
  uint triangle;
} otg_point_found;

/// The nearest of the triangles of a leaf and what was found before.
inline static otg_point_found otgNearestOfLeaf(__global const float4* soups, uint count, otg_vec3_d p,
                                               otg_point_found found) {
  for (uint k = 0; k < count; ++k) {
    __global const float4* soup = soups + 3 * k;
    const float4 u0 = soup[0], u1 = soup[1], u2 = soup[2];
    if (as_uint(u1.w) != 0) continue;  // no area
    const otg_vec3_d a = otgPointOf(u0), b = otgPointOf(u1), c = otgPointOf(u2);
    otg_vec3_d on;
    otgNearestOnTriangle_d(a, b, c, p, &on);
    const double distance = otgDistance_d(p, on);
    if (!(distance <= found.limit)) continue;
    const double search = otgSearchDistance_d(a, b, c, p, distance);
    const uint triangle = as_uint(u0.w);
    if (search < found.limit || (search == found.limit && triangle < found.triangle)) {
      found.limit = search;
      found.triangle = triangle;
    }
  }
  return found;
}

/// Point i of `points` (three doubles each, in the mesh's frame) -> answers[i], the nearest triangle.
OTG_POINT_KERNEL void nearestPoints(OTG_GIVEN(NearestPoints)) {
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
  otg_point_found found = {INFINITY, OTG_POINT_NOTHING};
  // Nodes for later, and their squared distances rounded down.
  uint stack[OTG_POINT_STACK];
  float near[OTG_POINT_STACK];
  uint top = 1;
  stack[0] = 0;
  near[0] = 0;
  while (top > 0) {
    --top;
    if ((double)near[top] > found.limit * found.limit) continue;
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
        const double d2 =
            otgBoxDistance2_d(otgPointOf(nodes[2 * child]), otgPointOf(nodes[2 * child + 1]), centred, slack);
        if (d2 > found.limit * found.limit) continue;
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
    found = otgNearestOfLeaf(meshes + place.soup + 3 * first, (uint)-children, p, found);
  }
  answers[i] = found.triangle;
}

/// Which points lie inside a solid: the flag of answers[i], where with `alone` nothing else is and without it what
/// nearestPoints left stays.
OTG_POINT_KERNEL void insidePoints(OTG_GIVEN(InsidePoints)) {
  const uint i = get_global_id(0);
  if (i >= count) return;
  const otg_vec3_d p = otgPointAt(points, i);
  uint answer = alone ? OTG_POINT_NOTHING : answers[i];
  if (answer == OTG_POINT_OPEN) return;
  if (p.x >= bounds.lo[0] && p.y >= bounds.lo[1] && p.z >= bounds.lo[2] && p.x <= bounds.hi[0] &&
      p.y <= bounds.hi[1] && p.z <= bounds.hi[2]) {
    const int side = otgIsPointInside(meshes, place.nodes, place.soup, place.center, place.radius, p, 1);
    if (side < 0) {
      answer = OTG_POINT_OPEN;
    } else if (side > 0) {
      answer |= OTG_POINT_INSIDE;
    }
  }
  answers[i] = answer;
}
