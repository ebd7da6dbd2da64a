// SPDX-License-Identifier: BSD-3-Clause
// Where edges of two meshes pass each other within an overlap: as collide/solid/deepest_pass.cpp.
#ifndef OTG_SOLID_PASS_H
#define OTG_SOLID_PASS_H
#include "solid/region.h"

/// As EdgePass. `stretch`: number of the point, or OTG_NOT_THERE.
typedef struct {
  uint stretch, edge;
  otg_vec3_d middle, along;
  double reach, at, way;
} otg_edge_pass;

/// How far in the stretches at a point of mesh `mesh` reach, along a normal out of B; -INFINITY where none is.
OTG_INLINED double otgHeightOf(__global const otg_solid_point* p, uint mesh, otg_vec3_d normal) {
  const double at = otgDot_d(otgLoad(p->position), normal), reach = fabs(otgDot_d(otgLoad(p->along), normal)) * p->reach;
  return p->mesh != mesh || p->kind == OTG_POINT_CROSSING ? -INFINITY : (mesh == 0 ? -at : at) + reach;
}

/// The point of a vertex, or OTG_NOT_THERE where that is not in the region. Vertices are the first points, ascending.
OTG_INLINED uint otgFindPoint(const otg_solid_work* w, uint mesh, uint vertex) {
  uint low = 0, high = w->pointCount;
  while (low < high) {
    const uint middle = (low + high) / 2;
    __global const otg_solid_point* p = w->points + middle;
    const int isBefore =
        p->kind == OTG_POINT_VERTEX && (p->mesh < mesh || (p->mesh == mesh && p->feature < vertex));
    low = isBefore ? middle + 1 : low;
    high = isBefore ? high : middle;
  }
  if (low == w->pointCount) return OTG_NOT_THERE;
  __global const otg_solid_point* p = w->points + low;
  return p->kind == OTG_POINT_VERTEX && p->mesh == mesh && p->feature == vertex ? low : OTG_NOT_THERE;
}

/// How many stretches there may be at a point: one that it is the middle of; of a vertex the edges.
OTG_INLINED uint otgStretchesAt(OTG_MESH* m, __global const otg_solid_point* p) {
  return p->kind == OTG_POINT_VERTEX ? m->firstSpoke[p->feature + 1] - m->firstSpoke[p->feature] : 1;
}

/// Number k of them; 0 where an edge is flat, or does not lead to another vertex of the region. `way` and `at` are not
/// set.
OTG_INLINED int otgTakeStretch(const otg_solid_work* w, OTG_MESH* m, uint point, uint k, otg_edge_pass* pass) {
  __global const otg_solid_point* p = w->points + point;
  pass->middle = otgLoad(p->position);
  pass->along = otgLoad(p->along);
  pass->reach = p->reach;
  pass->stretch = point;
  pass->edge = p->feature;
  if (p->kind != OTG_POINT_VERTEX) return 1;
  const uint2 to = m->neighbours[m->firstSpoke[p->feature] + k];
  const uint other = m->edges[to.y].w == OTG_EDGE_FLAT ? OTG_NOT_THERE : otgFindPoint(w, p->mesh, to.x);
  if (other == OTG_NOT_THERE) return 0;
  const otg_vec3_d q = otgLoad(w->points[other].position), ends = otgSub_d(q, pass->middle);
  pass->middle = otgScale_d(otgAdd_d(pass->middle, q), 0.5);
  pass->along = otgUnit_d(ends);
  pass->reach = 0.5 * otgNorm_d(ends);
  pass->stretch = OTG_NOT_THERE;
  pass->edge = to.y;
  return 1;
}

/// Where a stretch of A passes those of B that reach so far that it may be deeper than `least`: sets its `way`, `at`.
OTG_INLINED void otgPassFrom(const otg_solid_work* w, OTG_MESH* b, double height, otg_vec3_d normal, double least,
                             otg_edge_pass* p) {
  p->way = least;
  for (uint j = 0; j < w->pointCount; ++j) {
    __global const otg_solid_point* y = w->points + j;
    if (!(height + otgHeightOf(y, 1, normal) > least)) continue;
    const uint count = otgStretchesAt(b, y);
    for (uint l = 0; l < count; ++l) {
      otg_edge_pass q;
      if (!otgTakeStretch(w, b, j, l, &q)) continue;
      const otg_stretch_pass_d pass =
          otgPassOfStretches_d(otgSub_d(q.middle, p->middle), p->along, p->reach, q.along, q.reach, normal);
      if (!(pass.way > p->way)) continue;
      p->way = pass.way;
      p->at = pass.at;
    }
  }
}

/// As deepestPass, of A's points that are the lane's: `way` is `least` where there is none. Which point, or
/// OTG_NOT_THERE. `highest`: how far in B's stretches reach.
OTG_INLINED uint otgDeepestPass(const otg_solid_work* w, OTG_MESH* a, OTG_MESH* b, double highest, otg_vec3_d normal,
                                double least, otg_edge_pass* deepest) {
  uint from = OTG_NOT_THERE;
  deepest->way = least;
  for (uint i = get_local_id(0); i < w->pointCount; i += OTG_GROUP) {
    __global const otg_solid_point* x = w->points + i;
    const double height = otgHeightOf(x, 0, normal);
    if (!(height + highest > least)) continue;
    const uint count = otgStretchesAt(a, x);
    for (uint k = 0; k < count; ++k) {
      otg_edge_pass p;
      if (!otgTakeStretch(w, a, i, k, &p)) continue;
      otgPassFrom(w, b, height, normal, least, &p);
      if (!(p.way > deepest->way)) continue;
      *deepest = p;
      from = i;
    }
  }
  return from;
}

/// How far in the stretches of B reach. `room`: OTG_GROUP places in local memory. All lanes call it.
OTG_INLINED double otgHighestOf(__local double* room, const otg_solid_work* w, otg_vec3_d normal) {
  double highest = -INFINITY;
  for (uint j = get_local_id(0); j < w->pointCount; j += OTG_GROUP) {
    highest = otgMax_d(otgHeightOf(w->points + j, 1, normal), highest);
  }
  return otgLargestOf(room, highest);
}

#endif  // OTG_SOLID_PASS_H
