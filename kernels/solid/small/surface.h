// SPDX-License-Identifier: BSD-3-Clause
// The clipped surface and the points of one region, by one work-group; as region_clip.cpp and regions.cpp
// in collide/solid, in the same order.
#ifndef OTG_SOLID_SURFACE_H
#define OTG_SOLID_SURFACE_H
#include "solid/outline.h"
#include "solid/small/inside.h"
//
#include "solid/point.h"

typedef struct {
  __local otg_solid_scratch* s;
  OTG_MESH *a, *b;
  otg_vec3_d origin;
} otg_solid_pair;

OTG_INLINED otg_vec3_d otgCrossingAt(const otg_solid_pair* p, uint c) {
  return otgSub_d(otgVec_d(p->s->x[c], p->s->y[c], p->s->z[c]), p->origin);
}

OTG_INLINED otg_vec3_d otgRelativeVertex(const otg_solid_pair* p, OTG_MESH* m, uint v) {
  return otgSub_d(otgVertexAt(m, v), p->origin);
}

OTG_INLINED uint otgRegionOf(const otg_solid_pair* p, uint element) {
  return element < OTG_SOLID_HITS ? p->s->region[element] : (uint)p->s->vote[element - OTG_SOLID_HITS];
}

/// The part of a triangle in a region; area 0 if there is none.
OTG_INLINED double otgClip(const otg_solid_pair* pair, OTG_MESH* m, uint triangle, uint region, otg_outline* loop,
                           otg_vec3_d* normal) {
  __local otg_solid_scratch* s = pair->s;
  const uint mesh = m->isB ? 1 : 0;
  const uint4 corners = m->triangles[4 * (size_t)triangle], edges = m->triangles[4 * (size_t)triangle + 1];
  uint vertex = corners.x, element = otgElementOf(s, mesh, vertex);
  otg_vec3_d at = otgRelativeVertex(pair, m, vertex);
  *loop = otgOutlineFrom(at);
  OTG_ROLLED
  for (uint k = 0; k < 3; ++k) {
    const uint edge = otgOf3(edges, k), nextVertex = otgOf3(corners, k == 2 ? 0 : k + 1);
    const uint nextElement = otgElementOf(s, mesh, nextVertex);
    const otg_vec3_d nextAt = otgRelativeVertex(pair, m, nextVertex);
    uint c = otgFirstAlong(s, edge << 1 | mesh);
    if (c == OTG_NO_CROSSING && element != OTG_NOT_THERE && nextElement != OTG_NOT_THERE &&
        otgRegionOf(pair, element) == region) {
      otgAddToOutline(loop, at, nextAt);
    }
    const int forward = vertex == m->edges[edge].x;
    for (; c != OTG_NO_CROSSING; c = s->next[c]) {
      uint from, to;
      if (!otgStretchAt(s, c, m, &from, &to) || otgRegionOf(pair, from) != region) continue;
      // The vertices at the ends of the edge are corners of the triangle.
      const otg_vec3_d p = from < OTG_SOLID_HITS ? otgCrossingAt(pair, from) : forward ? at : nextAt;
      const otg_vec3_d q = to < OTG_SOLID_HITS ? otgCrossingAt(pair, to) : forward ? nextAt : at;
      otgAddToOutline(loop, forward ? p : q, forward ? q : p);
    }
    vertex = nextVertex;
    element = nextElement;
    at = nextAt;
  }
  for (uint c = s->chords; c-- > 0;) {
    if (s->triangle[mesh][c] != triangle) continue;
    if (otgRegionOf(pair, s->start[c]) != region) continue;
    const otg_vec3_d p = otgCrossingAt(pair, s->start[c]), q = otgCrossingAt(pair, s->end[c]);
    otgAddToOutline(loop, mesh == 0 ? p : q, mesh == 0 ? q : p);
  }
  *normal = otgDirectionInA(m, otgOwnNormal(m, triangle));
  return loop->any ? 0.5 * otgDot_d(loop->sum, *normal) : 0;
}

