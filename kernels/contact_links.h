// SPDX-License-Identifier: BSD-3-Clause
// Hits of a query as a graph: found by their triangles through a hash table, united over shared edges, and chosen one
// for each bin. Everything is decided by the triangles' numbers and the contacts themselves; slots of tables and places
// in the list of hits, which depend on how work-groups were scheduled, only say where something lies.
#ifndef OTG_CONTACT_LINKS_H
#define OTG_CONTACT_LINKS_H
#include "pair_record.h"

#ifdef OTG_WITH_DOUBLE
#define OTG_REAL_DOUBLE
#include "shared/contact_choice.h"
#undef OTG_REAL_DOUBLE
#endif

/// Where the lists of the choice are. `capacity`: places in the list of hits; a table has at least twice as many slots,
/// of which a query uses as few as it needs.
typedef struct {
  __global const otg_contact_record* records;
  __global uint* links;
  __global uint* pairTable;
  __global uint* binTable;
  uint capacity, mask;
} otg_links;

inline static __global uint* otgLink(const otg_links* l, uint what, uint hit) {
  return l->links + (size_t)what * l->capacity + hit;
}

/// Slots minus one for so many hits.
inline static uint otgTableMask(uint hits) {
  uint mask = 63;
  while (mask + 1 < 2 * hits) mask = 2 * mask + 1;
  return mask;
}

inline static otg_links otgLinksOf(__global const uint* counters, __global uchar* records, __global uint* links,
                                   __global uint* tables, uint tableSize, uint capacity) {
  otg_links l;
  l.records = (__global const otg_contact_record*)(records + OTG_RESULT_HEAD);
  l.links = links;
  l.pairTable = tables;
  l.binTable = tables + tableSize;
  l.capacity = capacity;
  l.mask = otgTableMask(min(counters[OTG_COUNT_HITS], capacity));
  return l;
}

/// Floats as unsigned integers in the same order (-0 below +0).
inline static uint otgOrdered(float x) {
  const uint bits = as_uint(x);
  return bits & 0x80000000u ? ~bits : bits | 0x80000000u;
}

inline static float otgUnordered(uint x) {
  return as_float(x & 0x80000000u ? x & 0x7fffffffu : ~x);
}

inline static uint otgHashPair(uint pair, uint a, uint b) {
  uint h = a * 0x9e3779b1u ^ b * 0x85ebca6bu ^ pair * 0xc2b2ae35u;
  h ^= h >> 15;
  h *= 0x2c1b3c6du;
  return h ^ h >> 12;
}

/// The smallest hit of the region, shortening the way for others.
inline static uint otgFind(const otg_links* l, uint hit) {
  volatile __global uint* parent = l->links;  // OTG_LINK_PARENT
  uint up = parent[hit];
  while (up != hit) {
    const uint next = parent[up];
    if (next != up) parent[hit] = next;
    hit = up;
    up = next;
  }
  return hit;
}

inline static int otgLessRecord(__global const otg_contact_record* x, __global const otg_contact_record* y) {
  return x->a < y->a || (x->a == y->a && x->b < y->b);
}

/// Roots are hung below roots of smaller pairs of triangles only, so the root of a region is its smallest pair, in
/// whatever order that happens.
inline static void otgUnite(const otg_links* l, uint x, uint y) {
  for (;;) {
    x = otgFind(l, x);
    y = otgFind(l, y);
    if (x == y) return;
    const int xFirst = otgLessRecord(l->records + x, l->records + y);
    const uint low = xFirst ? x : y, high = xFirst ? y : x;
    if (atomic_cmpxchg(otgLink(l, OTG_LINK_PARENT, high), high, low) == high) return;
  }
}

/// The hit of these triangles, or OTG_NOT_THERE.
inline static uint otgLookUp(const otg_links* l, uint pair, uint a, uint b) {
  for (uint slot = otgHashPair(pair, a, b) & l->mask;; slot = (slot + 1) & l->mask) {
    const uint entry = l->pairTable[slot];
    if (entry == 0) return OTG_NOT_THERE;
    __global const otg_contact_record* r = l->records + (entry - 1);
    if (r->a == a && r->b == b && r->pair == pair) return entry - 1;
  }
}

/// The half-edge after `g` in the ring of half-edge `h`; `h` when that was the last.
inline static uint otgNextOnEdge(__global const uint* rings, uint h, uint g) {
  const uint next = rings[4 * (g / 3) + g % 3];
  // With two in the ring the second need not be asked for the first.
  if (g != h && (next & OTG_RING_TWIN)) return h;
  return next & OTG_RING_HALF_EDGE;
}

/// Unites the hit with those hits of greater numbers whose triangle of A is a2 and whose triangle of B equals or shares
/// an edge with the hit's.
inline static void otgUniteAlongB(const otg_links* l, __global const uint* ringsB, uint hit, uint pair, uint a, uint b,
                                  uint a2) {
  if (a2 < a) return;
  if (a2 > a) {
    const uint other = otgLookUp(l, pair, a2, b);
    if (other != OTG_NOT_THERE) otgUnite(l, hit, other);
  }
  for (uint k = 0; k < 3; ++k) {
    const uint h = 3 * b + k;
    for (uint g = otgNextOnEdge(ringsB, h, h); g != h; g = otgNextOnEdge(ringsB, h, g)) {
      const uint b2 = g / 3;
      if (a2 == a && b2 < b) continue;
      const uint other = otgLookUp(l, pair, a2, b2);
      if (other != OTG_NOT_THERE) otgUnite(l, hit, other);
    }
  }
}

