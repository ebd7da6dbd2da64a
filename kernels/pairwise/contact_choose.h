// SPDX-License-Identifier: BSD-3-Clause
// The contacts of one pair that stay when there are more than places: the deepest of every region, then always the one
// farthest from all chosen ones. By one work-group, in local memory.
//
// OTG_KEPT: contacts and regions that one pair may have here, 1,024 at most (a rank has 10 bits). OTG_WARP: 1 where 32
// work-items of successive numbers run in step and `redux.sync` is there (NVIDIA, compute capability 8 and up).
#ifndef OTG_CONTACT_CHOOSE_H
#define OTG_CONTACT_CHOOSE_H
#include "pairwise/contact_links.h"

#ifndef OTG_WARP
#define OTG_WARP 0
#endif

/// Squared distance (22 bits) above a rank counted downwards: the largest is the farthest, ties the smaller rank.
#define OTG_RANK_BITS 10
#define OTG_RANK_MASK 0x3ffu
#define OTG_FAR 0x3fffffu
#define OTG_TAKEN 0xffffffffu

/// Room for them, a multiple of four.
#define OTG_KEPT_ROOM ((OTG_KEPT + 3) / 4 * 4)

typedef struct {
  uint rank[OTG_KEPT_ROOM];   ///< of each contact; later the seeds; later the ranks that were chosen, ascending
  uint order[OTG_KEPT_ROOM];  ///< contact of each rank; before there are ranks, upper halves of the depths
} otg_ranks;

/// Contacts in any order: what the caller fills in. Ranks go from the deepest on, ties by triangles.
typedef struct {
  /// Aligned so that four words are one read.
  ulong depth[OTG_KEPT_ROOM]
      __attribute__((aligned(16)));  ///< as the bits of a double, which order as its values do; later otg_spread
  ulong ids[OTG_KEPT_ROOM];          ///< triangles; later the same
  uint hit[OTG_KEPT_ROOM];           ///< place of the record
  uint region[OTG_KEPT_ROOM];        ///< number
  otg_ranks ranks;
  uint taken[OTG_KEPT / 32 + 1];                ///< a bit for each rank
  uint slots[64] __attribute__((aligned(16)));  ///< of otgLargest
  uint low[3], high[3], seeds;
} otg_choice;

/// By rank, where depths and triangles were.
typedef struct {
  uint2 point[OTG_KEPT];   ///< otgSpreadPoint, ten bits a coordinate
  uint nearest[OTG_KEPT];  ///< squared distance to the nearest chosen contact; OTG_TAKEN if chosen
  uint first[OTG_KEPT];    ///< of a region: smallest rank of its contacts
} otg_spread;

inline static ulong otgIdsOf(uint2 triangles) {
  return (ulong)triangles.x << 32 | triangles.y;
}

/// Contact `i` of the choice: the record's place, its region, and what its rank depends on.
inline static void otgEnterChoice(__local otg_choice* c, uint i, __global const otg_contact_record* records, uint hit,
                                  uint region) {
  __global const otg_contact_record* r = records + hit;
  c->depth[i] = as_ulong(r->depth);
  c->ids[i] = otgIdsOf((uint2)(r->a, r->b));
  c->hit[i] = hit;
  c->region[i] = region;
}

#if OTG_WARP
inline static uint otgWarpMax(uint x) {
  uint y;
  __asm__ volatile("redux.sync.max.u32 %0, %1, 0xffffffff;" : "=r"(y) : "r"(x));
  return y;
}
#endif

/// Work-items that look for the farthest contact: few, so that they need not wait long for each other, where not all
/// have to come to a barrier.
#if OTG_WARP && OTG_GROUP > 128
#define OTG_SEEKERS 128
#else
#define OTG_SEEKERS OTG_GROUP
#endif

/// The largest `x` of the seekers, of which all call it.
inline static uint otgLargest(__local otg_choice* c, uint round, uint x) {
#if OTG_WARP
  const uint lane = get_local_id(0), warps = (OTG_SEEKERS + 31) / 32;
  __local uint* slots = c->slots + round % 2 * 32;
  x = otgWarpMax(x);
  if (warps > 1) {
    if (lane % 32 == 0) slots[lane / 32] = x;
#if OTG_SEEKERS < OTG_GROUP
    __asm__ volatile("bar.sync 1, %0;" ::"n"(OTG_SEEKERS) : "memory");
#else
    barrier(CLK_LOCAL_MEM_FENCE);
#endif
#if OTG_SEEKERS == 128
    const uint4 all = *(__local const uint4*)slots;
    x = max(max(all.x, all.y), max(all.z, all.w));
#else
    x = slots[0];
    for (uint i = 1; i < warps; ++i) x = max(x, slots[i]);
#endif
  }
  return x;
#else
  // The maximum of a round is cleared while that of the round before is read.
  if (x) atomic_max(c->slots + round % 3, x);
  if (get_local_id(0) == 0) c->slots[(round + 1) % 3] = 0;
  barrier(CLK_LOCAL_MEM_FENCE);
  return c->slots[round % 3];
#endif
}

