// SPDX-License-Identifier: BSD-3-Clause
// Crossings and chords of one pair of solids, by one work-group; as collide/solid/contour.cpp, in the same order.
#ifndef OTG_SOLID_CONTOUR_H
#define OTG_SOLID_CONTOUR_H
#include "solid_scratch.h"
//
#include "shared/triangle_exact.h"

OTG_INLINED void otgCornersAt(const otg_solid_mesh* m, uint triangle, otg_vec3_d* out) {
  const uint4 v = m->triangles[4 * (size_t)triangle];
  out[0] = otgVertexAt(m, v.x);
  out[1] = otgVertexAt(m, v.y);
  out[2] = otgVertexAt(m, v.z);
}

OTG_INLINED int otgSide(const otg_vec3_d* t, const otg_vec3_d* p) {
  return otgOrient3Filter(&t[0].x, &t[1].x, &t[2].x, &p->x);
}

/// Does the line of edge k of one triangle pass through the other? Corners lie one after the other: of A, then of B.
/// 1, 0, or -1 if double arithmetic cannot tell.
OTG_INLINED int otgPasses(const otg_vec3_d* corners, uint mesh, uint k) {
  const otg_vec3_d from = corners[3 * mesh + k], to = corners[3 * mesh + (k + 1) % 3];
  int below = 0, above = 0;
  OTG_ROLLED
  for (uint l = 0; l < 3; ++l) {
    const otg_vec3_d p = corners[3 - 3 * mesh + l], q = corners[3 - 3 * mesh + (l + 1) % 3];
    const int sign = otgOrient3Filter(&from.x, &to.x, &p.x, &q.x);
    below += sign < 0;
    above += sign > 0;
  }
  if (below > 0 && above > 0) return 0;
  return below == 3 || above == 3 ? 1 : -1;
}

/// The ends of a hit's chord in its two slots. Ends are found in the order in which the host finds them.
OTG_INLINED void otgFindEnds(__local otg_solid_scratch* s, uint hit, const otg_solid_mesh* meshA,
                             const otg_solid_mesh* meshB) {
  otg_vec3_d corners[6];
  int side[6];
  uint found = 0, starts = 0;
  const uint ta = s->a[hit], tb = s->b[hit];
  s->halfEdge[2 * hit] = OTG_NOT_THERE;
  s->halfEdge[2 * hit + 1] = OTG_NOT_THERE;
  otgCornersAt(meshA, ta, corners);
  otgCornersAt(meshB, tb, corners + 3);
  OTG_ROLLED
  for (uint mesh = 0; mesh < 2; ++mesh) {
    OTG_ROLLED
    for (uint k = 0; k < 3; ++k) side[3 * mesh + k] = otgSide(corners + 3 - 3 * mesh, corners + 3 * mesh + k);
    const int x = side[3 * mesh], y = side[3 * mesh + 1], z = side[3 * mesh + 2];
    if (x * y * z == 0) {
      otgGiveUp(s, OTG_SOLID_INEXACT);
      return;
    }
    if (x == y && y == z) return;
  }
  OTG_ROLLED
  for (uint item = 0; item < 6; ++item) {
    const uint k = item / 2, mesh = item % 2;
    const int from = side[3 * mesh + k], to = side[3 * mesh + (k + 1) % 3];
    if (from == to) continue;
    const int passes = otgPasses(corners, mesh, k);
    if (passes < 0) otgGiveUp(s, OTG_SOLID_INEXACT);
    if (passes <= 0) continue;
    const int exits = to > 0, isStart = mesh == 0 ? exits : !exits;
    if (found < 2) {
      s->halfEdge[2 * hit + found] = (3 * (mesh == 0 ? ta : tb) + k) << 1 | mesh;
      s->how[2 * hit + found] = (uchar)(exits | isStart << 1);
    }
    ++found;
    starts += isStart;
  }
  if (found != 0 && (found != 2 || starts != 1)) otgGiveUp(s, OTG_SOLID_BROKEN);
}

