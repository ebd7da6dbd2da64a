// SPDX-License-Identifier: BSD-3-Clause
// What one work-group knows of a pair of solids while it finds their regions, in local memory; tables and sets in it.
//
// OTG_SOLID_HITS (N below): the most intersecting pairs of triangles, a power of two.
#ifndef OTG_SOLID_SCRATCH_H
#define OTG_SOLID_SCRATCH_H
#include "solid/mesh.h"

#define OTG_SOLID_SLOTS (4 * OTG_SOLID_HITS)  ///< of the table of vertices; at most halfEdge are taken
#define OTG_CHORD_WORDS 64
#define OTG_NO_CROSSING 0xffffu
#define OTG_MOST_ALONG 32  ///< crossings of one edge of which some lie close to each other

/// Sides of vertices.
enum { OTG_SIDE_UNKNOWN = 0, OTG_SIDE_INSIDE = 1, OTG_SIDE_OUTSIDE = 2 };

typedef struct {
  uint a[OTG_SOLID_HITS], b[OTG_SOLID_HITS];  ///< pairs of triangles, ascending
  // By slot 2 hit + k, k = 0, 1: how the hit's chord ends.
  uint halfEdge[2 * OTG_SOLID_HITS];  ///< halfEdge-edge << 1 | mesh, or OTG_NOT_THERE
  uchar how[2 * OTG_SOLID_HITS];  ///< 1: the halfEdge-edge leaves the other mesh; 2: the chord starts here; 4: owns it
  ushort place[OTG_SOLID_HITS];   ///< by hit: crossings of hits before it
  // By crossing.
  uint edge[OTG_SOLID_HITS];                                                          ///< edge << 1 | mesh
  uint other[OTG_SOLID_HITS];                                                         ///< the triangle
  double t[OTG_SOLID_HITS], x[OTG_SOLID_HITS], y[OTG_SOLID_HITS], z[OTG_SOLID_HITS];  ///< the point: absolute
  uchar exits[OTG_SOLID_HITS];
  ushort rank[OTG_SOLID_HITS], next[OTG_SOLID_HITS], previous[OTG_SOLID_HITS];  ///< along the edge
  ushort first[OTG_SOLID_HITS];                                                 ///< the smallest of the edge
  ushort region[OTG_SOLID_HITS];
  // By chord.
  ushort start[OTG_SOLID_HITS], end[OTG_SOLID_HITS], hit[OTG_SOLID_HITS];
  uint triangle[2][OTG_SOLID_HITS];  ///< of A and of B
  uint chordBits[OTG_CHORD_WORDS];   ///< a hashed set of these triangles
  uchar firsts[OTG_SOLID_HITS];      ///< 1: the first of A's triangle, 2: of B's
  // Tables.
  uint vertexKey[OTG_SOLID_SLOTS];  ///< (vertex << 1 | mesh) + 1, 0: free
  int vote[OTG_SOLID_SLOTS];        ///< 1,024 for each vote, and 1 more for inside, 1 less for outside; then the region
  uchar side[OTG_SOLID_SLOTS];      ///< OTG_SIDE_*
  uint edgeKey[2 * OTG_SOLID_HITS];                 ///< (edge << 1 | mesh) + 1, 0: free
  ushort edgeFirst[2 * OTG_SOLID_HITS];             ///< the first crossing along it
  uint parent[OTG_SOLID_HITS + OTG_SOLID_SLOTS];    ///< sets of crossings, and vertices behind them
  ushort queue[2 * OTG_SOLID_HITS];                 ///< slots of vertices inside, as they were reached
  ushort inside[2 * OTG_SOLID_HITS];                ///< the same by mesh and vertex
  ushort order[OTG_SOLID_HITS];                     ///< crossings by mesh, first of their edge, place along it
  uint4 counts[(OTG_GROUP + 3) / 4];                ///< a word for each lane: OTG_COUNTS
  uint crossedParts[2][OTG_SOLID_MOST_PARTS / 32];  ///< of A and B: closed components with a chord, a bit each
  double reduce[6 * OTG_GROUP];
  double sums[9], bound[6];
  uint bad, entered, queued, allocated, crossings, chords, regions, items, tied;
} otg_solid_scratch;

OTG_INLINED void otgGiveUp(__local otg_solid_scratch* s, uint why) {
  atomic_or(&s->bad, why);
}

/// Notes that the closed component of a triangle, if it is in one, has a chord.
OTG_INLINED void otgMarkPart(__local otg_solid_scratch* s, uint mesh, OTG_MESH* m, uint triangle) {
  if (m->flags & OTG_MESH_SOLID) return;  // it is the only one: see otgIsCrossed
  const uint part = m->triangles[4 * (size_t)triangle].w;
  if (part != OTG_NOT_THERE) atomic_or(s->crossedParts[mesh] + part / 32, 1u << part % 32);
}
OTG_INLINED int otgIsCrossed(__local const otg_solid_scratch* s, OTG_MESH* m, uint part) {
  if (m->flags & OTG_MESH_SOLID) return s->chords > 0;
  return s->crossedParts[m->isB ? 1 : 0][part / 32] >> part % 32 & 1;
}

