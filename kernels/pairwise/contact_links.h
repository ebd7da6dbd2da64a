// SPDX-License-Identifier: BSD-3-Clause
// Hits of a query as a graph: found by their triangles through a hash table, united over shared edges, and chosen one
// for each bin. Everything is decided by the triangles' numbers and the contacts themselves; slots of tables and places
// in the list of hits, which depend on how work-groups were scheduled, only say where something lies.
#ifndef OTG_CONTACT_LINKS_H
#define OTG_CONTACT_LINKS_H
#include "pairwise/pair_record.h"

#ifdef OTG_WITH_DOUBLE
#define OTG_REAL_DOUBLE
#include "shared/contacts/contact_choice.h"
#undef OTG_REAL_DOUBLE
#endif

/// Where the lists of the choice are. `capacity`: places in the list of hits; a table has four times as many slots, of
/// which a query uses as few as it needs. Entries of tables are a hit's number plus one, with bits of the hash above.
typedef struct {
  __global const otg_contact_record* records;
  __global uint* links;
  __global uint* pairTable;  ///< of pairs of triangles
  __global uint* binTable;   ///< of bins: whoever came first
  __global uint* binScore;   ///< the highest score of a bin: its upper half, plus one
  __global uint* binBest;    ///< a hit plus one: the best of the bin, of those whose score is that
  uint capacity, mask;
  uint bins;  ///< not 0: so many bins, each with the slot of its number; else they are hashed
} otg_links;

inline static __global uint* otgLink(const otg_links* l, uint what, uint hit) {
  return l->links + (size_t)what * l->capacity + hit;
}

/// Slots minus one for so many hits.
inline static uint otgTableMask(uint hits) {
  uint mask = 63;
  while (mask + 1 < 4 * hits) mask = 2 * mask + 1;
  return mask;
}

inline static otg_links otgLinksOf(__global const uint* counters, __global uchar* records, __global uint* links,
                                   __global uint* tables, uint tableSize, uint capacity) {
  otg_links l;
  l.records = (__global const otg_contact_record*)(records + OTG_RESULT_HEAD);
  l.links = links;
  l.pairTable = tables;
  l.binTable = tables + tableSize;
  l.binScore = tables + 2 * (size_t)tableSize;
  l.binBest = tables + 3 * (size_t)tableSize;
  l.capacity = capacity;
  l.bins = 0;
  l.mask = otgTableMask(min(counters[OTG_COUNT_HITS], capacity));
  return l;
}

/// Empties what a query used of two tables. Lane `begin` of `step`.
inline static void otgEmptyTables(__global uint* first, __global uint* second, uint mask, size_t begin, size_t step) {
  const uint4 nothing = (uint4)(0, 0, 0, 0);
  for (size_t i = begin; i < (mask + 1) / 4; i += step) {
    ((__global uint4*)first)[i] = nothing;
    ((__global uint4*)second)[i] = nothing;
  }
}

/// The first two words of a record, in one read.
inline static uint2 otgTrianglesOf(__global const otg_contact_record* r) {
  return *(__global const uint2*)r;
}

