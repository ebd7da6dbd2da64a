// SPDX-License-Identifier: BSD-3-Clause
// Where edges of two meshes pass each other within an overlap: as collide/solid/deepest_pass.cpp.
#ifndef OTG_SOLID_PASS_H
#define OTG_SOLID_PASS_H
#include "solid/region.h"

/// As EdgePass. The stretch at point `from`, or where there is a point `to` the edge between these two vertices.
typedef struct {
  uint from, to;
  otg_vec3_d middle, along;
  double reach, at, way;
} otg_edge_pass;

/// What is known of the region's points, in local memory.
typedef struct {
  /// By point, of A and of B: how far in its stretch reaches along the normal, or -INFINITY.
  __local double* heights[2];
  __local ulong* partners;  ///< by vertex: a bit for each behind it to which an edge leads
} otg_pass_room;

/// The point of a vertex among the region's, of which `vertices` are vertices, ascending; OTG_NOT_THERE if it has none.
OTG_INLINED uint otgFindPoint(const otg_solid_work* w, uint vertices, uint mesh, uint vertex) {
  uint low = 0, high = vertices;
  while (low < high) {
    const uint middle = (low + high) / 2;
    __global const otg_solid_point* p = w->points + middle;
    const int isBefore = p->mesh < mesh || (p->mesh == mesh && p->feature < vertex);
    low = isBefore ? middle + 1 : low;
    high = isBefore ? high : middle;
  }
  return low < vertices && w->points[low].mesh == mesh && w->points[low].feature == vertex ? low : OTG_NOT_THERE;
}

/// How many of the points are vertices; these are the first ones.
OTG_INLINED uint otgCountVertices(const otg_solid_work* w) {
  uint low = 0, high = w->pointCount;
  while (low < high) {
    const uint middle = (low + high) / 2;
    const int isVertex = w->points[middle].kind == OTG_POINT_VERTEX;
    low = isVertex ? middle + 1 : low;
    high = isVertex ? high : middle;
  }
  return low;
}

/// All lanes call it, and the room is complete behind the next barrier.
OTG_INLINED void otgListHeights(const otg_solid_work* w, otg_vec3_d normal, const otg_pass_room* room) {
  for (uint i = get_local_id(0); i < w->pointCount; i += OTG_GROUP) {
    __global const otg_solid_point* p = w->points + i;
    const int isEnd = p->kind == OTG_POINT_CROSSING;
    const double reach = isEnd ? 0.5 * p->reach : p->reach;
    const otg_vec3_d along = otgLoad(p->along), own = otgLoad(p->position);
    const double at = otgDot_d(isEnd ? otgAdd_d(own, otgScale_d(along, reach)) : own, normal);
    const double higher = fabs(otgDot_d(along, normal)) * reach;
    for (uint mesh = 0; mesh < 2; ++mesh) {
      const int isOf = p->mesh == mesh && !(isEnd && !p->flat);
      room->heights[mesh][i] = isOf ? (mesh == 0 ? -at : at) + higher : -INFINITY;
    }
  }
}

OTG_INLINED void otgListPartners(const otg_solid_work* w, OTG_MESH* a, OTG_MESH* b, uint vertices,
                                 const otg_pass_room* room) {
  for (uint i = get_local_id(0); i < vertices; i += OTG_GROUP) {
    __global const otg_solid_point* p = w->points + i;
    OTG_MESH* m = p->mesh == 0 ? a : b;
    ulong partners = 0;
    for (uint k = m->firstSpoke[p->feature]; k < m->firstSpoke[p->feature + 1]; ++k) {
      const uint2 to = m->neighbours[k];
      if (to.x <= p->feature) continue;
      const uint other = otgFindPoint(w, vertices, p->mesh, to.x);
      if (other != OTG_NOT_THERE) partners |= 1ul << other;
    }
    room->partners[i] = partners;
  }
}

