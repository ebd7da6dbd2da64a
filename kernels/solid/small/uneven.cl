// SPDX-License-Identifier: BSD-3-Clause
// The candidates of uneven regions, whose parts leave each by its own face: one work-group for one region. OTG_GROUP:
// size of work-groups. OTG_UNEVEN_FACES: pieces of the largest region.
#define OTG_MESHES_LOCAL
#include "solid/uneven/candidates.h"
#include "solid/uneven/leave.h"
#include "solid/uneven/parts.h"
#include "solid/uneven/surface.h"
//
#include "shared/layout/solid_given.h"

/// The points that are looked at and are crossings, or are none, behind the first `first`: how many. All lanes call it.
OTG_INLINED uint otgListPoints(__local otg_uneven_scratch* s, const otg_solid_work* w, int areCrossings, uint first) {
  const int skipsFlat = (w->region->flags & OTG_REGION_CORNERS) != 0;
  uint count = 0, total;
  for (uint base = 0; base < w->pointCount; base += OTG_GROUP) {
    const uint i = base + get_local_id(0);
    __global const otg_solid_point* p = w->points + (i < w->pointCount ? i : 0);
    const int isListed =
        i < w->pointCount && (p->kind == OTG_POINT_CROSSING) == areCrossings && !(skipsFlat && p->flat);
    const uint place = first + count + otgPlaceAmong(OTG_COUNTS(s), isListed, &total);
    if (isListed && place < OTG_UNEVEN_POINTS) s->points[place] = (ushort)i;
    count += total;
  }
  OTG_SYNC;
  return count;
}

/// What lies in local memory, and how many faces and points there are: none where they are too many. All lanes call it.
OTG_INLINED void otgBeginUneven(__local otg_uneven_scratch* s, const otg_solid_work* w, otg_uneven* u) {
  const uint parts = otgListPoints(s, w, 0, 0), crossings = otgListPoints(s, w, 1, parts);
  const int fits = parts + crossings <= OTG_UNEVEN_POINTS && w->pieceCount <= OTG_UNEVEN_FACES;
  u->facesOfA = fits ? w->facesOfA : 0;
  u->faceCount = fits ? w->facesOfA + w->facesOfB : 0;
  u->edgesOfA = u->edgeCount = 0;
  u->slack = OTG_SOLID_ON_EDGE * w->diagonal;
  u->behind = OTG_SOLID_BELOW_SURFACE * w->diagonal;
  u->origin = otgLoad(w->region->origin);
  if (get_local_id(0) == 0) {
    s->parts = fits ? parts : 0;
    s->crossings = fits ? crossings : 0;
    s->bad = !fits;
    s->leaving = 0;
  }
  OTG_SYNC;
}

/// Faces, edges and ways; 0 where the arena has no room. All lanes call it.
OTG_INLINED int otgFindWays(__local otg_uneven_scratch* s, const otg_solid_work* w, otg_uneven* u, OTG_MESH* a,
                            OTG_MESH* b, __global uint* counters, __global uchar* arena, uint arenaUnits) {
  const uint faceBytes = u->faceCount * (uint)sizeof(otg_uneven_face);
  __global uchar* room =
      otgTakeRoom(s, faceBytes + 3 * u->faceCount * (uint)sizeof(otg_uneven_edge), counters, arena, arenaUnits);
  if (room == 0) return 0;
  u->faces = (__global otg_uneven_face*)room;
  u->edges = (__global otg_uneven_edge*)(room + faceBytes);
  if (u->faceCount > 0) otgMakeFaces(s, w, u, a, b);
  otgMakeEdges(s, u, a, b);
  otgGroupFaces(s, u);
  otgMarkCurved(u);
  uint bound = 0, total;
  for (uint base = 0; base < s->parts; base += OTG_GROUP) {
    const uint i = base + get_local_id(0);
    const otg_uneven_part part = otgPartOf(w->points + s->points[i < s->parts ? i : 0]);
    const uint first = bound + otgPlaceAmong(OTG_COUNTS(s), i < s->parts ? otgBoundOfWays(u, &part) : 0, &total);
    if (i < s->parts) s->first[i] = first;
    bound += total;
  }
  u->ways = (__global otg_uneven_way*)otgTakeRoom(s, bound * (uint)sizeof(otg_uneven_way), counters, arena, arenaUnits);
  if (u->ways == 0) return 0;
  for (uint i = get_local_id(0); i < s->parts; i += OTG_GROUP) {
    const otg_uneven_part part = otgPartOf(w->points + s->points[i]);
    otgFindWaysOf(s, u, &part, i);
  }
  OTG_SYNC_ALL;
  return 1;
}

/// Puts the candidates of a region in place of its points. Where there are none the CPU does the pair. All lanes call
/// it.
OTG_INLINED void otgDoUneven(__local otg_uneven_scratch* s, const otg_solid_work* w, OTG_MESH* a, OTG_MESH* b,
                             __global uint* counters, __global uchar* arena, uint arenaUnits) {
  otg_uneven u;
  otgBeginUneven(s, w, &u);
  int isThere = otgFindWays(s, w, &u, a, b, counters, arena, arenaUnits);
  uint leavings = 0;
  if (isThere) {  // for all lanes, as below
    otgOrderParts(s);
    otgFindTranslation(s, &u);
    leavings = otgTakeWays(s, &u);
  }
  const uint count = leavings + s->crossings;
  isThere = isThere && !s->bad && count > 0 && count <= w->candidates;
  const uint bytes = count * (uint)sizeof(otg_solid_point) + leavings * (uint)sizeof(otg_uneven_direction);
  __global uchar* room = otgTakeRoom(s, isThere ? bytes : 0, counters, arena, arenaUnits);
  isThere = isThere && room != 0;
  if (isThere) {
    u.candidates = (__global otg_solid_point*)room;
    u.directions = (__global otg_uneven_direction*)(u.candidates + count);
    otgListDirections(s, &u, otgMakeLeavings(s, w, &u));
    otgMakeCrossings(s, w, &u, leavings);
  }
  if (get_local_id(0) == 0) {
    __global otg_solid_region* r = w->region;
    if (!isThere) r->flags |= OTG_REGION_BAD;
    r->candidates = isThere ? count : 0;
    r->picks = OTG_NOT_THERE;
    if (isThere) r->points = (uint)((size_t)(room - arena) / OTG_ARENA_UNIT);
    if (isThere) r->pointCount = count;
  }
  OTG_SYNC_ALL;
}

__kernel __attribute__((reqd_work_group_size(OTG_GROUP, 1, 1))) void solidUneven(OTG_GIVEN(SolidUneven)) {
  __local otg_uneven_scratch scratch;
  __local otg_solid_mesh mesh[2];
  const uint all = min(counters[OTG_COUNT_CHUNKS], chunkRoom);
  for (uint item = get_group_id(0); item < all; item += get_num_groups(0)) {
    const uint2 chunk = chunks[item];
    if ((chunk.y & OTG_CHUNK_UNEVEN) == 0) continue;
    otgTakeMeshes(mesh, meshes, tasks + (chunk.y & ~OTG_CHUNK_UNEVEN), places);
    const otg_solid_work w = otgGoOnWith(arena, chunk.x);
    otgDoUneven(&scratch, &w, mesh, mesh + 1, counters, arena, arenaUnits);
  }
}