OTG_INLINED void otgWritePiece(__global otg_solid_piece* out, uint mesh, uint triangle, otg_vec3_d n, double area,
                               double offset, otg_vec3_d lo, otg_vec3_d hi) {
  otgStore(out->normal, n);
  otgStore(out->vector, otgScale_d(n, area));
  out->area = area;
  out->offset = offset;
  otgStore(out->lo, lo);
  otgStore(out->hi, hi);
  out->mesh = mesh;
  out->triangle = triangle;
}

/// Of the triangles around a vertex those that are wholly inside and of which it is the first vertex, a bit for each
/// spoke.
OTG_INLINED ulong otgInteriorAt(const otg_solid_pair* pair, uint slot) {
  __local otg_solid_scratch* s = pair->s;
  const uint mesh = (s->vertexKey[slot] - 1) & 1, v = (s->vertexKey[slot] - 1) >> 1;
  OTG_MESH* m = mesh == 0 ? pair->a : pair->b;
  const uint first = m->firstSpoke[v], spokes = m->firstSpoke[v + 1] - first;
  ulong interior = 0;
  if (spokes > 64) otgGiveUp(s, OTG_SOLID_TOO_MANY);
  for (uint k = 0; k < spokes && k < 64; ++k) {
    const uint triangle = m->spokes[first + k] / 3;
    const uint4 corners = m->triangles[4 * (size_t)triangle], edges = m->triangles[4 * (size_t)triangle + 1];
    if (corners.x < v || corners.y < v || corners.z < v) continue;
    if (otgFindInside(s, mesh, corners.x) == OTG_NOT_THERE || otgFindInside(s, mesh, corners.y) == OTG_NOT_THERE ||
        otgFindInside(s, mesh, corners.z) == OTG_NOT_THERE) {
      continue;
    }
    if (otgFirstAlong(s, edges.x << 1 | mesh) != OTG_NO_CROSSING ||
        otgFirstAlong(s, edges.y << 1 | mesh) != OTG_NO_CROSSING ||
        otgFirstAlong(s, edges.z << 1 | mesh) != OTG_NO_CROSSING) {
      continue;
    }
    int clipped = 0;  // by a contour that stays within it
    const uint chords = otgMayHaveChord(s, mesh, triangle) ? s->chords : 0;
    for (uint c = 0; c < chords; ++c) clipped |= s->triangle[mesh][c] == triangle;
    if (!clipped) interior |= 1ul << k;
  }
  return interior;
}

OTG_INLINED void otgWriteInterior(const otg_solid_pair* pair, uint slot, ulong interior,
                                  __global otg_solid_piece* out) {
  const uint mesh = (pair->s->vertexKey[slot] - 1) & 1, v = (pair->s->vertexKey[slot] - 1) >> 1;
  OTG_MESH* m = mesh == 0 ? pair->a : pair->b;
  for (uint k = m->firstSpoke[v]; interior != 0; ++k, interior >>= 1) {
    if (!(interior & 1)) continue;
    const uint triangle = m->spokes[k] / 3;
    const uint4 corners = m->triangles[4 * (size_t)triangle];
    const otg_vec3_d p = otgRelativeVertex(pair, m, corners.x), q = otgRelativeVertex(pair, m, corners.y);
    const otg_vec3_d r = otgRelativeVertex(pair, m, corners.z);
    const otg_vec3_d n = otgDirectionInA(m, otgOwnNormal(m, triangle));
    otgWritePiece(out++, mesh, triangle, n, otgAreaOf(m, triangle), otgDot_d(n, p), otgLower(p, otgLower(q, r)),
                  otgHigher(p, otgHigher(q, r)));
  }
}

