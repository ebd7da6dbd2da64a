// SPDX-License-Identifier: BSD-3-Clause
// From the hits of one pair of meshes to its contacts by one work-group: regions, bins and the limit as in
// contact_reduce.cl, with all tables in local memory. For pairs with OTG_KEPT hits at most.
#ifndef OTG_CONTACT_GROUP_H
#define OTG_CONTACT_GROUP_H
#include "pairwise/contact_choose.h"

#define OTG_SLOTS (2 * OTG_KEPT)
#define OTG_NO_KEY ((uint2)(OTG_NOT_THERE, OTG_NOT_THERE))

typedef struct {
  uint2 key[OTG_KEPT];    ///< triangles of a hit; OTG_NO_KEY for one that does not intersect
  uint up[OTG_KEPT];      ///< union-find; later the number of the region
  uint number[OTG_KEPT];  ///< of a root: not 0 if the region has contacts; then its number. Later slots of hits.
  otg_choice choice;
  uint low[3], high[3];
  uint intersecting, contacts, open, roots, kept;
} otg_group_links;

/// A hash table, where the choice will have its ranks.
inline static __local uint* otgGroupTable(__local otg_group_links* g) {
  return (__local uint*)&g->choice.ranks;
}

inline static uint otgFindIn(__local otg_group_links* g, uint hit) {
  volatile __local uint* parent = g->up;
  uint up = parent[hit];
  while (up != hit) {
    const uint next = parent[up];
    if (next != up) parent[hit] = next;
    hit = up;
    up = next;
  }
  return hit;
}

/// As otgUnite.
inline static void otgUniteIn(__local otg_group_links* g, uint x, uint y) {
  for (;;) {
    x = otgFindIn(g, x);
    y = otgFindIn(g, y);
    if (x == y) return;
    const int xFirst = otgLess(g->key[x], g->key[y]);
    const uint low = xFirst ? x : y, high = xFirst ? y : x;
    if (atomic_cmpxchg(g->up + high, high, low) == high) return;
  }
}

/// Unites a hit with the one of these triangles, if there is one.
inline static void otgUniteWith(__local otg_group_links* g, uint hit, uint a, uint b) {
  __local const uint* table = otgGroupTable(g);
  for (uint slot = otgHashPair(0, a, b) & (OTG_SLOTS - 1);; slot = (slot + 1) & (OTG_SLOTS - 1)) {
    const uint entry = table[slot];
    if (entry == 0) return;
    const uint2 key = g->key[entry - 1];
    if (key.x != a || key.y != b) continue;
    otgUniteIn(g, hit, entry - 1);
    return;
  }
}

/// Unites a hit with those of greater numbers whose triangles equal or share an edge with its own: one of the fifteen
/// shares of these.
inline static void otgUniteShare(__local otg_group_links* g, __global const uint* ringsA, __global const uint* ringsB,
                                 uint hit, uint share) {
  const uint2 own = g->key[hit];
  const uint edgeA = share / 4, edgeB = share % 4;
  OTG_FOR_NEIGHBOURS(ringsA, ringsB, own, edgeA, edgeB, otgUniteWith(g, hit, other.x, other.y));
}

inline static void otgEmptyTable(__local otg_group_links* g, uint count) {
  __local uint* table = otgGroupTable(g);
  for (uint i = get_local_id(0); i < OTG_SLOTS && count > 0; i += OTG_GROUP) table[i] = 0;
}

/// Numbers the regions that have contacts; g->up of each hit is its region's number then.
inline static void otgGroupRegions(__local otg_group_links* g, __global const otg_contact_record* records, uint count,
                                   __global const uint* ringsA, __global const uint* ringsB) {
  const uint lane = get_local_id(0);
  __local uint* table = otgGroupTable(g);
  for (uint i = lane; i < count; i += OTG_GROUP) {
    const uint2 key = g->key[i];
    g->up[i] = i;
    g->number[i] = 0;
    if (key.x == OTG_NOT_THERE) continue;
    uint slot = otgHashPair(0, key.x, key.y) & (OTG_SLOTS - 1);
    while (atomic_cmpxchg(table + slot, 0, i + 1) != 0) slot = (slot + 1) & (OTG_SLOTS - 1);
  }
  barrier(CLK_LOCAL_MEM_FENCE);
  for (uint t = lane; t < 15 * count; t += OTG_GROUP) {
    if (g->key[t / 15].x != OTG_NOT_THERE) otgUniteShare(g, ringsA, ringsB, t / 15, 1 + t % 15);
  }
  barrier(CLK_LOCAL_MEM_FENCE);
  for (uint i = lane; i < count; i += OTG_GROUP) {
    if (!otgIsContact(records[i].kind)) continue;
    const uint root = otgFindIn(g, i);
    if (atomic_xchg(g->number + root, 1) == 0) table[atomic_inc(&g->roots)] = root;
  }
  barrier(CLK_LOCAL_MEM_FENCE);
  const uint roots = g->roots;
  for (uint k = lane; k < roots; k += OTG_GROUP) {
    const uint2 mine = g->key[table[k]];
    uint number = 0;
    for (uint j = 0; j < roots; ++j) number += otgLess(g->key[table[j]], mine);
    g->number[table[k]] = number;
  }
  barrier(CLK_LOCAL_MEM_FENCE);
  // Paths are walked while others only shorten theirs; the numbers are written when all have been walked.
  for (uint i = lane; i < count; i += OTG_GROUP) {
    if (g->key[i].x != OTG_NOT_THERE) g->choice.hit[i] = g->number[otgFindIn(g, i)];
  }
  barrier(CLK_LOCAL_MEM_FENCE);
  for (uint i = lane; i < count; i += OTG_GROUP) g->up[i] = g->choice.hit[i];
  otgEmptyTable(g, count);
  barrier(CLK_LOCAL_MEM_FENCE);
}

