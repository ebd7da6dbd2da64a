// SPDX-License-Identifier: BSD-3-Clause
// The ways out of either mesh from one point, by one work-group: eight lanes look at the children of one node. As
// otgExitDistance of solid/rays.h for two rays at once.
#ifndef OTG_OVERLAP_RAYS_H
#define OTG_OVERLAP_RAYS_H
#include "solid/large/found.h"
//
#include "solid/rays.h"

#define OTG_RAY_PLACES 512
#if OTG_GROUP >= 8
#define OTG_NODE_LANES 8
#else
#define OTG_NODE_LANES 1
#endif
#define OTG_NODES_AT_ONCE (OTG_GROUP / OTG_NODE_LANES)

/// By ray: out of B, and back out of A.
typedef struct {
  otg_tree_ray ray[2];
  ulong nearest[2];             ///< bits of a double that is not negative
  ulong leaves[2], enters[2];   ///< the nearest of either kind; ~0: none
  uint2 stack[OTG_RAY_PLACES];  ///< first child or triangle; their number and the ray
  uint top, bad;
} otg_ray_scratch;

OTG_INLINED uint2 otgRayEntry(uint ray, float4 center, float4 extent) {
  return (uint2)(as_uint(center.w), ((uint)as_int(extent.w) & 0xffffu) << 1 | ray);
}

/// One lane's children of a node, or triangles of a leaf.
OTG_INLINED void otgOpenForRay(__local otg_ray_scratch* s, __global const float4* meshes, OTG_PAIR_MESH* mesh,
                               uint2 entry, uint lane, double skin) {
  const uint ray = entry.y & 1;
  const int count = (int)(short)(entry.y >> 1);
  OTG_MESH* m = &mesh[1 - ray].solid;
  const otg_tree_ray line = s->ray[ray];
  for (uint k = lane; (int)k < count; k += OTG_NODE_LANES) {
    const uint child = m->nodes + 2 * (entry.x + k);
    const float4 center = meshes[child], extent = meshes[child + 1];
    const double nearest = as_double(*(volatile __local ulong*)(s->nearest + ray));
    if (!otgRayMeetsBox(&line, center, extent, nearest)) continue;
    const uint place = atomic_inc(&s->top);
    if (place < OTG_RAY_PLACES) {
      s->stack[place] = otgRayEntry(ray, center, extent);
    } else {
      s->bad = 1;
    }
  }
  for (uint k = lane; (int)k < -count; k += OTG_NODE_LANES) {
    double distance;
    const int hits = otgRayHitsSoup(&line, meshes + m->soup + 3 * (entry.x + k), &distance), leaving = hits == 2;
    if (hits == 0 || (!leaving && distance <= skin)) continue;
    const ulong bits = as_ulong(distance + 0.0);  // -0 and 0 are one
    if (bits > s->nearest[ray]) continue;         // unordered
    atom_min(leaving ? s->leaves + ray : s->enters + ray, bits);
    atom_min(s->nearest + ray, bits);
  }
}

/// As exitDistance, of both rays from a point in A's frame: out of B along d, back out of A against it. All lanes call
/// it. 0 if the trees are too deep.
OTG_INLINED int otgExitDistances(__local otg_ray_scratch* s, __global const float4* meshes, OTG_PAIR_MESH* mesh,
                                 otg_vec3_d from, otg_vec3_d d, double limit, double skin, double* ways) {
  const uint lane = get_local_id(0);
  OTG_SYNC;
  if (lane == 0) {
    s->top = 0;
    s->bad = 0;
  }
  OTG_SYNC;
  for (uint ray = lane; ray < 2; ray += OTG_GROUP) {
    OTG_MESH* m = &mesh[1 - ray].solid;
    const otg_tree_ray line = otgSolidRay(m, from, ray == 0 ? d : otgScale_d(d, -1.0));
    s->ray[ray] = line;
    s->nearest[ray] = as_ulong(limit);
    s->leaves[ray] = s->enters[ray] = ~0ul;
    const float4 center = meshes[m->nodes], extent = meshes[m->nodes + 1];
    if (otgRayMeetsBox(&line, center, extent, limit)) {
      s->stack[atomic_inc(&s->top)] = otgRayEntry(ray, center, extent);
    }
  }
  OTG_SYNC;
  for (uint top = s->top; top > 0;) {
    // As many at once as there is room for what may come of them.
    const uint room = (OTG_RAY_PLACES - top) / 7, most = min(top, (uint)OTG_NODES_AT_ONCE);
    const uint count = room < 1 ? 1 : min(most, room);
    const uint own = lane / OTG_NODE_LANES;
    const uint2 entry = own < count ? s->stack[top - 1 - own] : (uint2)(0, 0);
    OTG_SYNC;
    if (lane == 0) s->top = top - count;
    OTG_SYNC;
    if (own < count) otgOpenForRay(s, meshes, mesh, entry, lane % OTG_NODE_LANES, skin);
    OTG_SYNC;
    top = s->bad ? 0 : s->top;
    OTG_SYNC;
  }
  for (uint ray = 0; ray < 2; ++ray) {
    const ulong leaves = s->leaves[ray], enters = s->enters[ray];
    ways[ray] = leaves == ~0ul && enters == ~0ul ? -1 : leaves <= enters ? as_double(leaves) : 0;
  }
  return !s->bad;
}

#endif  // OTG_OVERLAP_RAYS_H