/// Goes on to the next stretch at a point: 0 where there is none. `rest`: of the partners, if it is a vertex; 1 of a
/// point that is a stretch.
OTG_INLINED int otgNextStretch(const otg_solid_work* w, uint from, int isVertex, ulong* rest, otg_edge_pass* pass) {
  if (*rest == 0) return 0;
  const uint low = (uint)*rest, to = low != 0 ? otgLowestBit(low) : 32 + otgLowestBit((uint)(*rest >> 32));
  *rest &= *rest - 1;
  __global const otg_solid_point* p = w->points + from;
  pass->from = from;
  pass->to = isVertex ? to : OTG_NOT_THERE;
  pass->middle = otgLoad(p->position);
  if (isVertex) {
    const otg_vec3_d q = otgLoad(w->points[to].position), ends = otgSub_d(q, pass->middle);
    pass->middle = otgScale_d(otgAdd_d(pass->middle, q), 0.5);
    pass->along = otgUnit_d(ends);
    pass->reach = 0.5 * otgNorm_d(ends);
  } else {
    const int isEnd = p->kind == OTG_POINT_CROSSING;  // of a flat edge's stretch
    pass->along = otgLoad(p->along);
    pass->reach = isEnd ? 0.5 * p->reach : p->reach;
    if (isEnd) pass->middle = otgAdd_d(pass->middle, otgScale_d(pass->along, pass->reach));
  }
  return 1;
}

/// How far in a stretch of a mesh reaches.
OTG_INLINED double otgHeightOf(const otg_pass_room* room, uint mesh, const otg_edge_pass* pass) {
  const double own = room->heights[mesh][pass->from];
  return pass->to == OTG_NOT_THERE ? own : otgMax_d(room->heights[mesh][pass->to], own);
}

/// Where a stretch of A passes those of B that reach so far that it may be deeper than `least`: sets its `way`, `at`.
OTG_INLINED void otgPassFrom(const otg_solid_work* w, const otg_pass_room* room, uint vertices, otg_vec3_d normal,
                             double least, otg_edge_pass* p) {
  const double height = otgHeightOf(room, 0, p);
  p->way = least;
  for (uint j = 0; j < w->pointCount; ++j) {
    const int isVertex = j < vertices;
    ulong rest = isVertex ? room->partners[j] : 1;
    if (room->heights[1][j] == -INFINITY) continue;
    otg_edge_pass q;
    while (otgNextStretch(w, j, isVertex, &rest, &q)) {
      if (!(height + otgHeightOf(room, 1, &q) > least)) continue;
      const otg_vec3_d apart = otgSub_d(q.middle, p->middle);
      if (otgAreBeside_d(apart, p->reach, q.reach, normal)) continue;
      const otg_stretch_pass_d pass = otgPassOfStretches_d(apart, p->along, p->reach, q.along, q.reach, normal);
      if (!(pass.way > p->way)) continue;
      p->way = pass.way;
      p->at = pass.at;
    }
  }
}

/// As deepestPass, of A's points that are the lane's: `way` is `least` where there is none. Which point, or
/// OTG_NOT_THERE. `highest`: how far in B's stretches reach.
OTG_INLINED uint otgDeepestPass(const otg_solid_work* w, const otg_pass_room* room, uint vertices, double highest,
                                otg_vec3_d normal, double least, otg_edge_pass* deepest) {
  uint from = OTG_NOT_THERE;
  deepest->way = least;
  for (uint i = get_local_id(0); i < w->pointCount; i += OTG_GROUP) {
    const int isVertex = i < vertices;
    ulong rest = isVertex ? room->partners[i] : 1;
    if (room->heights[0][i] == -INFINITY) continue;
    otg_edge_pass p;
    while (otgNextStretch(w, i, isVertex, &rest, &p)) {
      if (!(otgHeightOf(room, 0, &p) + highest > least)) continue;
      otgPassFrom(w, room, vertices, normal, least, &p);
      if (!(p.way > deepest->way)) continue;
      *deepest = p;
      from = i;
    }
  }
  return from;
}

/// The edge of a mesh between two of the region's vertices.
OTG_INLINED uint otgEdgeBetween(const otg_solid_work* w, OTG_MESH* m, uint from, uint to) {
  const uint wanted = w->points[to].feature;
  uint k = m->firstSpoke[w->points[from].feature];
  while (m->neighbours[k].x != wanted) ++k;
  return m->neighbours[k].y;
}

#endif  // OTG_SOLID_PASS_H
