// SPDX-License-Identifier: BSD-3-Clause
// Which vertices are inside the other mesh, and the regions that crossings and vertices belong to, by one work-group;
// as collide/solid/inside.cpp and regions.cpp. Whatever is not plain is left to the CPU.
#ifndef OTG_SOLID_INSIDE_H
#define OTG_SOLID_INSIDE_H
#include "solid/small/scratch.h"

OTG_INLINED void otgVote(__local otg_solid_scratch* s, uint mesh, uint v, int inside) {
  int isNew;
  const uint slot = otgEnterVertex(s, mesh, v, &isNew);
  if (slot != OTG_NOT_THERE) atomic_add(s->vote + slot, inside ? 1025 : 1023);
}

OTG_INLINED void otgQueue(__local otg_solid_scratch* s, uint slot) {
  const uint place = atomic_inc(&s->queued);
  if (place < 2 * OTG_SOLID_HITS) {
    s->queue[place] = (ushort)slot;
  } else {
    otgGiveUp(s, OTG_SOLID_TOO_MANY | OTG_SOLID_BY_CELLS);
  }
}

/// Goes from one vertex inside to its neighbours over edges that are not crossed.
OTG_INLINED void otgFloodFrom(__local otg_solid_scratch* s, uint slot, OTG_MESH* meshA, OTG_MESH* meshB) {
  const uint mesh = (s->vertexKey[slot] - 1) & 1, v = (s->vertexKey[slot] - 1) >> 1;
  OTG_MESH* mine = mesh == 0 ? meshA : meshB;
  const otg_vec3_d x = otgVertexAt(mine, v);
  const int inBounds = otgInBounds(mesh == 0 ? meshB : meshA, x);
  const int isVoted = s->vote[slot] != 0;  // no other vertex has an edge that is crossed
  if (!inBounds) otgGiveUp(s, OTG_SOLID_BROKEN);
  for (uint k = mine->firstSpoke[v]; k < mine->firstSpoke[v + 1]; ++k) {
    const uint2 next = mine->neighbours[k];
    const uint w = next.x;
    if (isVoted && otgFirstAlong(s, next.y << 1 | mesh) != OTG_NO_CROSSING) continue;
    int isNew;
    const uint there = otgEnterVertex(s, mesh, w, &isNew);
    if (there == OTG_NOT_THERE) return;
    if (isNew) {
      s->side[there] = OTG_SIDE_INSIDE;
      otgQueue(s, there);
    } else if (s->side[there] == OTG_SIDE_OUTSIDE) {  // unordered: no lane makes it that here
      otgGiveUp(s, OTG_SOLID_BROKEN);
    }
    otgJoin(s, OTG_SOLID_HITS + slot, OTG_SOLID_HITS + there);
  }
}

OTG_INLINED void otgFloodInside(__local otg_solid_scratch* s, OTG_MESH* meshA, OTG_MESH* meshB) {
  const uint lane = get_local_id(0), crossings = s->crossings;
  for (uint c = lane; c < crossings; c += OTG_GROUP) {
    const uint mesh = s->edge[c] & 1;
    const uint4 ends = mesh == 0 ? meshA->edges[s->edge[c] >> 1] : meshB->edges[s->edge[c] >> 1];
    if (s->rank[c] == 0) otgVote(s, mesh, ends.x, s->exits[c]);
    if (s->next[c] == OTG_NO_CROSSING) otgVote(s, mesh, ends.y, !s->exits[c]);
  }
  OTG_SYNC;
  for (uint slot = lane; slot < OTG_SOLID_SLOTS; slot += OTG_GROUP) {
    const int vote = s->vote[slot], votes = (vote + 512) >> 10, balance = vote - 1024 * votes;
    if (vote == 0) continue;
    if (balance != votes && balance != -votes) otgGiveUp(s, OTG_SOLID_BROKEN);
    s->side[slot] = balance > 0 ? OTG_SIDE_INSIDE : OTG_SIDE_OUTSIDE;
    if (balance > 0) otgQueue(s, slot);
  }
  OTG_SYNC;
  uint from = 0, to = s->bad ? 0 : s->queued;
  OTG_SYNC;
  for (int more = to > from; more;) {
    for (uint i = from + lane; i < to; i += OTG_GROUP) otgFloodFrom(s, s->queue[i], meshA, meshB);
    OTG_SYNC;
    from = to;
    to = s->bad ? from : s->queued;
    more = to > from;
    OTG_SYNC;
  }
}

/// The element of a vertex, or OTG_NOT_THERE if it is outside. Elements are crossings, and behind them vertices.
OTG_INLINED uint otgElementOf(__local const otg_solid_scratch* s, uint mesh, uint v) {
  const uint slot = otgFindInside(s, mesh, v);
  return slot == OTG_NOT_THERE ? OTG_NOT_THERE : OTG_SOLID_HITS + slot;
}

