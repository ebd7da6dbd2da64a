// SPDX-License-Identifier: BSD-3-Clause
// What the surface of each region says: planes, how pieces count for normals, the way out of deep regions, and which
// points are candidates. One work-group for one pair; OTG_GROUP: its size, OTG_SOLID_POINTS, _FACES and _LARGE as in
// solid/normals.h. OTG_UNEVEN_FACES: pieces of the largest uneven region; those of larger ones are the CPU's.
#define OTG_MESHES_LOCAL
#include "solid/deep.h"

/// `units` of the arena for the work-group: its first unit, or OTG_NOT_THERE if there is no room.
OTG_INLINED uint otgTakeUnits(__local otg_solid_ways* s, uint units, __global uint* counters, uint arenaUnits) {
  OTG_SYNC;
  if (get_local_id(0) == 0) s->allocated = atomic_add(counters + OTG_COUNT_ARENA, units);
  OTG_SYNC;
  const uint begin = s->allocated;
  OTG_SYNC;
  return begin <= arenaUnits && arenaUnits - begin >= units ? begin : OTG_NOT_THERE;
}

/// Whether a region reaches so far that it is uneven, unless one direction holds for all of it: as isUneven() in
/// collide/solid/region_contacts.cpp. All lanes call it.
OTG_INLINED int otgIsUnevenRegion(__local otg_solid_ways* s, const otg_solid_work* w) {
  int roundCorner = 0;
  for (uint i = 0; i < w->pointCount; ++i) {
    roundCorner |= w->points[i].kind == OTG_POINT_CROSSING && w->points[i].corner;
  }
  if (roundCorner) return 1;
  double end[2];  // the lowest with its sign changed, and the highest
  for (uint side = 0; side < 2; ++side) {
    double most = -INFINITY;
    for (uint i = get_local_id(0); i < w->pointCount; i += OTG_GROUP) {
      const double at = otgDot_d(otgLoad(w->points[i].position), w->mean);
      most = otgMax_d(side == 0 ? -at : at, most);
    }
    OTG_SYNC;
    s->reduce[get_local_id(0)] = most;
    OTG_SYNC;
    for (uint k = 0; k < OTG_GROUP; ++k) most = otgMax_d(s->reduce[k], most);
    end[side] = most;
  }
  return otgIsUneven_d(end[1] + end[0], w->thickness);
}

/// OTG_REGION_* of a region, whose contacts the device may make.
OTG_INLINED uint otgFlagsOf(__local const otg_solid_ways* s, const otg_solid_work* w, int isUneven) {
  uint flags = s->isFlat ? OTG_REGION_FLAT : 0;
  if (w->isFixed) flags |= OTG_REGION_FIXED;
  if (otgIsThick_d(w->thickness, w->diagonal) || w->leastDepth > 0) flags |= OTG_REGION_DEEP;
  if (isUneven) flags |= OTG_REGION_UNEVEN;
  if (w->isGathered && !isUneven) flags |= OTG_REGION_GATHERED;
  // The corners of an overlap are never flat points, as long as anything is not flat.
  if (s->corners >= 3) flags |= OTG_REGION_CORNERS;
  return flags;
}

/// Whether the CPU makes the contacts of a region: rays are to find its way out, or it has too many pieces of an uneven
/// one.
OTG_INLINED int otgIsHosts(__local const otg_solid_ways* s, const otg_solid_work* w) {
  const double push = otgNorm_d(otgLoad(w->region->push));
  if (s->bad || (w->isUneven && otgIsPierced_d(push, w->region->areaA, w->region->areaB))) return 1;
  return w->isUneven && !w->isFixed && w->pieceCount > OTG_UNEVEN_FACES;
}