/// Enters the contacts that stay into the choice: the best of each bin, or all.
inline static void otgGroupBins(__local otg_group_links* g, __global const otg_contact_record* records, uint count,
                                const otg_reduction* how) {
  const uint lane = get_local_id(0), binned = how->method == OTG_REDUCE_BINNING ? count : 0;
  __local uint* table = otgGroupTable(g);
  __local ulong *bins = g->choice.depth, *scores = g->choice.ids;
  float low[3], high[3];
  for (int k = 0; k < 3; ++k) {
    low[k] = otgUnordered(g->low[k]);
    high[k] = otgUnordered(g->high[k]);
  }
  for (uint i = lane; i < binned; i += OTG_GROUP) {
    __global const otg_contact_record* r = records + i;
    double score;
    if (!otgIsContact(r->kind)) continue;
    bins[i] = otgBinOf_d(otgPositionOf(r), otgNormalOf(r), low, high, how->bins, &score);
    scores[i] = as_ulong(score);  // not negative: in the order of their bits
  }
  barrier(CLK_LOCAL_MEM_FENCE);
  for (uint i = lane; i < binned; i += OTG_GROUP) {
    if (!otgIsContact(records[i].kind)) continue;
    const ulong bin = bins[i], score = scores[i];
    uint slot = otgHashPair(0, (uint)(bin >> 32), (uint)bin) & (OTG_SLOTS - 1);
    for (uint entry = table[slot];;) {  // unordered
      if (entry != 0) {
        const uint other = entry - 1;
        if (bins[other] != bin) {
          slot = (slot + 1) & (OTG_SLOTS - 1);
          entry = table[slot];  // unordered
          continue;
        }
        if (scores[other] > score || (scores[other] == score && otgLess(g->key[other], g->key[i]))) break;
      }
      const uint before = atomic_cmpxchg(table + slot, entry, i + 1);
      if (before == entry) break;
      entry = before;
    }
    g->number[i] = slot;
  }
  barrier(CLK_LOCAL_MEM_FENCE);
  // Bins and scores have been read: the choice may be written over them.
  for (uint i = lane; i < count; i += OTG_GROUP) {
    if (!otgIsContact(records[i].kind) || (binned > 0 && table[g->number[i]] != i + 1)) continue;
    otgEnterChoice(&g->choice, atomic_inc(&g->kept), records, i, g->up[i]);
  }
  barrier(CLK_LOCAL_MEM_FENCE);
}

/// Before anything else, with a barrier after it.
inline static void otgBeginGroup(__local otg_group_links* g, uint count) {
  const uint lane = get_local_id(0);
  if (lane < 3) {
    g->low[lane] = 0xffffffffu;
    g->high[lane] = 0;
  }
  if (lane == 0) {
    g->intersecting = 0;
    g->contacts = 0;
    g->open = 0;
    g->roots = 0;
    g->kept = 0;
  }
  otgEmptyTable(g, count);
}

/// Bounds and number of the contacts of one lane.
typedef struct {
  uint low[3], high[3], contacts;
} otg_lane_tally;

inline static otg_lane_tally otgNoTally(void) {
  otg_lane_tally t;
  for (int k = 0; k < 3; ++k) {
    t.low[k] = 0xffffffffu;
    t.high[k] = 0;
  }
  t.contacts = 0;
  return t;
}

/// Hit `i`, whose record has been made.
inline static void otgGroupHit(__local otg_group_links* g, uint i, __global const otg_contact_record* r,
                               otg_lane_tally* tally) {
  const int kind = r->kind;
  g->key[i] = otgIntersects(kind) ? otgTrianglesOf(r) : OTG_NO_KEY;
  if (kind == OTG_RECORD_OPEN) atomic_inc(&g->open);
  if (otgIntersects(kind)) atomic_inc(&g->intersecting);
  if (!otgIsContact(kind)) return;
  ++tally->contacts;
  for (int k = 0; k < 3; ++k) {
    const uint x = otgOrdered((float)r->position[k]);
    tally->low[k] = min(tally->low[k], x);
    tally->high[k] = max(tally->high[k], x);
  }
}

/// Adds a lane's to the group's; a barrier comes after it.
inline static void otgGather(__local otg_group_links* g, const otg_lane_tally* t) {
  if (t->contacts == 0) return;
  atomic_add(&g->contacts, t->contacts);
  for (int k = 0; k < 3; ++k) {
    atomic_min(g->low + k, t->low[k]);
    atomic_max(g->high + k, t->high[k]);
  }
}

/// From `count` records to the choice; returns how many contacts stay. All lanes.
inline static uint otgGroupContacts(__local otg_group_links* g, __global const otg_contact_record* records, uint count,
                                    __global const float4* meshes, uint ringsA, uint ringsB, const otg_reduction* how) {
  otgGroupRegions(g, records, count, (__global const uint*)(meshes + ringsA), (__global const uint*)(meshes + ringsB));
  otgGroupBins(g, records, count, how);
  return otgChoose(records, g->kept, g->roots, how->places, &g->choice);
}

#endif  // OTG_CONTACT_GROUP_H
