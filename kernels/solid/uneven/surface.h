// SPDX-License-Identifier: BSD-3-Clause
// The triangles on which an uneven region's pieces lie, and their convex edges, in the order of the CPU: as
// collide/solid/region_triangles.cpp.
#ifndef OTG_UNEVEN_SURFACE_H
#define OTG_UNEVEN_SURFACE_H
#include "solid/point.h"
#include "solid/uneven/scratch.h"

OTG_INLINED void otgMakeFace(__global otg_uneven_face* f, __global const otg_solid_piece* p, OTG_MESH* m,
                             otg_vec3_d origin) {
  const otg_vec3_d normal = otgLoad(p->normal);
  otg_vec3_d corner[3];
  otgCornersAt(m, p->triangle, corner);
  for (uint k = 0; k < 3; ++k) corner[k] = otgSub_d(corner[k], origin);
  for (uint k = 0; k < 3; ++k) {
    const otg_vec3_d inward = otgInward_d(normal, corner[k], corner[(k + 1) % 3]);
    otgStore(f->corner + 3 * k, corner[k]);
    otgStore(f->inward + 3 * k, inward);
    f->edge[k] = otgDot_d(inward, corner[k]);
  }
  otgStore(f->normal, normal);
  f->offset = p->offset;
  f->triangle = p->triangle;
}

/// A's faces in the order of its pieces, then B's. All lanes call it.
OTG_INLINED void otgMakeFaces(__local otg_uneven_scratch* s, const otg_solid_work* w, const otg_uneven* u, OTG_MESH* a,
                              OTG_MESH* b) {
  uint running[2], total;
  running[0] = 0;
  running[1] = u->facesOfA;
  for (uint base = 0; base < w->pieceCount; base += OTG_GROUP) {
    const uint i = base + get_local_id(0);
    const uint mesh = i < w->pieceCount ? w->pieces[i].mesh : 2;
    for (uint m = 0; m < 2; ++m) {
      const uint place = running[m] + otgPlaceAmong(OTG_COUNTS(s), mesh == m, &total);
      if (mesh == m) otgMakeFace(u->faces + place, w->pieces + i, m == 0 ? a : b, u->origin);
      running[m] += total;
    }
  }
  OTG_SYNC_ALL;
}

/// The face on the other side of edge k of a face, in the mesh; OTG_NOT_THERE at a rim.
OTG_INLINED uint otgBeyondEdge(OTG_MESH* m, __global const otg_uneven_face* f, uint k) {
  const uint halfEdge = 3 * f->triangle + k, twin = otgTwinOf(m, halfEdge);
  return twin == halfEdge ? OTG_NOT_THERE : twin / 3;
}

/// Whether an edge of face i is convex, and no face before it has it. That one finds it convex, too: what either
/// computes differs by the signs of both factors.
OTG_INLINED int otgIsNewEdge(const otg_uneven* u, uint first, uint i, uint k, OTG_MESH* m) {
  __global const otg_uneven_face* f = u->faces + i;
  const uint beyond = otgBeyondEdge(m, f, k);
  if (beyond == OTG_NOT_THERE) return 0;
  const otg_vec3_d ends = otgSub_d(otgLoad(f->corner + 3 * ((k + 1) % 3)), otgLoad(f->corner + 3 * k));
  if (!otgIsConvex_d(otgLoad(f->normal), otgNormalInA(m, beyond), ends)) return 0;
  for (uint j = first; j < i; ++j) {
    if (u->faces[j].triangle == beyond) return 0;
  }
  return 1;
}

OTG_INLINED void otgMakeEdge(__global otg_uneven_edge* e, __global const otg_uneven_face* f, uint k, OTG_MESH* m) {
  const otg_vec3_d corner = otgLoad(f->corner + 3 * k);
  const otg_vec3_d ends = otgSub_d(otgLoad(f->corner + 3 * ((k + 1) % 3)), corner);
  otgStore(e->middle, otgAdd_d(corner, otgScale_d(ends, 0.5)));
  otgStore(e->along, otgUnit_d(ends));
  e->reach = 0.5 * otgNorm_d(ends);
  otgStore(e->faces, otgLoad(f->normal));
  otgStore(e->faces + 3, otgNormalInA(m, otgBeyondEdge(m, f, k)));
}

/// All lanes call it.
OTG_INLINED void otgMakeEdges(__local otg_uneven_scratch* s, otg_uneven* u, OTG_MESH* a, OTG_MESH* b) {
  uint count = 0, total;
  for (uint mesh = 0; mesh < 2; ++mesh) {
    const uint first = otgFirstFace(u, mesh), items = 3 * (otgEndOfFaces(u, mesh) - first);
    for (uint base = 0; base < items; base += OTG_GROUP) {
      const uint item = base + get_local_id(0), i = first + item / 3;
      const int isNew = item < items && otgIsNewEdge(u, first, i, item % 3, mesh == 0 ? a : b);
      const uint place = count + otgPlaceAmong(OTG_COUNTS(s), isNew, &total);
      if (isNew) otgMakeEdge(u->edges + place, u->faces + i, item % 3, mesh == 0 ? a : b);
      count += total;
    }
    if (mesh == 0) u->edgesOfA = count;
  }
  u->edgeCount = count;
  OTG_SYNC_ALL;
}

/// Which faces face the same way, as the CPU groups them: in order along x each is grouped with the nearest one
/// before it. All lanes call it.
OTG_INLINED void otgGroupFaces(__local otg_uneven_scratch* s, const otg_uneven* u) {
  const uint lane = get_local_id(0), count = u->faceCount;
  for (uint i = lane; i < count; i += OTG_GROUP) {
    const double x = u->faces[i].normal[0];
    uint place = 0;
    for (uint j = 0; j < count; ++j) {
      const double other = u->faces[j].normal[0];
      place += (uint)((other < x) | ((other == x) & (j < i)));
    }
    s->order[place] = (ushort)i;
  }
  OTG_SYNC;
  const double most = sqrt(2 * (1 - OTG_UNEVEN_SAME_NORMAL));
  for (uint k = lane; k < count; k += OTG_GROUP) {
    const otg_vec3_d normal = otgLoad(u->faces[s->order[k]].normal);
    uint before = k;
    for (uint j = k; j-- > 0 && before == k;) {
      const otg_vec3_d other = otgLoad(u->faces[s->order[j]].normal);
      if (!(normal.x - other.x <= most)) break;
      if (otgDot_d(normal, other) > OTG_UNEVEN_SAME_NORMAL) before = j;
    }
    s->before[k] = (ushort)before;
  }
  OTG_SYNC;
  for (uint k = lane; k < count; k += OTG_GROUP) {
    uint root = k;
    while (s->before[root] != root) root = s->before[root];
    u->faces[s->order[k]].sameAs = s->order[root];
  }
}

/// Which faces are facets of a curved surface. All lanes call it.
OTG_INLINED void otgMarkCurved(const otg_uneven* u) {
  for (uint mesh = 0; mesh < 2; ++mesh) {
    const uint first = otgFirstFace(u, mesh), end = otgEndOfFaces(u, mesh);
    for (uint i = first + get_local_id(0); i < end; i += OTG_GROUP) {
      const otg_vec3_d normal = otgLoad(u->faces[i].normal);
      uint curved = 0;
      for (uint j = first; j < end; ++j) {
        curved |= (uint)otgIsTurned_d(otgDot_d(otgLoad(u->faces[j].normal), normal));
      }
      u->faces[i].curved = curved;
    }
  }
  OTG_SYNC_ALL;
}

#endif  // OTG_UNEVEN_SURFACE_H
