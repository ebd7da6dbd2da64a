// SPDX-License-Identifier: BSD-3-Clause
// The contacts of one pair that stay when there are more than places: the deepest of every region, then always the one
// farthest from all chosen ones. By one work-group.
//
// OTG_KEPT: contacts and regions that one pair may have here, 1,024 at most (a rank has 10 bits).
#ifndef OTG_CONTACT_CHOOSE_H
#define OTG_CONTACT_CHOOSE_H
#include "contact_links.h"

/// Squared distance (22 bits) above a rank counted downwards: the largest is the farthest, ties the smaller rank.
#define OTG_RANK_BITS 10
#define OTG_RANK_MASK 0x3ffu
#define OTG_FAR 0x3fffffu
#define OTG_TAKEN 0xffffffffu

typedef struct {
  ulong depth[OTG_KEPT];   ///< as the bits of a double, which order as its values do
  ulong ids[OTG_KEPT];     ///< triangles; later those of the regions' roots
  uint hit[OTG_KEPT];      ///< by rank: deepest first, ties by triangles
  uint root[OTG_KEPT];     ///< by rank: of the region
  uint2 point[OTG_KEPT];   ///< by rank: otgSpreadPoint, ten bits a coordinate
  uint nearest[OTG_KEPT];  ///< by rank: squared distance to the nearest chosen contact; OTG_TAKEN if chosen
  uint low[3], high[3];
  uint firsts, seeds;
  uint farthest[3];
  uint begin[OTG_GROUP];
} otg_choice;

inline static ulong otgIdsOf(__global const otg_contact_record* r) {
  return (ulong)r->a << 32 | r->b;
}

inline static uint otgSquared(uint x, uint y) {
  const int d = (int)x - (int)y;
  return (uint)(d * d);
}

inline static uint otgSpread(uint2 p, uint2 q) {
  return otgSquared(p.x & 0x3ff, q.x & 0x3ff) + otgSquared(p.x >> 10 & 0x3ff, q.x >> 10 & 0x3ff) +
         otgSquared(p.x >> 20, q.x >> 20) + otgSquared(p.y & 0x3ff, q.y & 0x3ff) +
         otgSquared(p.y >> 10 & 0x3ff, q.y >> 10 & 0x3ff) + otgSquared(p.y >> 20, q.y >> 20);
}

/// Accounts for a chosen contact. Each lane for its own ranks.
inline static void otgSpreadFrom(__local otg_choice* c, uint count, uint taken) {
  const uint2 p = c->point[taken];
  for (uint i = get_local_id(0); i < count; i += OTG_GROUP) {
    const uint nearest = c->nearest[i];
    if (i == taken) {
      c->nearest[i] = OTG_TAKEN;
    } else if (nearest != OTG_TAKEN) {
      c->nearest[i] = min(nearest, otgSpread(c->point[i], p));
    }
  }
}

/// Marks `places` of the `count` ranked contacts, if there are more. The barriers are the same for all pairs: some
/// compilers do not cope with barriers below a condition.
inline static void otgSpreadChoice(const otg_links* l, uint count, uint places, __local otg_choice* c) {
  const uint lane = get_local_id(0), some = count > places ? count : 0;
  for (uint i = lane; i < some; i += OTG_GROUP) atomic_min(otgLink(l, OTG_LINK_FIRST, c->root[i]), i);
  barrier(CLK_LOCAL_MEM_FENCE | CLK_GLOBAL_MEM_FENCE);
  for (uint i = lane; i < some; i += OTG_GROUP) {
    const volatile __global uint* first = otgLink(l, OTG_LINK_FIRST, c->root[i]);
    if (*first == i) {
      c->nearest[i] = OTG_TAKEN;
      c->ids[atomic_inc(&c->seeds)] = i;
    }
    __global const otg_contact_record* r = l->records + c->hit[i];
    for (int k = 0; k < 3; ++k) {
      const uint x = otgOrdered((float)r->position[k]);
      atomic_min(c->low + k, x);
      atomic_max(c->high + k, x);
    }
  }
  barrier(CLK_LOCAL_MEM_FENCE);
  const int crowded = c->seeds >= places;  // at least as many regions as places
  if (crowded && lane == 0) {              // the deepest regions
    uint taken = 0;
    for (uint i = 0; i < some; ++i) {
      if (c->nearest[i] == OTG_TAKEN && taken++ >= places) c->nearest[i] = OTG_FAR;
    }
  }
  float low[3], high[3];
  for (int k = 0; k < 3; ++k) {
    low[k] = otgUnordered(c->low[k]);
    high[k] = otgUnordered(c->high[k]);
  }
  for (uint i = lane; i < some; i += OTG_GROUP) {
    __global const otg_contact_record* r = l->records + c->hit[i];
    int p[6];
    otgSpreadPoint_d(otgPositionOf(r), otgNormalOf(r), low, high, p);
    c->point[i] = (uint2)(p[0] | p[1] << 10 | p[2] << 20, p[3] | p[4] << 10 | p[5] << 20);
  }
  barrier(CLK_LOCAL_MEM_FENCE);
  // First the deepest of each region, then the farthest. One barrier a round: the maximum of a round is cleared while
  // that of the round before is read.
  const uint seeds = c->seeds;
  for (uint round = some > 0 && !crowded ? 0 : places; round < places; ++round) {
    uint best = 0;
    for (uint i = lane; i < count; i += OTG_GROUP) {
      if (c->nearest[i] != OTG_TAKEN) best = max(best, c->nearest[i] << OTG_RANK_BITS | (OTG_RANK_MASK - i));
    }
    if (best) atomic_max(c->farthest + round % 3, best);
    if (lane == 0) c->farthest[(round + 1) % 3] = 0;
    barrier(CLK_LOCAL_MEM_FENCE);
    const uint farthest = OTG_RANK_MASK - (c->farthest[round % 3] & OTG_RANK_MASK);
    otgSpreadFrom(c, count, round < seeds ? (uint)c->ids[round] : farthest);
  }
  barrier(CLK_LOCAL_MEM_FENCE);
}