/// One of four shares of a hit's unions: by the triangle of A itself (0) or over one of its edges (1 to 3).
inline static void otgUniteShare(const otg_links* l, __global const uint* ringsA, __global const uint* ringsB, uint hit,
                                 uint share) {
  __global const otg_contact_record* r = l->records + hit;
  if (share == 0) {
    otgUniteAlongB(l, ringsB, hit, r->pair, r->a, r->b, r->a);
    return;
  }
  const uint h = 3 * r->a + share - 1;
  for (uint g = otgNextOnEdge(ringsA, h, h); g != h; g = otgNextOnEdge(ringsA, h, g)) {
    otgUniteAlongB(l, ringsB, hit, r->pair, r->a, r->b, g / 3);
  }
}

inline static int otgIsContact(int kind) {
  return kind == OTG_RECORD_FACE_A || kind == OTG_RECORD_FACE_B || kind == OTG_RECORD_COPLANAR;
}

inline static int otgIntersects(int kind) {
  return otgIsContact(kind) || kind == OTG_RECORD_NO_CONTACT;
}

#if OTG_CONTACTS
inline static otg_vec3_d otgPositionOf(__global const otg_contact_record* r) {
  return otgVec_d(r->position[0], r->position[1], r->position[2]);
}

inline static otg_vec3_d otgNormalOf(__global const otg_contact_record* r) {
  return otgVec_d(r->normal[0], r->normal[1], r->normal[2]);
}

/// Puts the contact of a hit into the table of bins. A slot holds the best so far, so who comes last does not matter.
inline static void otgEnterBin(const otg_links* l, __global const otg_pair_state* state, const otg_reduction* how,
                               uint hit) {
  __global const otg_contact_record* mine = l->records + hit;
  float low[3], high[3];
  double score;
  for (int k = 0; k < 3; ++k) {
    low[k] = otgUnordered(state->low[k]);
    high[k] = otgUnordered(state->high[k]);
  }
  const ulong bin = otgBinOf_d(otgPositionOf(mine), otgNormalOf(mine), low, high, how->bins, &score);
  for (uint slot = otgHashPair(mine->pair, (uint)(bin >> 32), (uint)bin) & l->mask;; slot = (slot + 1) & l->mask) {
    uint entry = l->binTable[slot];
    for (;;) {
      if (entry != 0) {
        __global const otg_contact_record* other = l->records + (entry - 1);
        double otherScore;
        if (other->pair != mine->pair ||
            otgBinOf_d(otgPositionOf(other), otgNormalOf(other), low, high, how->bins, &otherScore) != bin) {
          break;  // another bin's
        }
        if (otherScore > score || (otherScore == score && otgLessRecord(other, mine))) return;
      }
      const uint before = atomic_cmpxchg(l->binTable + slot, entry, hit + 1);
      if (before == entry) {
        *otgLink(l, OTG_LINK_BIN_SLOT, hit) = slot;
        return;
      }
      entry = before;
    }
  }
}

/// Bounds and counts of one work-group's contacts, added to the pair's at the end: all hits are of one pair.
typedef struct {
  uint low[3], high[3], intersecting, contacts;
} otg_tally;

/// After a hit's record was written: a root of its own, findable by its triangles, and counted. With OTG_SINGLE in
/// `tally`, which the kernel adds to the state.
inline static void otgEnterHit(const otg_links* l, __global otg_pair_state* states, __global uint* flags, uint hit,
                               __local otg_tally* tally) {
  __global const otg_contact_record* r = l->records + hit;
  __global otg_pair_state* state = states + r->pair;
  *otgLink(l, OTG_LINK_PARENT, hit) = hit;
  *otgLink(l, OTG_LINK_FIRST, hit) = OTG_NOT_THERE;
  *otgLink(l, OTG_LINK_MARK, hit) = 0;
  *otgLink(l, OTG_LINK_PAIR_SLOT, hit) = OTG_NOT_THERE;
  *otgLink(l, OTG_LINK_BIN_SLOT, hit) = OTG_NOT_THERE;
  if (r->kind == OTG_RECORD_OPEN) atomic_or(flags + r->pair, OTG_PAIR_TO_HOST);
  if (!otgIntersects(r->kind)) return;
  uint slot = otgHashPair(r->pair, r->a, r->b) & l->mask;
  while (atomic_cmpxchg(l->pairTable + slot, 0, hit + 1) != 0) slot = (slot + 1) & l->mask;
  *otgLink(l, OTG_LINK_PAIR_SLOT, hit) = slot;
#if OTG_SINGLE
  atomic_inc(&tally->intersecting);
#else
  atomic_inc(&state->intersecting);
#endif
  if (!otgIsContact(r->kind)) return;
  for (int k = 0; k < 3; ++k) {
    const uint x = otgOrdered((float)r->position[k]);
#if OTG_SINGLE
    atomic_min(tally->low + k, x);
    atomic_max(tally->high + k, x);
#else
    // Most do not widen the bounds, and reading is cheaper.
    volatile __global uint *low = state->low + k, *high = state->high + k;
    if (x < *low) atomic_min(low, x);
    if (x > *high) atomic_max(high, x);
#endif
  }
#if OTG_SINGLE
  atomic_inc(&tally->contacts);
#else
  atomic_inc(&state->contacts);
#endif
}
#endif

#endif  // OTG_CONTACT_LINKS_H