/// Ranks that one lane accounts for.
#define OTG_OWN ((OTG_KEPT + OTG_SEEKERS - 1) / OTG_SEEKERS)

/// Points as floats, which are faster than integers: coordinates from -512 to 511, so that all sums of products that
/// make a squared distance are whole numbers below 2^24, and exact. 2^23 is added to distances, so that their last bits
/// are the number.
#define OTG_BIAS 8388608.0f

/// Coordinates of a point of the grid; returns its squared length.
inline static float otgSpreadCoordinates(uint2 p, float* x) {
  const uint bits[6] = {p.x & 0x3ff, p.x >> 10 & 0x3ff, p.x >> 20, p.y & 0x3ff, p.y >> 10 & 0x3ff, p.y >> 20};
  float length = 0;
  for (int k = 0; k < 6; ++k) {
    x[k] = as_float(bits[k] | 0x4b000000u) - (OTG_BIAS + 512);
    length = fma(x[k], x[k], length);
  }
  return length;
}

/// Accounts for the chosen contact `taken` at `p`; the farthest of the lane's others, of which it has `own`. What a
/// lane knows of each: -2 times its coordinates (`x`, six each). Its squared length and the squared distance to the
/// nearest chosen contact, both with OTG_BIAS. What goes below that in the word of which the largest is looked for.
inline static uint otgSpreadFrom(const float* x, const float* length, float* nearest, uint* key, uint own, uint2 p,
                                 uint taken) {
  float q[6];
  const float lengthOfTaken = otgSpreadCoordinates(p, q);
  uint best = 0;
#pragma unroll
  for (uint k = 0; k < own; ++k) {
    const float positions = fma(x[6 * k], q[0], fma(x[6 * k + 1], q[1], x[6 * k + 2] * q[2]));
    const float normals = fma(x[6 * k + 3], q[3], fma(x[6 * k + 4], q[4], x[6 * k + 5] * q[5]));
    const float distance = length[k] + lengthOfTaken + (positions + normals);
    nearest[k] = distance < nearest[k] ? distance : nearest[k];
    if (get_local_id(0) + k * OTG_SEEKERS == taken) key[k] = 0;
    best = max(best, (as_uint(nearest[k]) << OTG_RANK_BITS) + key[k]);
  }
  return best;
}

/// See otgTakeFarthest. `own`: ranks of each lane, a constant.
inline static void otgTakeWith(__local otg_choice* c, __local otg_spread* s, uint count, uint places, uint seeds,
                               uint own) {
  const uint lane = get_local_id(0);
  float x[6 * OTG_OWN], length[OTG_OWN], nearest[OTG_OWN];
  uint key[OTG_OWN], best = 0;
#pragma unroll
  for (uint k = 0; k < own; ++k) {
    const uint i = lane + k * OTG_SEEKERS;
    const int there = i < count && s->nearest[i] != OTG_TAKEN;
    float p[6];
    length[k] = otgSpreadCoordinates(there ? s->point[i] : (uint2)(0, 0), p) + OTG_BIAS;
    for (int j = 0; j < 6; ++j) x[6 * k + j] = -2 * p[j];
    nearest[k] = there ? OTG_BIAS + OTG_FAR : OTG_BIAS;
    // All zeros if it is not there. One that is may be as near and have the last rank; it is the only one left then.
    key[k] = there ? OTG_RANK_MASK - i : 0;
  }
  for (uint round = 0; round < min(seeds, places); ++round) {
    best = otgSpreadFrom(x, length, nearest, key, own, s->point[c->ranks.rank[round]], c->ranks.rank[round]);
  }
  for (uint round = seeds; round < places; ++round) {
    const uint taken = OTG_RANK_MASK - (otgLargest(c, round, best) & OTG_RANK_MASK);
    best = otgSpreadFrom(x, length, nearest, key, own, s->point[taken], taken);
    if (lane == 0) s->nearest[taken] = OTG_TAKEN;
  }
}