/// Chooses among the `count` contacts of `kept`, whose regions' roots are `roots`; both at most OTG_KEPT. Writes hit
/// and number of the region, deepest first, and returns how many. All lanes of the group, with the same arguments.
inline static uint otgChoose(const otg_links* l, __global const uint* kept, uint count, __global const uint* roots,
                             uint regions, uint places, __local otg_choice* c, __global uint2* chosen) {
  const uint lane = get_local_id(0);
  if (lane < 3) {
    c->low[lane] = 0xffffffffu;
    c->high[lane] = 0;
    c->farthest[lane] = 0;
  }
  if (lane == 0) c->seeds = 0;
  for (uint i = lane; i < count; i += OTG_GROUP) {
    __global const otg_contact_record* r = l->records + kept[i];
    c->depth[i] = as_ulong(r->depth);
    c->ids[i] = otgIdsOf(r);
  }
  barrier(CLK_LOCAL_MEM_FENCE);
  for (uint i = lane; i < count; i += OTG_GROUP) {
    const ulong depth = c->depth[i], ids = c->ids[i];
    uint rank = 0;
    for (uint j = 0; j < count; ++j) rank += c->depth[j] > depth || (c->depth[j] == depth && c->ids[j] < ids);
    c->hit[rank] = kept[i];
    c->root[rank] = otgFind(l, kept[i]);
    c->nearest[rank] = count > places ? OTG_FAR : OTG_TAKEN;
  }
  barrier(CLK_LOCAL_MEM_FENCE);
  otgSpreadChoice(l, count, places, c);
  // Each lane copies a stretch of ranks to where the lanes before it end.
  const uint stretch = (count + OTG_GROUP - 1) / OTG_GROUP;
  const uint from = min(count, lane * stretch), to = min(count, from + stretch);
  uint place = 0;
  for (uint i = from; i < to; ++i) place += c->nearest[i] == OTG_TAKEN;
  c->begin[lane] = place;
  for (uint i = lane; i < regions; i += OTG_GROUP) c->ids[i] = otgIdsOf(l->records + roots[i]);
  barrier(CLK_LOCAL_MEM_FENCE);
  place = 0;
  if (from < to) {
    for (uint i = 0; i < lane; ++i) place += c->begin[i];
  }
  for (uint i = from; i < to; ++i) {
    if (c->nearest[i] != OTG_TAKEN) continue;
    const ulong mine = otgIdsOf(l->records + c->root[i]);
    uint region = 0;
    for (uint j = 0; j < regions; ++j) region += c->ids[j] < mine;
    chosen[place++] = (uint2)(c->hit[i], region);
  }
  return min(count, places);
}

/// A chosen contact as the host has it: triangles in their callers' numbers.
inline static void otgWriteChosen(const otg_links* l, __global const float4* meshes,
                                  __global const otg_pair_state* state, uint2 chosen,
                                  __global otg_chosen_contact* out) {
  __global const otg_contact_record* r = l->records + chosen.x;
  for (int k = 0; k < 3; ++k) {
    out->position[k] = r->position[k];
    out->normal[k] = r->normal[k];
  }
  out->depth = r->depth;
  out->triangleA = as_uint(meshes[state->ringsA + r->a].w);
  out->triangleB = as_uint(meshes[state->ringsB + r->b].w);
  out->region = chosen.y;
  out->feature = (uint)r->kind;
  out->element = OTG_NOT_THERE;
  out->ordinal = 0;
  out->coherence = -1;
}

#endif  // OTG_CONTACT_CHOOSE_H