/// The hit of these triangles, or OTG_NOT_THERE.
OTG_INLINED uint otgHitOf(__local const otg_solid_scratch* s, uint hits, uint a, uint b) {
  uint low = 0, high = hits;
  while (low < high) {
    const uint middle = (low + high) / 2;
    if (s->a[middle] < a || (s->a[middle] == a && s->b[middle] < b)) {
      low = middle + 1;
    } else {
      high = middle;
    }
  }
  return low < hits && s->a[low] == a && s->b[low] == b ? low : OTG_NOT_THERE;
}

/// The other slot of the same crossing, in the hit of the triangle across the edge; or OTG_NOT_THERE.
OTG_INLINED uint otgOtherSlot(__local otg_solid_scratch* s, uint hits, uint slot, const otg_solid_mesh* meshA,
                              const otg_solid_mesh* meshB) {
  const uint hit = slot / 2, mesh = s->halfEdge[slot] & 1;
  const uint twin = mesh == 0 ? otgTwinOf(meshA, s->halfEdge[slot] >> 1) : otgTwinOf(meshB, s->halfEdge[slot] >> 1);
  const uint there = otgHitOf(s, hits, mesh == 0 ? twin / 3 : s->a[hit], mesh == 0 ? s->b[hit] : twin / 3);
  if (there == OTG_NOT_THERE) return OTG_NOT_THERE;
  for (uint k = 0; k < 2; ++k) {
    if (s->halfEdge[2 * there + k] == (twin << 1 | mesh)) return 2 * there + k;
  }
  return OTG_NOT_THERE;
}

/// The number of the crossing that a slot owns.
OTG_INLINED uint otgOwnedBy(__local const otg_solid_scratch* s, uint slot) {
  return s->place[slot / 2] + (slot % 2 && (s->how[slot - 1] & 4) ? 1 : 0);
}

OTG_INLINED void otgMakeCrossing(__local otg_solid_scratch* s, uint slot, const otg_solid_mesh* mine,
                                 const otg_solid_mesh* theirs) {
  const uint c = otgOwnedBy(s, slot), halfEdge = s->halfEdge[slot] >> 1, mesh = s->halfEdge[slot] & 1;
  const uint other = mesh == 0 ? s->b[slot / 2] : s->a[slot / 2], edge = otgEdgeOf(mine, halfEdge);
  const uint4 ends = mine->edges[edge];
  const int forward = otgCornerOf(mine, halfEdge) == ends.x;
  const otg_vec3_d p = otgVertexAt(mine, ends.x), q = otgVertexAt(mine, ends.y);
  otg_vec3_d corners[3], drift;
  otgCornersAt(theirs, other, corners);
  const double t = otgHitPlane_d((int)mesh, p, q, corners, &drift);
  const otg_vec3_d x = otgAdd_d(p, otgScale_d(otgSub_d(q, p), t));
  s->edge[c] = edge << 1 | mesh;
  s->other[c] = other;
  s->t[c] = t;
  s->x[c] = x.x;
  s->y[c] = x.y;
  s->z[c] = x.z;
  s->exits[c] = (uchar)((s->how[slot] & 1) == forward);
}

/// Where a crossing lies along its edge. Those that are too close for their order to be certain are left to the host.
OTG_INLINED void otgPlaceAlongEdge(__local otg_solid_scratch* s, uint crossings, uint c) {
  const uint edge = s->edge[c];
  const double t = s->t[c];
  uint rank = 0, first = c, next = OTG_NO_CROSSING, previous = OTG_NO_CROSSING;
  for (uint d = 0; d < crossings; ++d) {
    if (s->edge[d] != edge || d == c) continue;
    const double u = s->t[d];
    first = min(first, d);
    if (fabs(u - t) <= 1e-9) otgGiveUp(s, OTG_SOLID_TIE);
    if (u < t) {
      ++rank;
      if (previous == OTG_NO_CROSSING || s->t[previous] < u) previous = d;
    } else if (next == OTG_NO_CROSSING || u < s->t[next]) {
      next = d;
    }
  }
  s->rank[c] = (ushort)rank;
  s->first[c] = (ushort)first;
  s->next[c] = (ushort)next;
  s->previous[c] = (ushort)previous;
  if (previous != OTG_NO_CROSSING && s->exits[previous] == s->exits[c]) otgGiveUp(s, OTG_SOLID_BROKEN);
  if (rank == 0) otgEnterEdge(s, edge, c);
}