OTG_INLINED uint otgHashWord(uint x) {
  x *= 0x9e3779b1u;
  return x ^ x >> 15;
}

/// Whether a triangle may have a chord; where not, it has none.
OTG_INLINED uint otgChordBit(uint mesh, uint triangle) {
  return otgHashWord(triangle << 1 | mesh) >> 8 & (32 * OTG_CHORD_WORDS - 1);
}
OTG_INLINED int otgMayHaveChord(__local const otg_solid_scratch* s, uint mesh, uint triangle) {
  const uint bit = otgChordBit(mesh, triangle);
  return s->chordBits[bit / 32] >> bit % 32 & 1;
}

/// The slot of a vertex, entered if it was not there (`isNew`); OTG_NOT_THERE when the table is full.
OTG_INLINED uint otgEnterVertex(__local otg_solid_scratch* s, uint mesh, uint v, int* isNew) {
  const uint key = (v << 1 | mesh) + 1;
  *isNew = 0;
  for (uint slot = otgHashWord(key) & (OTG_SOLID_SLOTS - 1);; slot = (slot + 1) & (OTG_SOLID_SLOTS - 1)) {
    const uint seen = s->vertexKey[slot];  // unordered
    if (seen == key) return slot;
    if (seen != 0) continue;
    if (s->entered >= 2 * OTG_SOLID_HITS) {  // unordered
      otgGiveUp(s, OTG_SOLID_TOO_MANY | OTG_SOLID_BY_CELLS);
      return OTG_NOT_THERE;
    }
    const uint before = atomic_cmpxchg(s->vertexKey + slot, 0, key);
    if (before == 0) {
      atomic_inc(&s->entered);
      *isNew = 1;
      return slot;
    }
    if (before == key) return slot;
  }
}

OTG_INLINED uint otgFindVertex(__local const otg_solid_scratch* s, uint mesh, uint v) {
  const uint key = (v << 1 | mesh) + 1;
  for (uint slot = otgHashWord(key) & (OTG_SOLID_SLOTS - 1);; slot = (slot + 1) & (OTG_SOLID_SLOTS - 1)) {
    if (s->vertexKey[slot] == key) return slot;
    if (s->vertexKey[slot] == 0) return OTG_NOT_THERE;
  }
}

/// Only after the sides are known.
OTG_INLINED uint otgFindInside(__local const otg_solid_scratch* s, uint mesh, uint v) {
  const uint slot = otgFindVertex(s, mesh, v);
  return slot != OTG_NOT_THERE && s->side[slot] == OTG_SIDE_INSIDE ? slot : OTG_NOT_THERE;
}

OTG_INLINED void otgEnterEdge(__local otg_solid_scratch* s, uint edge, uint crossing) {
  for (uint slot = otgHashWord(edge + 1) & (2 * OTG_SOLID_HITS - 1);; slot = (slot + 1) & (2 * OTG_SOLID_HITS - 1)) {
    if (atomic_cmpxchg(s->edgeKey + slot, 0, edge + 1) != 0) continue;
    s->edgeFirst[slot] = (ushort)crossing;
    return;
  }
}

/// The first crossing along `edge << 1 | mesh`, or OTG_NO_CROSSING.
OTG_INLINED uint otgFirstAlong(__local const otg_solid_scratch* s, uint edge) {
  for (uint slot = otgHashWord(edge + 1) & (2 * OTG_SOLID_HITS - 1);; slot = (slot + 1) & (2 * OTG_SOLID_HITS - 1)) {
    if (s->edgeKey[slot] == edge + 1) return s->edgeFirst[slot];
    if (s->edgeKey[slot] == 0) return OTG_NO_CROSSING;
  }
}

OTG_INLINED uint otgRootOf(__local otg_solid_scratch* s, uint e) {
  volatile __local uint* parent = s->parent;
  uint up = parent[e];
  while (up != e) {
    const uint next = parent[up];
    if (next != up) parent[e] = next;
    e = up;
    up = next;
  }
  return e;
}

/// The smallest element names the set.
OTG_INLINED void otgJoin(__local otg_solid_scratch* s, uint x, uint y) {
  for (;;) {
    x = otgRootOf(s, x);
    y = otgRootOf(s, y);
    if (x == y) return;
    const uint low = min(x, y), high = max(x, y);
    if (atomic_cmpxchg(s->parent + high, high, low) == high) return;
  }
}

#endif  // OTG_SOLID_SCRATCH_H
