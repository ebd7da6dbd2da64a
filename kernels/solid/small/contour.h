// SPDX-License-Identifier: BSD-3-Clause
// Crossings and chords of one pair of solids, by one work-group; as collide/solid/contour.cpp, in the same order.
#ifndef OTG_SOLID_CONTOUR_H
#define OTG_SOLID_CONTOUR_H
#include "solid/small/scratch.h"

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
OTG_INLINED uint otgOtherSlot(__local otg_solid_scratch* s, uint hits, uint slot, OTG_MESH* meshA, OTG_MESH* meshB) {
  const uint hit = slot / 2, mesh = s->halfEdge[slot] & 1;
  const uint twin = mesh == 0 ? otgTwinOf(meshA, s->halfEdge[slot] >> 1) : otgTwinOf(meshB, s->halfEdge[slot] >> 1);
  if (twin == s->halfEdge[slot] >> 1) return OTG_NOT_THERE;  // the rim of a sheet
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

OTG_INLINED void otgMakeCrossing(__local otg_solid_scratch* s, uint slot, OTG_MESH* mine, OTG_MESH* theirs) {
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

/// Where a crossing lies along its edge. Where two lie close to each other, s->tied says that otgOrderTies has to look.
OTG_INLINED void otgPlaceAlongEdge(__local otg_solid_scratch* s, uint crossings, uint c) {
  const uint edge = s->edge[c], triangle = s->other[c];
  const double t = s->t[c];
  uint rank = 0, first = c, next = OTG_NO_CROSSING, previous = OTG_NO_CROSSING;
  for (uint d = 0; d < crossings; ++d) {
    if (s->edge[d] != edge || d == c) continue;
    const double u = s->t[d];
    first = min(first, d);
    if (fabs(u - t) <= OTG_SOLID_CLOSE_POINTS) atomic_or(&s->tied, 1);
    if (u < t || (u == t && s->other[d] < triangle)) {
      ++rank;
      if (previous == OTG_NO_CROSSING || s->t[previous] < u ||
          (s->t[previous] == u && s->other[previous] < s->other[d]))
        previous = d;
    } else if (next == OTG_NO_CROSSING || u < s->t[next] || (u == s->t[next] && s->other[d] < s->other[next])) {
      next = d;
    }
  }
  s->rank[c] = (ushort)rank;
  s->first[c] = (ushort)first;
  s->next[c] = (ushort)next;
  s->previous[c] = (ushort)previous;
}

/// The change of t of a crossing as A moves.
OTG_INLINED otg_vec3_d otgDriftOf(__local otg_solid_scratch* s, uint c, OTG_MESH* meshA, OTG_MESH* meshB) {
  const uint mesh = s->edge[c] & 1;
  OTG_MESH *mine = mesh == 0 ? meshA : meshB, *theirs = mesh == 0 ? meshB : meshA;
  const uint4 ends = mine->edges[s->edge[c] >> 1];
  otg_vec3_d corners[3], drift;
  otgCornersAt(theirs, s->other[c], corners);
  otgHitPlane_d((int)mesh, otgVertexAt(mine, ends.x), otgVertexAt(mine, ends.y), corners, &drift);
  return drift;
}

/// Orders the crossings of the edge of which c has the smallest number as the CPU does where some lie in one point:
/// Tracer::orderTies and Tracer::alternate.
OTG_INLINED void otgOrderTies(__local otg_solid_scratch* s, uint crossings, uint c, OTG_MESH* meshA, OTG_MESH* meshB) {
  ushort along[OTG_MOST_ALONG];
  const uint edge = s->edge[c];
  uint count = 0;
  if (s->first[c] != c) return;
  for (uint d = c; d < crossings; ++d) {
    if (s->edge[d] != edge) continue;
    if (s->rank[d] >= OTG_MOST_ALONG) {
      otgGiveUp(s, OTG_SOLID_TIE);
      return;
    }
    along[s->rank[d]] = (ushort)d;
    ++count;
  }
  OTG_ROLLED
  for (uint i = 1; i < count; ++i) {
    OTG_ROLLED
    for (uint j = i; j > 0; --j) {
      const ushort x = along[j], y = along[j - 1];
      if (s->t[x] - s->t[y] > OTG_SOLID_ONE_POINT ||
          !otgCrossesBefore_d(otgDriftOf(s, x, meshA, meshB), s->exits[x], otgDriftOf(s, y, meshA, meshB),
                              s->exits[y])) {
        break;
      }
      along[j] = y;
      along[j - 1] = x;
    }
  }
  uint leaving = 0;
  for (uint i = 0; i < count; ++i) leaving += s->exits[along[i]] != 0;
  uint expected = 2 * leaving == count ? s->exits[along[0]] != 0 : 2 * leaving > count;
  OTG_ROLLED
  for (uint i = 0; i < count; ++i, expected = !expected) {
    uint j = i;
    while (j < count && (s->exits[along[j]] != 0) != expected) ++j;
    if (j == i) continue;
    if (j == count || !(fabs(s->t[along[j]] - s->t[along[i]]) < OTG_SOLID_CLOSE_POINTS)) {
      otgGiveUp(s, OTG_SOLID_BROKEN);
      return;
    }
    const ushort moved = along[j];
    for (; j > i; --j) along[j] = along[j - 1];
    along[i] = moved;
  }
  for (uint i = 0; i < count; ++i) {
    s->rank[along[i]] = (ushort)i;
    s->previous[along[i]] = i > 0 ? along[i - 1] : OTG_NO_CROSSING;
    s->next[along[i]] = i + 1 < count ? along[i + 1] : OTG_NO_CROSSING;
  }
}

/// From the sorted hits and their ends: crossings, chords, and their order along edges. All lanes call it; where the
/// pair is given up (s->bad) numbers may be wrong, but lie in their arrays. s->bad is OTG_SOLID_BROKEN alone where the
/// contour does not close, as that of a sheet whose rim the other body touches.
OTG_INLINED void otgTraceContour(__local otg_solid_scratch* s, uint hits, OTG_MESH* meshA, OTG_MESH* meshB) {
  const uint lane = get_local_id(0);
  uint running = 0, chords = 0, total;
  for (uint slot = lane; slot < 2 * hits; slot += OTG_GROUP) {
    if (s->halfEdge[slot] == OTG_NOT_THERE) continue;
    const uint other = otgOtherSlot(s, hits, slot, meshA, meshB);
    if (other == OTG_NOT_THERE || !((s->how[slot] ^ s->how[other]) & 2)) {  // unordered: this bit stays
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
    const uint place = running + otgPlaceAmong(OTG_COUNTS(s), owned, &total);
    running += total;
    const uint chord = chords + otgPlaceAmong(OTG_COUNTS(s), isChord, &total);
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
    for (uint mesh = 0; mesh < 2; ++mesh) {
      const uint triangle = mesh == 0 ? s->a[i] : s->b[i], bit = otgChordBit(mesh, triangle);
      s->triangle[mesh][c] = triangle;
      atomic_or(s->chordBits + bit / 32, 1u << bit % 32);
      otgMarkPart(s, mesh, mesh == 0 ? meshA : meshB, triangle);
    }
  }
  OTG_SYNC;
  for (uint c = lane; c < chords; c += OTG_GROUP) {
    const uint a = s->triangle[0][c], b = s->triangle[1][c];
    uint firsts = c > 0 && s->triangle[0][c - 1] == a ? 2 : 3;  // chords are sorted by A's triangles
    for (uint d = 0; d < c; ++d) {
      if (s->triangle[1][d] == b) firsts &= ~2u;
    }
    s->firsts[c] = (uchar)firsts;
  }
  for (uint c = lane; c < crossings; c += OTG_GROUP) otgPlaceAlongEdge(s, crossings, c);
  OTG_SYNC;
  const uint tied = s->tied ? crossings : 0;
  for (uint c = lane; c < tied; c += OTG_GROUP) otgOrderTies(s, crossings, c, meshA, meshB);
  if (lane == 0) {
    s->crossings = crossings;
    s->chords = chords;
  }
  OTG_SYNC;
  for (uint c = lane; c < crossings; c += OTG_GROUP) {
    const uint previous = s->previous[c];
    if (previous != OTG_NO_CROSSING && s->exits[previous] == s->exits[c]) otgGiveUp(s, OTG_SOLID_BROKEN);
    if (s->rank[c] == 0) otgEnterEdge(s, s->edge[c], c);
  }
  OTG_SYNC;
}

#endif  // OTG_SOLID_CONTOUR_H