/// From the sorted hits: crossings, chords, and their order along edges. All lanes call it; where the pair is given up
/// (s->bad) numbers may be wrong, but lie in their arrays.
OTG_INLINED void otgTraceContour(__local otg_solid_scratch* s, uint hits, const otg_solid_mesh* meshA,
                                 const otg_solid_mesh* meshB) {
  const uint lane = get_local_id(0);
  uint running = 0, chords = 0, total;
  for (uint i = lane; i < hits; i += OTG_GROUP) otgFindEnds(s, i, meshA, meshB);
  OTG_SYNC;
  for (uint slot = lane; slot < 2 * hits; slot += OTG_GROUP) {
    if (s->halfEdge[slot] == OTG_NOT_THERE) continue;
    const uint other = otgOtherSlot(s, hits, slot, meshA, meshB);
    if (other == OTG_NOT_THERE) {
      otgGiveUp(s, OTG_SOLID_BROKEN);
    } else if (slot < other) {
      s->how[slot] |= 4;
    }
  }
  for (uint base = 0; base < hits; base += OTG_GROUP) {
    const uint i = base + lane;
    const int isChord = i < hits && s->halfEdge[2 * i + 1] != OTG_NOT_THERE;
    uint owned = 0;
    OTG_SYNC;
    if (isChord) owned = (s->how[2 * i] >> 2 & 1) + (s->how[2 * i + 1] >> 2 & 1);
    const uint place = running + otgPlaceAmong(s->counts, owned, &total);
    running += total;
    const uint chord = chords + otgPlaceAmong(s->counts, isChord, &total);
    chords += total;
    if (i < hits) s->place[i] = (ushort)place;
    if (isChord) s->hit[chord] = (ushort)i;
  }
  if (lane == 0 && running > OTG_SOLID_HITS) otgGiveUp(s, OTG_SOLID_BROKEN);
  OTG_SYNC;
  const uint crossings = s->bad ? 0 : running;
  if (s->bad) chords = 0;
  for (uint slot = lane; slot < 2 * hits; slot += OTG_GROUP) {
    if (crossings == 0 || s->halfEdge[slot] == OTG_NOT_THERE || !(s->how[slot] & 4)) continue;
    const int isB = s->halfEdge[slot] & 1;
    otgMakeCrossing(s, slot, isB ? meshB : meshA, isB ? meshA : meshB);
  }
  for (uint c = lane; c < chords; c += OTG_GROUP) {
    const uint i = s->hit[c];
    for (uint slot = 2 * i; slot < 2 * i + 2; ++slot) {
      const uint owner = s->how[slot] & 4 ? slot : otgOtherSlot(s, hits, slot, meshA, meshB);
      const ushort crossing = (ushort)otgOwnedBy(s, owner);
      if (s->how[slot] & 2) {
        s->start[c] = crossing;
      } else {
        s->end[c] = crossing;
      }
    }
    uint firsts = 3;
    for (uint d = 0; d < c && firsts != 0; ++d) {
      if (s->a[s->hit[d]] == s->a[i]) firsts &= ~1u;
      if (s->b[s->hit[d]] == s->b[i]) firsts &= ~2u;
    }
    s->firsts[c] = (uchar)firsts;
  }
  OTG_SYNC;
  for (uint c = lane; c < crossings; c += OTG_GROUP) otgPlaceAlongEdge(s, crossings, c);
  if (lane == 0) {
    s->crossings = crossings;
    s->chords = chords;
  }
  OTG_SYNC;
}

#endif  // OTG_SOLID_CONTOUR_H