inline static int otgLess(uint2 x, uint2 y) {
  return x.x < y.x || (x.x == y.x && x.y < y.y);
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

/// The root of the region, shortening the way for others.
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

/// Roots are hung below roots of smaller keys, which are as good as random: neighbours have numbers one after the other
/// along a contour, and would make ways to roots as long as it.
inline static uint otgRootKey(uint hit) {
  return hit * 0x9e3779b1u;
}

/// Goes up from both at once, always the one whose parent has the greater key. That one is hung below the other's
/// parent on the way (the union-find of Rem). A parent's key is never greater than its child's.
inline static void otgUnite(const otg_links* l, uint x, uint y) {
  volatile __global uint* parent = l->links;  // OTG_LINK_PARENT
  for (;;) {
    const uint upX = parent[x], upY = parent[y];
    if (upX == upY) return;
    const int xGoes = otgRootKey(upX) > otgRootKey(upY);
    const uint from = xGoes ? x : y, up = xGoes ? upX : upY, to = xGoes ? upY : upX;
    const uint seen = atomic_cmpxchg(parent + from, up, to);
    if (up == from && seen == up) return;
    x = up == from ? seen : up;  // what was a root has this parent now, whatever a later read would see
    y = to;
  }
}

/// Unites a hit with the one of these triangles of the same pair of meshes, if there is one. They are greater than the
/// hit's own.
inline static void otgUniteWithHit(const otg_links* l, uint hit, uint pair, uint2 triangles) {
  const uint hash = otgHashPair(pair, triangles.x, triangles.y);
  for (uint slot = hash & l->mask;; slot = (slot + 1) & l->mask) {
    const uint entry = l->pairTable[slot];
    if (entry == 0) return;
    if (((entry ^ hash) & ~l->mask) != 0) continue;
    const uint other = (entry & l->mask) - 1;
    const uint2 found = otgTrianglesOf(l->records + other);
    if (found.x != triangles.x || found.y != triangles.y || l->records[other].pair != pair) continue;
    *otgLink(l, OTG_LINK_LATER, other) = 1;
    otgUnite(l, hit, other);
    return;
  }
}

/// The smallest pair of triangles of each region, by whose order regions are numbered: among the hits that have no
/// smaller neighbour, of which there are few. When all have been tried, the root has it (plus one).
inline static void otgBidForFirst(const otg_links* l, uint hit, uint root) {
  if (*otgLink(l, OTG_LINK_LATER, hit)) return;
  __global uint* first = otgLink(l, OTG_LINK_FIRST, root);
  for (uint entry = 0;;) {
    const uint before = atomic_cmpxchg(first, entry, hit + 1);
    if (before == entry || otgLess(otgTrianglesOf(l->records + before - 1), otgTrianglesOf(l->records + hit))) return;
    entry = before;
  }
}

/// When all have bid.
inline static ulong otgRegionOf(const otg_links* l, uint root) {
  const uint2 triangles = otgTrianglesOf(l->records + *otgLink(l, OTG_LINK_FIRST, root) - 1);
  return (ulong)triangles.x << 32 | triangles.y;
}

/// What the ring of edges says of edge `edge` - 1 of a triangle: the next half-edge of the same edge, and OTG_RING_TWIN
/// if that is the only other one. Edge 0 stands for the triangle itself.
inline static uint otgRingOf(__global const uint* rings, uint triangle, uint edge) {
  return edge == 0 ? 3 * triangle | OTG_RING_TWIN : rings[4 * triangle + edge - 1];
}

/// Where the ring ends: the half-edge that it began at. Edge 0 is left by the flag.
inline static uint otgRingEnd(uint triangle, uint edge) {
  return edge == 0 ? OTG_RING_HALF_EDGE : 3 * triangle + edge - 1;
}

/// Does `what` with each `other`: one of the sixteen shares of the neighbours of a hit of triangles `own` that have
/// greater numbers. Triangles that A's triangle itself (`edgeA` 0) or one of its edges (1 to 3) leads to. With them
/// those that B's leads to likewise. A macro, because tables are in global memory for some and in local memory for
/// others.
#define OTG_FOR_NEIGHBOURS(ringsA, ringsB, own, edgeA, edgeB, what)                                \
  do {                                                                                             \
    const uint endA = otgRingEnd(own.x, edgeA), endB = otgRingEnd(own.y, edgeB);                   \
    const uint firstA = otgRingOf(ringsA, own.x, edgeA), firstB = otgRingOf(ringsB, own.y, edgeB); \
    for (uint ringA = firstA;; ringA = ringsA[4 * (ringA / 3) + ringA % 3]) {                      \
      const uint twinA = ringA & OTG_RING_TWIN;                                                    \
      ringA &= OTG_RING_HALF_EDGE;                                                                 \
      if (ringA == endA) break;                                                                    \
      for (uint ringB = firstB;; ringB = ringsB[4 * (ringB / 3) + ringB % 3]) {                    \
        const uint twinB = ringB & OTG_RING_TWIN;                                                  \
        ringB &= OTG_RING_HALF_EDGE;                                                               \
        if (ringB == endB) break;                                                                  \
        const uint2 other = (uint2)(ringA / 3, ringB / 3);                                         \
        if (otgLess(own, other)) what;                                                             \
        if (twinB) break;                                                                          \
      }                                                                                            \
      if (twinA) break;                                                                            \
    }                                                                                              \
  } while (0)

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

/// Bin and score of a hit's contact.
inline static ulong otgBinOfHit(const otg_links* l, __global const otg_pair_state* state, const otg_reduction* how,
                                uint hit, double* score) {
  float low[3], high[3];
  for (int k = 0; k < 3; ++k) {
    low[k] = otgUnordered(state->low[k]);
    high[k] = otgUnordered(state->high[k]);
  }
  return otgBinOf_d(otgPositionOf(l->records + hit), otgNormalOf(l->records + hit), low, high, how->bins, score);
}

/// Slots of a pair's bins: as many as there are bins if a table has as many, else 0.
inline static uint otgBinsOf(const otg_reduction* how, uint tableSize) {
  ulong bins = 1;
  for (int k = 0; k < 6; ++k) bins *= (ulong)clamp(how->bins[k], 1, OTG_MAX_BINS);
  return bins <= tableSize ? (uint)bins : 0;
}

/// Finds the slot of the hit's bin, which is that of whoever came first or of the bin's number, and raises the bin's
/// score.
inline static void otgEnterBin(const otg_links* l, __global const otg_pair_state* state, const otg_reduction* how,
                               uint hit, uint pair) {
  double score;
  const ulong bin = otgBinOfHit(l, state, how, hit, &score);
  const uint hash = otgHashPair(pair, (uint)(bin >> 32), (uint)bin), mine = (hash & ~l->mask) | (hit + 1);
  const uint upper = (uint)(as_ulong(score) >> 32) + 1;  // scores are not negative: in the order of their bits
  if (l->bins) {
    uint slot = 0;
    for (int k = 0; k < 6; ++k) {
      slot = slot * (uint)clamp(how->bins[k], 1, OTG_MAX_BINS) + ((uint)(bin >> (6 * (5 - k))) & (OTG_MAX_BINS - 1));
    }
    if (upper > *(volatile __global uint*)(l->binScore + slot)) atomic_max(l->binScore + slot, upper);
    *otgLink(l, OTG_LINK_BIN_SLOT, hit) = slot;
    *otgLink(l, OTG_LINK_SCORE, hit) = upper;
    return;
  }
  for (uint slot = hash & l->mask;; slot = (slot + 1) & l->mask) {
    uint entry = l->binTable[slot];  // unordered
    if (entry == 0) entry = atomic_cmpxchg(l->binTable + slot, 0, mine);
    if (entry != 0) {
      const uint other = (entry & l->mask) - 1;
      double ignored;
      if (((entry ^ hash) & ~l->mask) != 0 || l->records[other].pair != pair ||
          otgBinOfHit(l, state, how, other, &ignored) != bin) {
        continue;  // another bin's
      }
    }
    if (upper > *(volatile __global uint*)(l->binScore + slot)) atomic_max(l->binScore + slot, upper);
    *otgLink(l, OTG_LINK_BIN_SLOT, hit) = slot;
    *otgLink(l, OTG_LINK_SCORE, hit) = upper;
    return;
  }
}

/// Whether the hit may be the best of its bin, as which it is entered then. When all have been tried, the bin has the
/// one that is.
inline static int otgMayBeBest(const otg_links* l, __global const otg_pair_state* state, const otg_reduction* how,
                               uint hit) {
  const uint slot = *otgLink(l, OTG_LINK_BIN_SLOT, hit);
  if (l->binScore[slot] != *otgLink(l, OTG_LINK_SCORE, hit)) return 0;
  for (uint entry = 0;;) {
    const uint before = atomic_cmpxchg(l->binBest + slot, entry, hit + 1);
    if (before == entry) return 1;
    double score, otherScore;
    otgBinOfHit(l, state, how, hit, &score);
    otgBinOfHit(l, state, how, before - 1, &otherScore);
    if (otherScore > score ||
        (otherScore == score && otgLess(otgTrianglesOf(l->records + before - 1), otgTrianglesOf(l->records + hit)))) {
      return 0;
    }
    entry = before;
  }
}

/// Bounds and counts of one work-group's contacts, added to the pair's at the end: all hits are of one pair.
typedef struct {
  uint low[3], high[3], intersecting, contacts;
} otg_tally;

/// By all lanes of a work-group of at least three, before the first otgEnterHit.
inline static void otgBeginTally(__local otg_tally* tally) {
  const uint lane = get_local_id(0);
  if (lane < 3) {
    tally->low[lane] = 0xffffffffu;
    tally->high[lane] = 0;
  }
  if (lane == 0) {
    tally->intersecting = 0;
    tally->contacts = 0;
  }
  barrier(CLK_LOCAL_MEM_FENCE);
}

/// By all lanes, after the last one.
inline static void otgEndTally(__global otg_pair_state* state, __local otg_tally* tally) {
  const uint lane = get_local_id(0);
  barrier(CLK_LOCAL_MEM_FENCE);
  if (lane == 0 && tally->intersecting) {
    atomic_add(&state->intersecting, tally->intersecting);
    atomic_add(&state->contacts, tally->contacts);
  }
  if (lane < 3 && tally->contacts) {
    atomic_min(state->low + lane, tally->low[lane]);
    atomic_max(state->high + lane, tally->high[lane]);
  }
}

/// After a hit's record was written: a root of its own, findable by its triangles, and counted. With OTG_SINGLE in
/// `tally`, which the kernel adds to the state. A pair with a hit that is open gets the flag `openFlag`; once it is
/// decided, such a hit may be entered again.
inline static void otgEnterHit(const otg_links* l, __global otg_pair_state* states, __global uint* flags, uint hit,
                               uint openFlag, __local otg_tally* tally) {
  __global const otg_contact_record* r = l->records + hit;
  __global otg_pair_state* state = states + r->pair;
  *otgLink(l, OTG_LINK_PARENT, hit) = hit;
  *otgLink(l, OTG_LINK_MARK, hit) = 0;
  *otgLink(l, OTG_LINK_LATER, hit) = 0;
  *otgLink(l, OTG_LINK_FIRST, hit) = 0;
  if (r->kind == OTG_RECORD_OPEN && openFlag != 0) atomic_or(flags + r->pair, openFlag);
  if (!otgIntersects(r->kind)) return;
  const uint hash = otgHashPair(r->pair, r->a, r->b);
  uint slot = hash & l->mask;
  while (atomic_cmpxchg(l->pairTable + slot, 0, (hash & ~l->mask) | (hit + 1)) != 0) slot = (slot + 1) & l->mask;
#if OTG_SINGLE
  atomic_inc(&tally->intersecting);
#else
  atomic_inc(&state->intersecting);
#endif
  if (!otgIsContact(r->kind)) return;
  for (int k = 0; k < 3; ++k) {
    const uint x = otgOrdered((float)r->position[k]);
#if OTG_SINGLE
    volatile __local uint *low = tally->low + k, *high = tally->high + k;
#else
    volatile __global uint *low = state->low + k, *high = state->high + k;
#endif
    // Most do not widen the bounds, and reading is cheaper.
    if (x < *low) atomic_min(low, x);
    if (x > *high) atomic_max(high, x);
  }
#if OTG_SINGLE
  atomic_inc(&tally->contacts);
#else
  atomic_inc(&state->contacts);
#endif
}
#endif

#endif  // OTG_CONTACT_LINKS_H
