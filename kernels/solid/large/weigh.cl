// SPDX-License-Identifier: BSD-3-Clause
// What the pieces of each region say: how faces count for normals, planes for ways out, and main directions of deep
// regions. Several work-groups for each region. The first OTG_WEIGH_FIXED have a task of their own, the others weigh
// faces, OTG_WEIGH_PARTS lanes to a face. As the beginnings of region_normals.cpp, region_contacts.cpp and escape.cpp
// in collide/solid.
//
// OTG_GROUP: size of work-groups; OTG_WEIGH_GROUPS: how many there are for each region.
#define OTG_SOLID_POINTS OTG_WORK_CANDIDATES
#define OTG_SOLID_FACES OTG_WORK_PIECES
#define OTG_SOLID_LARGE 1
#include "solid/large/found.h"
//
#include "solid/deep.h"

#define OTG_WEIGH_FIXED 6
#if OTG_GROUP >= 16
#define OTG_WEIGH_PARTS 16
#else
#define OTG_WEIGH_PARTS 1
#endif

/// Weights of the faces of a region, which go to `meanOffset`. `group`: of those that do this.
OTG_INLINED void otgWeighFaces(const otg_solid_work* w, uint group, uint groups, __local double* ways) {
  const uint lane = get_local_id(0), part = lane % OTG_WEIGH_PARTS, faces = w->facesOfA + w->facesOfB;
  const uint atOnce = OTG_GROUP / OTG_WEIGH_PARTS;
  for (uint base = group * atOnce; base < faces; base += groups * atOnce) {
    const uint k = base + lane / OTG_WEIGH_PARTS;
    double nearest = INFINITY, convex = INFINITY;
    if (k < faces) {
      __global const otg_solid_face* face = w->faces + k;
      const uint other = k >= w->facesOfA ? 0 : 1, count = otgFaceCount(w, other);
      const uint step = (count + OTG_WEIGH_PARTS - 1) / OTG_WEIGH_PARTS;
      const uint first = min(part * step, count), end = min(first + step, count);
      nearest = otgWayOut(otgFace(w, other, first), end - first, otgMiddleOfPlane(face),
                          otgScale_d(otgLoad(face->normal), -1.0), OTG_SOLID_PIECE_SLACK * w->diagonal, 1, &convex);
    }
    ways[2 * lane] = nearest;
    ways[2 * lane + 1] = convex;
    OTG_SYNC;
    if (part == 0 && k < faces) {
      for (uint i = 1; i < OTG_WEIGH_PARTS; ++i) {
        nearest = otgMin_d(ways[2 * (lane + i)], nearest);
        convex = otgMin_d(ways[2 * (lane + i) + 1], convex);
      }
      w->faces[k].meanOffset = otgWeightOfWays(w, nearest, convex);
    }
    OTG_SYNC;
  }
}

/// Planes of one mesh for ways out of candidates.
OTG_INLINED void otgGatherPlanes(__local otg_solid_ways* s, const otg_solid_work* w, uint mesh,
                                 __global otg_region_work* r) {
  const uint count = otgFaceCount(w, mesh);
  __global otg_solid_face* out = w->planes + (mesh == 0 ? 0 : w->facesOfA);
  if (count > OTG_SOLID_MOST_PLANES) {
    const uint planes = otgGather(s, w, mesh, 0, out);
    if (get_local_id(0) == 0) r->region.planeCount[mesh] = planes;
    return;
  }
  for (uint j = get_local_id(0); j < count; j += OTG_GROUP) {
    __global const otg_solid_piece* p = w->pieces + s->list[mesh][j];
    const otg_vec3_d vector = otgLoad(p->vector);
    otgSetPlane(out + j, vector, p->offset * otgNorm_d(vector), otgLoad(p->lo), otgLoad(p->hi));
  }
  if (get_local_id(0) == 0) r->region.planeCount[mesh] = count;  // unordered: no one reads it here
}

/// Planes of one mesh for ways out of a deep region.
OTG_INLINED void otgGatherDeep(__local otg_solid_ways* s, const otg_solid_work* w, uint mesh,
                               __global otg_solid_face* room, __global otg_region_work* r) {
  const uint count = otgFaceCount(w, mesh);
  __global otg_solid_face* out = room + (mesh == 0 ? 0 : w->facesOfA);
  if (w->pieceCount > OTG_SOLID_DEEP_PIECES) {
    const uint planes = otgGather(s, w, mesh, 1, out);
    if (get_local_id(0) == 0) r->deepCount[mesh] = planes;
    return;
  }
  for (uint j = get_local_id(0); j < count; j += OTG_GROUP) {
    __global const otg_solid_piece* p = w->pieces + s->list[mesh][j];
    otgSetPlane(out + j, otgScale_d(otgLoad(p->normal), p->area), p->offset * p->area, otgLoad(p->lo), otgLoad(p->hi));
    out[j].meanOffset = out[j].offset;
  }
  if (get_local_id(0) == 0) r->deepCount[mesh] = count;
}

__kernel __attribute__((reqd_work_group_size(OTG_GROUP, 1, 1))) void overlapWeigh(__global uchar* arena) {
  __local otg_solid_ways ways;
  __local int isWorked;
  const uint lane = get_local_id(0), slot = get_group_id(0) / OTG_WEIGH_GROUPS;
  const uint part = get_group_id(0) % OTG_WEIGH_GROUPS, mesh = part % 2;
  __global otg_region_work* r = otgRegionAt(arena, slot);
  if (!otgIsWorked(r, &isWorked)) return;
  otg_solid_work w = otgWorkOf(arena, slot);
  if (part >= OTG_WEIGH_FIXED) {
    if (w.thickness > 0 && w.coherence < OTG_SOLID_FLAT) {
      otgWeighFaces(&w, part - OTG_WEIGH_FIXED, OTG_WEIGH_GROUPS - OTG_WEIGH_FIXED, ways.numbers);
    } else {
      for (uint k = (part - OTG_WEIGH_FIXED) * OTG_GROUP + lane; k < w.facesOfA + w.facesOfB;
           k += (OTG_WEIGH_GROUPS - OTG_WEIGH_FIXED) * OTG_GROUP) {
        w.faces[k].meanOffset = 1;
      }
    }
    return;
  }
  const int isDeep = (r->status & OTG_FOUND_DEEP) != 0;
  if (part >= 2 && !isDeep) return;
  // From here on the lists are of pieces.
  otgListPieces(&ways, &w);
  if (part < 2) {
    otgGatherPlanes(&ways, &w, mesh, r);
  } else if (part < 4) {
    otgGatherDeep(&ways, &w, mesh, (__global otg_solid_face*)(arena + (size_t)r->deepPlanes * OTG_ARENA_UNIT), r);
  } else {
    if (lane == 0) ways.count = 0;
    otgSortFaces(&ways, &w, mesh, 1);
    OTG_SYNC;
    otgGatherFaces(&ways, &w, mesh, 1);
    if (lane == 0) otgTakeFaces(&ways, 0.01 * (r->region.areaA + r->region.areaB));
    OTG_SYNC;
    for (uint k = lane; k < 3 * ways.count; k += OTG_GROUP) {
      r->mainDirections[mesh][k / 3][k % 3] = OTG_DEEP_DIRECTION(&ways, k / 3)[k % 3];
    }
    if (lane == 0) r->mainCount[mesh] = ways.count;
  }
}