/// One region of pair `number`. `last`: as otgFindWayOut. `flag`: of the pair, in which the CPU sees early that it is
/// to do it; solidContacts counts it.
OTG_INLINED void otgWaysOfRegion(__local otg_solid_ways* s, uint at, OTG_MESH* a, OTG_MESH* b, uint number,
                                 otg_vec3_d last, __global uint* counters, __global uchar* arena, uint arenaUnits,
                                 __global uint2* chunks, uint chunkRoom, __global uint* flag) {
  const uint lane = get_local_id(0), most = OTG_SOLID_POINTS;
  otg_solid_work w = otgWorkOn(arena, at);
  const double areas = w.region->areaA + w.region->areaB;
  const double size = 2 * (double)(a->radius < b->radius ? a->radius : b->radius);  // of the smaller mesh
  const int counts = !(w.diagonal < OTG_SOLID_LEAST_DIAGONAL * size || areas < OTG_SOLID_LEAST_AREA * size * size);
  // The CPU makes faces of very many pieces, where it uses them at all.
  const int gathers = w.pieceCount > OTG_SOLID_MOST_ELEMENTS && w.coherence < OTG_SOLID_FLAT;
  const int tooMany = w.pointCount > (OTG_SOLID_LARGE ? 2 : 1) * most || w.pieceCount > OTG_SOLID_FACES || gathers;
  // Planes of pieces, and with large limits those of several, in two ways; which points are left, and one more.
  const uint planes = w.pieceCount * (uint)sizeof(otg_solid_face);
  const uint picks = ((min(w.pointCount, most) + 1) * (uint)sizeof(ushort) + OTG_ARENA_UNIT - 1) / OTG_ARENA_UNIT;
  const uint planeUnits = (planes + OTG_ARENA_UNIT - 1) / OTG_ARENA_UNIT;
  const uint begin = otgTakeUnits(s, counts && !tooMany ? (OTG_SOLID_LARGE ? 3 * planeUnits + picks : planeUnits) : 0,
                                  counters, arenaUnits);
  const int works = counts && !tooMany && begin != OTG_NOT_THERE;
  __global uchar* room = arena + (size_t)(works ? begin : 0) * OTG_ARENA_UNIT;
  w.faces = (__global otg_solid_face*)room;
  w.picks = 0;
  if (!works) w.pieceCount = w.pointCount = 0;
  if (lane == 0) {
    s->bad = 0;
    s->corners = 0;
  }
  otgListPieces(s, &w);
  otgMakePlanes(s, &w);
  otgWeighPieces(s, &w);
  const size_t plane = (size_t)planeUnits * OTG_ARENA_UNIT;
  otgThinRegion(s, &w, (__global otg_solid_face*)(room + plane), (__global ushort*)(room + 3 * plane));
  w.isUneven = otgIsUnevenRegion(s, &w);
  const double far = (double)(a->radius + b->radius);
  otgFindWayOut(s, &w, a, b, far, last, (__global otg_solid_face*)(room + 2 * plane));
  for (uint i = lane; i < w.pointCount; i += OTG_GROUP) {
    if (!w.points[i].flat) atomic_inc(&s->corners);
  }
  OTG_SYNC;
  const int isUneven = w.isUneven && !w.isFixed;
  const uint parts = isUneven ? 1 : (w.candidates + OTG_SOLID_CHUNK - 1) / OTG_SOLID_CHUNK;
  if (lane == 0) {
    __global otg_solid_region* r = w.region;
    uint flags = otgFlagsOf(s, &w, isUneven) | (counts ? OTG_REGION_COUNTS : 0);
    // Without room for its parts its candidates stay as they are: none is looked at, and the batch is run again.
    s->allocated = parts > 0 ? atomic_add(counters + OTG_COUNT_CHUNKS, parts) : 0;
    const int fits = s->allocated <= chunkRoom && chunkRoom - s->allocated >= parts;
    const int isHosts = tooMany || (works && otgIsHosts(s, &w));
    if (counts && (isHosts || !works || !fits)) flags |= OTG_REGION_BAD;
    if (counts && isHosts) *flag |= OTG_PAIR_TO_HOST | OTG_SOLID_TOO_MANY << OTG_PAIR_WHY;
    r->flags = flags;
    r->shareOfB = s->shareOfB;
    for (uint k = 0; k < 3; ++k) r->weighted[k] = s->weighted[k];
    otgStore(r->fixed, w.fixed);
    r->leastDepth = w.leastDepth;
    r->faces = begin;
    r->planes = OTG_SOLID_LARGE ? begin + planeUnits : begin;
    r->picks = OTG_SOLID_LARGE ? begin + 3 * planeUnits : OTG_NOT_THERE;
    r->faceCount[0] = w.facesOfA;
    r->faceCount[1] = w.facesOfB;
    r->planeCount[0] = w.planesOfA;
    r->planeCount[1] = w.planesOfB;
    r->candidates = !fits ? 0 : isUneven ? OTG_SOLID_POINTS : w.candidates;
  }
  OTG_SYNC;
  for (uint k = lane; k < parts; k += OTG_GROUP) {
    if (s->allocated + k >= chunkRoom) continue;
    chunks[s->allocated + k] = (uint2)(at, isUneven ? OTG_CHUNK_UNEVEN | number : k * OTG_SOLID_CHUNK);
  }
  OTG_SYNC_ALL;
}

/// The regions of the pairs in the lists `first` to `end` of those that have any. `chunks`: candidates, in parts, for
/// solidEstimate. `directions`: what each pair remembers, the direction of its last deep region, or zero; null if
/// none does.
__kernel __attribute__((reqd_work_group_size(OTG_GROUP, 1, 1))) void solidWays(
    __global const float4* restrict meshes, __global const otg_batch_task* restrict tasks,
    __global const otg_device_mesh* restrict places, __global uint* restrict counters, __global uchar* arena,
    uint arenaUnits, __global const uint* restrict heads, __global const uint* restrict lists, uint pairs, uint first,
    uint end, __global uint2* restrict chunks, uint chunkRoom, __global const double* restrict directions,
    __global uint* restrict chosen) {
  __local otg_solid_ways ways;
  __local otg_solid_mesh mesh[2];
  for (uint item = get_group_id(0);; item += get_num_groups(0)) {
    const uint number = otgListed(counters, lists, pairs, 1, first, end, item);
    if (number == OTG_NOT_THERE) return;
    otgTakeMeshes(mesh, meshes, tasks + number, places);
    const otg_vec3_d last = directions != 0 ? otgLoad(directions + 3 * (size_t)number) : otgVec_d(0, 0, 0);
    uint at = heads[number];
    for (uint r = 0; at != OTG_NOT_THERE && r < OTG_SOLID_REGIONS; ++r) {
      const uint next = ((__global const otg_solid_region*)(arena + (size_t)at * OTG_ARENA_UNIT))->next;
      otgWaysOfRegion(&ways, at, mesh, mesh + 1, number, last, counters, arena, arenaUnits, chunks, chunkRoom,
                      chosen + OTG_FLAGS + number);
      at = next;
    }
    OTG_SYNC;
  }
}