OTG_INLINED void otgWriteVertexPoint(const otg_solid_pair* pair, uint slot, __global otg_solid_point* out) {
  const uint mesh = (pair->s->vertexKey[slot] - 1) & 1, v = (pair->s->vertexKey[slot] - 1) >> 1;
  OTG_MESH* m = mesh == 0 ? pair->a : pair->b;
  otgWritePoint(out, m, otgRelativeVertex(pair, m, v), otgVec_d(0, 0, 0), otgNormalOfVertex(m, v), otgVec_d(0, 0, 0),
                OTG_POINT_VERTEX, v, 0, m->spokes[m->firstSpoke[v]] / 3, OTG_NOT_THERE,
                (as_uint(m->vertices[v].w) & OTG_VERTEX_FLAT) != 0);
}

/// The points of the stretch at a crossing: how many, and writes them unless `out` is null.
OTG_INLINED uint otgStretchPoints(const otg_solid_pair* pair, uint c, uint region, __global otg_solid_point* out) {
  __local otg_solid_scratch* s = pair->s;
  const uint mesh = s->edge[c] & 1, edge = s->edge[c] >> 1;
  OTG_MESH* m = mesh == 0 ? pair->a : pair->b;
  uint from, to, count = 0;
  if (!otgStretchAt(s, c, m, &from, &to) || otgRegionOf(pair, from) != region) return 0;
  const uint4 ends = m->edges[edge];
  const int fromVertex = from >= OTG_SOLID_HITS, toVertex = to >= OTG_SOLID_HITS, flat = ends.w == OTG_EDGE_FLAT;
  const int middle = !flat && !(fromVertex && toVertex);
  if (out == 0) return (uint)(!fromVertex + !toVertex + middle);
  const otg_vec3_d p = fromVertex ? otgRelativeVertex(pair, m, ends.x) : otgCrossingAt(pair, from);
  const otg_vec3_d q = toVertex ? otgRelativeVertex(pair, m, ends.y) : otgCrossingAt(pair, to);
  const otg_vec3_d d = otgSub_d(q, p);
  const uint stretch = s->exits[c] ? s->rank[c] / 2u : (s->rank[c] + 1u) / 2u, own = ends.z / 3;
  const otg_vec3_d normal = otgNormalOfEdge(m, ends.z);
  const int kind = fromVertex || toVertex ? OTG_POINT_MIDDLE : OTG_POINT_MIDDLE_OF_CONTOUR;
  OTG_ROLLED
  for (uint k = 0; k < 3; ++k) {  // its beginning, its end, its middle
    if (k == 0 ? fromVertex : k == 1 ? toVertex : !middle) continue;
    const otg_vec3_d at = k == 0 ? p : k == 1 ? q : otgScale_d(otgAdd_d(p, q), 0.5);
    const otg_vec3_d span = k == 0 ? d : otgScale_d(d, k == 1 ? -1.0 : 0.5);
    if (k == 2) {
      // The face of `halfEdge` lies to its left.
      const uint halfEdge = ends.z;
      const int forward = otgCornerOf(m, halfEdge) == ends.x;
      const otg_vec3_d along = otgSub_d(otgVertexAt(m, ends.y), otgVertexAt(m, ends.x));
      out[count].corner = otgIsConvex_d(otgDirectionInA(m, otgOwnNormal(m, own)),
                                        otgDirectionInA(m, otgOwnNormal(m, otgTwinOf(m, halfEdge) / 3)),
                                        forward ? along : otgScale_d(along, -1.0));
    }
    if (k < 2) out[count].corner = ends.w == OTG_EDGE_INNER;
    const uint other = k == 2 ? OTG_NOT_THERE : s->other[k == 0 ? from : to];
    otgWritePoint(out + count, m, at, span, normal, otgNormalInA(mesh == 0 ? pair->b : pair->a, other),
                  k == 2 ? kind : OTG_POINT_CROSSING, edge, k == 2 ? stretch : 2 * stretch + k, own, other, flat);
    ++count;
  }
  return count;
}

#endif  // OTG_SOLID_SURFACE_H