/// The seeds (c->ranks.rank), then always the farthest: ranks that are chosen are OTG_TAKEN in the end. One barrier a
/// round; what a lane needs to know of its ranks stays in registers, of which there are as few as the count allows.
inline static void otgTakeFarthest(__local otg_choice* c, __local otg_spread* s, uint count, uint places, uint seeds) {
#if OTG_WARP
  // Others have nothing to do here; the work-group meets again at a barrier behind this.
  if (get_local_id(0) >= OTG_SEEKERS) return;
  const uint needed = (count + OTG_SEEKERS - 1) / OTG_SEEKERS;
  if (needed <= 1) otgTakeWith(c, s, count, places, seeds, 1);
#if OTG_OWN > 1
  if (needed == 2) otgTakeWith(c, s, count, places, seeds, 2);
#endif
#if OTG_OWN > 2
  if (needed == 3 || needed == 4) otgTakeWith(c, s, count, places, seeds, OTG_OWN < 4 ? OTG_OWN : 4);
#endif
#if OTG_OWN > 4
  if (needed > 4) otgTakeWith(c, s, count, places, seeds, OTG_OWN);
#endif
#else
  otgTakeWith(c, s, count, places, seeds, OTG_OWN);
#endif
}

/// Bits of c->taken below that of rank `i`.
inline static uint otgTakenBefore(__local const otg_choice* c, uint i) {
  uint count = popcount(c->taken[i / 32] & ((1u << i % 32) - 1));
  for (uint word = 0; word < i / 32; ++word) count += popcount(c->taken[word]);
  return count;
}

/// Marks `places` of the `count` ranked contacts, if there are more. The barriers are the same for all pairs: some
/// compilers do not cope with barriers below a condition.
inline static void otgSpreadChoice(__global const otg_contact_record* records, uint count, uint regions, uint places,
                                   __local otg_choice* c, __local otg_spread* s) {
  const uint lane = get_local_id(0), some = count > places ? count : 0;
  for (uint i = lane; i < regions; i += OTG_GROUP) s->first[i] = OTG_NOT_THERE;
  for (uint i = lane; i < count; i += OTG_GROUP) s->nearest[i] = some > 0 ? OTG_FAR : OTG_TAKEN;
  barrier(CLK_LOCAL_MEM_FENCE);
  for (uint i = lane; i < some; i += OTG_GROUP) {
    __global const otg_contact_record* r = records + c->hit[c->ranks.order[i]];
    atomic_min(s->first + c->region[c->ranks.order[i]], i);
    for (int k = 0; k < 3; ++k) {
      const uint x = otgOrdered((float)r->position[k]);
      volatile __local uint *low = c->low + k, *high = c->high + k;
      if (x < *low) atomic_min(low, x);  // most do not widen the bounds
      if (x > *high) atomic_max(high, x);
    }
  }
  barrier(CLK_LOCAL_MEM_FENCE);
  float low[3], high[3];
  for (int k = 0; k < 3; ++k) {
    low[k] = otgUnordered(c->low[k]);
    high[k] = otgUnordered(c->high[k]);
  }
  for (uint i = lane; i < some; i += OTG_GROUP) {
    __global const otg_contact_record* r = records + c->hit[c->ranks.order[i]];
    int p[6];
    otgSpreadPoint_d(otgPositionOf(r), otgNormalOf(r), low, high, p);
    s->point[i] = (uint2)(p[0] | p[1] << 10 | p[2] << 20, p[3] | p[4] << 10 | p[5] << 20);
    if (s->first[c->region[c->ranks.order[i]]] == i) {
      s->nearest[i] = OTG_TAKEN;
      c->ranks.rank[atomic_inc(&c->seeds)] = i;
    }
  }
  barrier(CLK_LOCAL_MEM_FENCE);
  const uint seeds = c->seeds;
  const int crowded = seeds >= places;  // at least as many regions as places: the deepest of them
  for (uint i = lane; i < some && crowded; i += OTG_GROUP) {
    if (s->nearest[i] == OTG_TAKEN) atomic_or(c->taken + i / 32, 1u << i % 32);
  }
  barrier(CLK_LOCAL_MEM_FENCE);
  for (uint i = lane; i < some && crowded; i += OTG_GROUP) {
    if (s->nearest[i] == OTG_TAKEN && otgTakenBefore(c, i) >= places) s->nearest[i] = OTG_FAR;
  }
  barrier(CLK_LOCAL_MEM_FENCE);
  for (uint i = lane; i < OTG_KEPT / 32 + 1; i += OTG_GROUP) c->taken[i] = 0;
  otgTakeFarthest(c, s, some > 0 && !crowded ? count : 0, some > 0 && !crowded ? places : 0, seeds);
  barrier(CLK_LOCAL_MEM_FENCE);
}