/// The ends of the stretch of an edge that a crossing ends (where it exits) or that begins at the last crossing. 0 if
/// there is none.
OTG_INLINED int otgStretchAt(__local const otg_solid_scratch* s, uint c, OTG_MESH* mine, uint* from, uint* to) {
  const uint mesh = s->edge[c] & 1;
  if (s->exits[c]) {
    *to = c;
    *from = s->previous[c];
    if (*from == OTG_NO_CROSSING) *from = otgElementOf(s, mesh, mine->edges[s->edge[c] >> 1].x);
    return 1;
  }
  if (s->next[c] != OTG_NO_CROSSING) return 0;
  *from = c;
  *to = otgElementOf(s, mesh, mine->edges[s->edge[c] >> 1].y);
  return 1;
}

/// Whether the contour comes back to a chord without leaving its triangle of a mesh.
OTG_INLINED int otgStaysWithin(__local const otg_solid_scratch* s, uint mesh, uint chord) {
  const uint chords = s->chords;
  uint at = chord;
  for (uint steps = 0; steps < chords; ++steps) {
    const uint c = s->end[at];
    if ((s->edge[c] & 1) == mesh) return 0;
    for (at = 0; at < chords && s->start[at] != c;) ++at;
    if (at == chord || at == chords) break;
  }
  return at == chord;
}

/// A contour that stays within one triangle whose corners are all inside hangs together with them.
OTG_INLINED void otgUniteWithCorners(__local otg_solid_scratch* s, uint mesh, OTG_MESH* m, uint chord) {
  const size_t at = 4 * (size_t)s->triangle[mesh][chord];
  const uint4 corners = m->triangles[at], edges = m->triangles[at + 1];
  const uint x = otgFindInside(s, mesh, corners.x);
  if (x == OTG_NOT_THERE || otgFindInside(s, mesh, corners.y) == OTG_NOT_THERE ||
      otgFindInside(s, mesh, corners.z) == OTG_NOT_THERE) {
    return;
  }
  int isCrossed = 0;
  for (uint k = 0; k < 3; ++k) isCrossed |= otgFirstAlong(s, otgOf3(edges, k) << 1 | mesh) != OTG_NO_CROSSING;
  if (!isCrossed || otgStaysWithin(s, mesh, chord)) otgJoin(s, s->start[chord], OTG_SOLID_HITS + x);
}

/// Regions of crossings and vertices, numbered by their smallest crossing; vertices inside in order.
OTG_INLINED void otgUniteRegions(__local otg_solid_scratch* s, OTG_MESH* meshA, OTG_MESH* meshB) {
  const uint lane = get_local_id(0), crossings = s->bad ? 0 : s->crossings, chords = s->bad ? 0 : s->chords;
  const uint vertices = s->bad ? 0 : s->queued;
  uint regions = 0, total;
  for (uint c = lane; c < crossings; c += OTG_GROUP) {
    uint from, to;
    if (!otgStretchAt(s, c, s->edge[c] & 1 ? meshB : meshA, &from, &to)) continue;
    if (from == OTG_NOT_THERE || to == OTG_NOT_THERE) {
      otgGiveUp(s, OTG_SOLID_BROKEN);
    } else {
      otgJoin(s, from, to);
    }
  }
  for (uint c = lane; c < chords; c += OTG_GROUP) {
    otgJoin(s, s->start[c], s->end[c]);
    otgUniteWithCorners(s, 0, meshA, c);
    otgUniteWithCorners(s, 1, meshB, c);
  }
  OTG_SYNC;
  for (uint base = 0; base < crossings; base += OTG_GROUP) {
    const uint c = base + lane;
    const int isRoot = c < crossings && otgRootOf(s, c) == c;
    const uint number = regions + otgPlaceAmong(OTG_COUNTS(s), isRoot, &total);
    if (isRoot) s->region[c] = (ushort)number;
    regions += total;
  }
  if (lane == 0) {
    if (regions > OTG_SOLID_REGIONS) otgGiveUp(s, OTG_SOLID_TOO_MANY);
    s->regions = regions;
  }
  OTG_SYNC;
  for (uint c = lane; c < crossings; c += OTG_GROUP) {
    const uint root = otgRootOf(s, c);
    if (root != c) s->region[c] = s->region[root];
    // Along edges, edges by mesh and first crossing.
    const uint edge = s->edge[c], first = s->first[c], rank = s->rank[c];
    uint place = 0;
    for (uint d = 0; d < crossings; ++d) {
      const uint meshes = (s->edge[d] & 1) < (edge & 1), same = (s->edge[d] & 1) == (edge & 1);
      place += meshes || (same && (s->first[d] < first || (s->first[d] == first && s->rank[d] < rank)));
    }
    s->order[place] = (ushort)c;
  }
  for (uint i = lane; i < vertices; i += OTG_GROUP) {
    const uint key = s->vertexKey[s->queue[i]] - 1;
    uint place = 0;
    for (uint j = 0; j < vertices; ++j) {
      const uint other = s->vertexKey[s->queue[j]] - 1;
      place += (other & 1) < (key & 1) || ((other & 1) == (key & 1) && other < key);
    }
    s->inside[place] = s->queue[i];
    const uint root = otgRootOf(s, OTG_SOLID_HITS + s->queue[i]);
    if (root >= OTG_SOLID_HITS) {
      otgGiveUp(s, OTG_SOLID_BROKEN);
    } else {
      s->vote[s->queue[i]] = s->region[root];
    }
  }
  OTG_SYNC;
}

#endif  // OTG_SOLID_INSIDE_H