/// Adds to c->ranks.rank[i] how many of the contacts `from` to `to` - 1 (both multiples of 4) come before contact `i`.
/// Upper halves of the depths, four at a time, as they are in c->ranks.order, rank nearly all; equal ones are compared
/// whole.
inline static void otgCountBefore(__local otg_choice* c, uint i, uint from, uint to) {
  const uint mine = c->ranks.order[i];
  uint before = 0, equal = 0;
  for (uint j = from; j < to; j += 4) {
    const uint4 other = *(__local const uint4*)(c->ranks.order + j);
    before += (other.x > mine) + (other.y > mine) + (other.z > mine) + (other.w > mine);
    equal += (other.x == mine) + (other.y == mine) + (other.z == mine) + (other.w == mine);
  }
  if (equal > (i >= from && i < to)) {  // more than itself
    const ulong depth = c->depth[i], ids = c->ids[i];
    for (uint j = from; j < to; ++j) {
      if (c->ranks.order[j] != mine) continue;
      before += c->depth[j] > depth || (c->depth[j] == depth && c->ids[j] < ids);
    }
  }
  if (before) atomic_add(c->ranks.rank + i, before);
}

/// Chooses among the `count` contacts that were entered, of regions numbered below `regions`; both at most OTG_KEPT.
/// c->ranks.rank[k] is the rank of the k-th that stays, deepest first; returns how many. All lanes of the group, with
/// the same arguments, after a barrier.
inline static uint otgChoose(__global const otg_contact_record* records, uint count, uint regions, uint places,
                             __local otg_choice* c) {
  const uint lane = get_local_id(0);
  __local otg_spread* s = (__local otg_spread*)c->depth;
  const uint padded = (count + 3) / 4 * 4;
  for (uint i = lane; i < padded; i += OTG_GROUP) {
    c->ranks.rank[i] = 0;
    c->ranks.order[i] = i < count ? (uint)(c->depth[i] >> 32) : 0;
    if (i >= count) c->depth[i] = 0;
    if (i >= count) c->ids[i] = ~(ulong)0;
  }
  for (uint i = lane; i < OTG_KEPT / 32 + 1; i += OTG_GROUP) c->taken[i] = 0;
  if (lane < 3) {
    c->low[lane] = 0xffffffffu;
    c->high[lane] = 0;
    c->slots[lane] = 0;
  }
  if (lane == 0) c->seeds = 0;
  barrier(CLK_LOCAL_MEM_FENCE);
  // Ranks by counting. Few contacts: several lanes to one, each for a part of the others.
  const uint width = (count + 31) / 32 * 32, parts = width > 0 ? max(1u, OTG_GROUP / width) : 1;
  const uint stretch = (padded / 4 + parts - 1) / parts * 4, from = min(parts > 1 ? lane / width * stretch : 0, padded);
  const uint to = min(from + stretch, padded), step = parts > 1 ? width : OTG_GROUP;
  for (uint i = parts > 1 ? lane % width : lane; i < count; i += step) otgCountBefore(c, i, from, to);
  barrier(CLK_LOCAL_MEM_FENCE);
  for (uint i = lane; i < count; i += OTG_GROUP) c->ranks.order[c->ranks.rank[i]] = i;
  barrier(CLK_LOCAL_MEM_FENCE);
  otgSpreadChoice(records, count, regions, places, c, s);
  for (uint i = lane; i < count; i += OTG_GROUP) {
    if (s->nearest[i] == OTG_TAKEN) atomic_or(c->taken + i / 32, 1u << i % 32);
  }
  barrier(CLK_LOCAL_MEM_FENCE);
  for (uint i = lane; i < count; i += OTG_GROUP) {
    if (!(c->taken[i / 32] >> i % 32 & 1)) continue;
    c->ranks.rank[otgTakenBefore(c, i)] = i;
  }
  barrier(CLK_LOCAL_MEM_FENCE);
  return min(count, places);
}

/// A contact as the CPU has it: triangles in their callers' numbers.
inline static void otgWriteContact(__global const otg_contact_record* r, uint region, __global const float4* meshes,
                                   uint ringsA, uint ringsB, __global otg_chosen_contact* out) {
  for (int k = 0; k < 3; ++k) {
    out->position[k] = r->position[k];
    out->normal[k] = r->normal[k];
  }
  out->depth = r->depth;
  out->triangleA = as_uint(meshes[ringsA + r->a].w);
  out->triangleB = as_uint(meshes[ringsB + r->b].w);
  out->region = region;
  out->feature = (uint)r->kind;
  out->element = OTG_NOT_THERE;
  out->ordinal = 0;
  out->coherence = -1;
}

/// The `count` contacts of a choice.
inline static void otgWriteChoice(__local const otg_choice* c, uint count, __global const otg_contact_record* records,
                                  __global const float4* meshes, uint ringsA, uint ringsB,
                                  __global otg_chosen_contact* out) {
  for (uint k = get_local_id(0); k < count; k += OTG_GROUP) {
    const uint i = c->ranks.order[c->ranks.rank[k]];
    otgWriteContact(records + c->hit[i], c->region[i], meshes, ringsA, ringsB, out + k);
  }
}

#endif  // OTG_CONTACT_CHOOSE_H
