// SPDX-License-Identifier: BSD-3-Clause
// From the description of an overlap to regions in the arena: pieces and points in the CPU's order, planes, and which
// points are candidates. As takeOverlap in collide/solid/found_overlap.cpp, and the beginnings of region_normals.cpp
// and region_contacts.cpp. Two work-groups for each region: one for its pieces, one for its points.
//
// OTG_GROUP: size of work-groups.
#define OTG_SOLID_POINTS OTG_WORK_CANDIDATES
#define OTG_SOLID_FACES OTG_WORK_PIECES
#define OTG_SOLID_LARGE 1
#include "solid/large/found.h"
//
#include "solid/point.h"
#include "solid/thin.h"

#define OTG_KEY_WORDS (OTG_GRID_KEYS / 32)

/// In local memory.
typedef struct {
  long sums[10];               ///< vectors of A's and of B's pieces, areas, moments
  long room[5 * OTG_GROUP];    ///< for five of them at once
  uint bits[OTG_KEY_WORDS];    ///< keys that are there
  uint twice[OTG_KEY_WORDS];   ///< and those that are there more than once
  uint before[OTG_KEY_WORDS];  ///< keys in the words before
  uint4 counts[(OTG_GROUP + 3) / 4];
  uint corners, first;
} otg_arena_scratch;

typedef struct {
  otg_vec3_d lo, hi;
  double areaUnits, momentUnits, areaA, areaB;
  otg_region_measure_d measure;
  int counts;  ///< it is not too small to have contacts
} otg_arena_region;

OTG_INLINED void otgEnterKey(__local otg_arena_scratch* s, uint key) {
  const uint bit = 1u << key % 32;
  if (atomic_or(s->bits + key / 32, bit) & bit) atomic_or(s->twice + key / 32, bit);
}

/// How many keys there are; s->before is filled in. All lanes call it.
OTG_INLINED uint otgCountKeys(__local otg_arena_scratch* s) {
  const uint lane = get_local_id(0);
  uint count = 0, total;
  OTG_SYNC;
  for (uint base = 0; base < OTG_KEY_WORDS; base += OTG_GROUP) {
    const uint i = base + lane, own = i < OTG_KEY_WORDS ? popcount(s->bits[i]) : 0;
    const uint before = count + otgPlaceAmong(OTG_COUNTS(s), own, &total);
    if (i < OTG_KEY_WORDS) s->before[i] = before;
    count += total;
  }
  OTG_SYNC;
  return count;
}

OTG_INLINED uint otgRankOfKey(__local const otg_arena_scratch* s, uint key) {
  return s->before[key / 32] + popcount(s->bits[key / 32] & ((1u << key % 32) - 1));
}

/// What the cells of a region sum up to. All lanes call it.
OTG_INLINED otg_arena_region otgMeasureCells(__local otg_arena_scratch* s, const otg_found_lists* l, uint cells,
                                             double size) {
  const uint lane = get_local_id(0);
  __global const otg_found_region* found = l->head->regions + l->region;
  otg_arena_region r;
  long own[10] = {0, 0, 0, 0, 0, 0, 0, 0, 0, 0};
  for (uint k = lane; k < OTG_KEY_WORDS; k += OTG_GROUP) s->bits[k] = s->twice[k] = 0;
  if (lane == 0) s->corners = 0;
  OTG_SYNC;
  for (uint i = lane; i < cells; i += OTG_GROUP) {
    __global const otg_found_cell* c = l->cells + i;
    const uint mesh = c->key & 1;
    if (c->key >> 16 != l->region) continue;
    for (uint k = 0; k < 3; ++k) {
      own[k] += mesh == 0 ? c->vector[k] : 0;
      own[3 + k] += mesh == 1 ? c->vector[k] : 0;
    }
    for (uint m = 0; m < 2; ++m) {
      own[6 + m] += mesh == m ? c->area : 0;
      own[8 + m] += mesh == m ? c->moment : 0;
    }
  }
  for (uint k = 0; k < 10; k += 5) {
    otgSumLanes(s->room, own + k, 5);
    for (uint i = lane; i < 5; i += OTG_GROUP) s->sums[k + i] = s->room[i * OTG_GROUP];
  }
  OTG_SYNC;
  const int terms = otgTermBits(found->load), area = otgBitsOf(found->largest);
  r.lo = otgLoad(found->lo);
  r.hi = otgLoad(found->hi);
  r.areaUnits = otgUnitsInOne(terms, area);
  r.momentUnits = otgUnitsInOne(terms, otgMomentBits(area, r.lo, r.hi));
  otg_vec3_d vector[2];
  for (uint m = 0; m < 2; ++m) {
    vector[m] = otgVec_d(otgFromUnits(s->sums[3 * m], r.areaUnits), otgFromUnits(s->sums[3 * m + 1], r.areaUnits),
                         otgFromUnits(s->sums[3 * m + 2], r.areaUnits));
  }
  r.areaA = otgFromUnits(s->sums[6], r.areaUnits);
  r.areaB = otgFromUnits(s->sums[7], r.areaUnits);
  r.measure = otgMeasureRegion_d(vector[0], vector[1], r.areaA, r.areaB,
                                 otgFromUnits(otgAddUnits(s->sums[8], s->sums[9]), r.momentUnits), r.lo, r.hi);
  r.counts =
      !(r.measure.diagonal < OTG_SOLID_LEAST_DIAGONAL * size || r.areaA + r.areaB < OTG_SOLID_LEAST_AREA * size * size);
  return r;
}

/// Whether a cell holds more than rounding; what it stands for. As addPieceOfCell.
OTG_INLINED int otgPieceOfCell(__global const otg_found_cell* c, const otg_arena_region* r, otg_vec3_d* vector,
                               double* area, double* length) {
  *vector = otgVec_d(otgFromUnits(c->vector[0], r->areaUnits), otgFromUnits(c->vector[1], r->areaUnits),
                     otgFromUnits(c->vector[2], r->areaUnits));
  *area = otgFromUnits(c->area, r->areaUnits);
  *length = otgNorm_d(*vector);
  return *area > 1e-9 * otgFromUnits(c->gross, r->areaUnits) && *length > 0;
}

OTG_INLINED ulong otgElementAlong(double lo, double hi, double origin, double cell) {
  const double x = (0.5 * (lo + hi) - origin) / cell;
  return (ulong)(x < 0 ? 0 : 1e6 < x ? 1e6 : x);
}

/// Of very many pieces those that lie together are one face, as RegionNormals::cluster. w->facesOfA and facesOfB become
/// the numbers of faces. All lanes call it.
OTG_INLINED void otgGatherElements(__local otg_solid_ways* s, otg_solid_work* w) {
  __local ulong* keys = (__local ulong*)s->numbers;
  const uint lane = get_local_id(0);
  const double cell = w->radius / 8;
  uint faces[2], total;
  for (uint mesh = 0; mesh < 2; ++mesh) {
    const uint count = otgFaceCount(w, mesh);
    __global otg_solid_face* out = w->faces + (mesh == 0 ? 0 : faces[0]);
    faces[mesh] = 0;
    OTG_SYNC;
    for (uint j = lane; j < count; j += OTG_GROUP) {
      __global const otg_solid_piece* p = w->pieces + s->list[mesh][j];
      keys[j] = otgElementAlong(p->lo[0], p->hi[0], w->lo.x, cell) |
                otgElementAlong(p->lo[1], p->hi[1], w->lo.y, cell) << 20 |
                otgElementAlong(p->lo[2], p->hi[2], w->lo.z, cell) << 40;
    }
    OTG_SYNC;
    for (uint base = 0; base < count; base += OTG_GROUP) {
      const uint j = base + lane;
      const ulong key = j < count ? keys[j] : 0;
      int isFirst = j < count;
      otg_vec3_d vector = otgVec_d(0, 0, 0), lo = vector, hi = vector;
      double area = 0, offset = 0;
      // Keys are compared 32 at a time, as in otgSameKeys.
      for (uint from = 0; from < count && isFirst; from += 32) {
        const uint here = min(count - from, 32u);
        uint same = 0;
        OTG_UNROLLED(8)
        for (uint k = 0; k < here; ++k) same |= (uint)(keys[from + k] == key) << k;
        for (; same != 0 && isFirst; same &= same - 1) {
          const uint k = from + otgLowestBit(same);
          isFirst = k >= j;
          if (!isFirst) continue;
          __global const otg_solid_piece* p = w->pieces + s->list[mesh][k];
          const otg_vec3_d own = otgLoad(p->vector);
          lo = k == j ? otgLoad(p->lo) : otgLower(lo, otgLoad(p->lo));
          hi = k == j ? otgLoad(p->hi) : otgHigher(hi, otgLoad(p->hi));
          vector = k == j ? own : otgAdd_d(vector, own);
          area = k == j ? p->area : area + p->area;
          offset = k == j ? p->offset * otgNorm_d(own) : offset + p->offset * otgNorm_d(own);
        }
      }
      const uint place = faces[mesh] + otgPlaceAmong(OTG_COUNTS(s), isFirst, &total);
      faces[mesh] += total;
      if (!isFirst) continue;
      otgSetPlane(out + place, vector, offset, lo, hi);
      otgStore(out[place].weighted, vector);
      out[place].weightedArea = area;
    }
  }
  w->facesOfA = faces[0];
  w->facesOfB = faces[1];
  OTG_SYNC_ALL;
}

/// The pieces of one region, and what they say of it. All lanes call it.
OTG_INLINED void otgArenaPieces(__local otg_arena_scratch* s, __local otg_solid_ways* ways, const otg_found_lists* l,
                                uint slot, uint cells, const otg_arena_region* r, OTG_PAIR_MESH* mesh,
                                __global uchar* arena, uint begin, uint arenaUnits,
                                __global otg_overlap_progress* progress) {
  const uint lane = get_local_id(0);
  __global otg_region_work* work = otgRegionAt(arena, slot);
  otg_vec3_d vector;
  double area, length;
  for (uint i = lane; i < cells; i += OTG_GROUP) {
    __global const otg_found_cell* c = l->cells + i;
    if (c->key >> 16 == l->region && otgPieceOfCell(c, r, &vector, &area, &length)) otgEnterKey(s, c->key & 0xffff);
  }
  const uint all = otgCountKeys(s);
  const int fits = all <= OTG_WORK_PIECES;
  const uint pieces = fits ? all : 0;
  const uint pieceUnits = otgUnitsFor(pieces, sizeof(otg_solid_piece));
  const uint faceUnits = otgUnitsFor(pieces, sizeof(otg_solid_face));
  if (lane == 0) s->first = otgTakeFrom(progress, pieceUnits + 3 * faceUnits, begin, arenaUnits);
  OTG_SYNC;
  const int room = s->first != OTG_NOT_THERE;
  const uint first = room ? s->first : 0, count = room ? pieces : 0;
  __global otg_solid_region* out = &work->region;
  __global otg_solid_piece* list = (__global otg_solid_piece*)(arena + (size_t)first * OTG_ARENA_UNIT);
  for (uint i = lane; i < (count > 0 ? cells : 0); i += OTG_GROUP) {
    __global const otg_found_cell* c = l->cells + i;
    if (c->key >> 16 != l->region || !otgPieceOfCell(c, r, &vector, &area, &length)) continue;
    const otg_vec3_d zero = otgVec_d(0, 0, 0);  // -0 and 0 are one bound
    const uint m = c->key & 1, v = c->name & ~OTG_NAME_OF_VERTEX;
    __global otg_solid_piece* p = list + otgRankOfKey(s, c->key & 0xffff);
    otgStore(p->normal, otgScale_d(vector, 1 / length));
    otgStore(p->vector, vector);
    p->area = area;
    p->offset = otgFromUnits(c->moment, r->momentUnits) / length;
    otgStore(p->lo, otgAdd_d(otgLoad(c->lo), zero));
    otgStore(p->hi, otgAdd_d(otgLoad(c->hi), zero));
    p->mesh = m;
    p->triangle = c->name & OTG_NAME_OF_VERTEX ? mesh[m].solid.spokes[mesh[m].solid.firstSpoke[v]] / 3 : c->name;
  }
  if (lane == 0) {
    otgStore(out->origin, otgLoad(l->head->origin));
    otgStore(out->lo, r->lo);
    otgStore(out->hi, r->hi);
    otgStore(out->push, r->measure.push);
    out->areaA = r->areaA;
    out->areaB = r->areaB;
    out->leastDepth = 0;
    out->diagonal = r->measure.diagonal;
    out->thickness = r->measure.thickness;
    out->coherence = r->measure.coherence;
    out->pieces = first;
    out->pieceCount = count;
    out->faces = first + pieceUnits;
    out->planes = first + pieceUnits + faceUnits;
    out->flags = 0;
    work->deepPlanes = first + pieceUnits + 2 * faceUnits;
    work->deepCount[0] = work->deepCount[1] = 0;
    work->mainCount[0] = work->mainCount[1] = 0;
  }
  for (uint k = lane; k < OTG_WAY_DIRECTIONS; k += OTG_GROUP) {
    work->highest[k] = work->lowest[k] = 0;
    work->ways[k] = 0;
  }
  OTG_SYNC_ALL;
  otg_solid_work w = otgWorkOn(arena, slot * OTG_WORK_UNITS);
  w.faces = (__global otg_solid_face*)(arena + (size_t)out->faces * OTG_ARENA_UNIT);
  w.pointCount = 0;
  otgListPieces(ways, &w);
  const uint ofA = w.facesOfA, ofB = w.facesOfB;
  if (count > OTG_SOLID_MOST_ELEMENTS) {
    otgGatherElements(ways, &w);
  } else {
    otgMakePlanes(ways, &w);
    for (uint k = lane; k < ofA + ofB; k += OTG_GROUP) {
      __global const otg_solid_piece* p = w.pieces + (k >= ofA ? ways->list[1][k - ofA] : ways->list[0][k]);
      otgStore(w.faces[k].weighted, otgLoad(p->vector));
      w.faces[k].weightedArea = p->area;
    }
  }
  if (lane == 0) {
    uint status = r->counts ? OTG_FOUND_COUNTS : 0;
    if (r->counts && (!fits || !room)) status |= OTG_FOUND_BAD;
    if (w.coherence < OTG_SOLID_COHERENT) status |= OTG_FOUND_ESCAPING;
    if (r->measure.bad || w.coherence < OTG_SOLID_COHERENT) status |= OTG_FOUND_ENTANGLED;
    if (!(status & OTG_FOUND_ESCAPING) && otgIsThick_d(w.thickness, w.diagonal)) status |= OTG_FOUND_DEEP;
    out->faceCount[0] = w.facesOfA;
    out->faceCount[1] = w.facesOfB;
    out->planeCount[0] = out->planeCount[1] = 0;
    work->pieceCount[0] = ofA;
    work->pieceCount[1] = ofB;
    work->status = status;
  }
}

/// The points of one region, and its candidates. All lanes call it.
OTG_INLINED void otgArenaPoints(__local otg_arena_scratch* s, __local otg_solid_ways* ways, const otg_found_lists* l,
                                uint slot, uint all, const otg_arena_region* r, OTG_PAIR_MESH* mesh,
                                __global uchar* arena, uint begin, uint arenaUnits,
                                __global otg_overlap_progress* progress) {
  const uint lane = get_local_id(0);
  __global otg_region_work* work = otgRegionAt(arena, slot);
  for (uint i = lane; i < all; i += OTG_GROUP) {
    const uint key = l->points[i].key;
    if (key >> 16 == l->region) otgEnterKey(s, key & 0xffff);
  }
  const uint found = otgCountKeys(s);
  const int fits = found <= OTG_WORK_POINTS;
  const uint pointUnits = otgUnitsFor(fits ? found : 0, sizeof(otg_solid_point));
  const uint pickUnits = otgUnitsFor(fits ? OTG_WORK_CANDIDATES : 0, sizeof(ushort));
  if (lane == 0) s->first = otgTakeFrom(progress, pointUnits + pickUnits, begin, arenaUnits);
  OTG_SYNC;
  const int room = s->first != OTG_NOT_THERE;
  const uint first = room ? s->first : 0, count = room && fits ? found : 0;
  __global otg_solid_point* list = (__global otg_solid_point*)(arena + (size_t)first * OTG_ARENA_UNIT);
  for (uint i = lane; i < (count > 0 ? all : 0); i += OTG_GROUP) {
    __global const otg_found_point* p = l->points + i;
    const uint key = p->key & 0xffff, feature = p->feature, ordinal = p->ordinal;
    if (p->key >> 16 != l->region) continue;
    int isFirst = 1;  // of those that lie equally deep
    if (s->twice[key / 32] >> key % 32 & 1) {
      for (uint k = 0; k < all; ++k) {
        __global const otg_found_point* q = l->points + k;
        if (q->key == p->key && (q->feature < feature || (q->feature == feature && q->ordinal < ordinal))) isFirst = 0;
      }
    }
    if (!isFirst) continue;
    const uint m = key >> 1 & 1, kind = key >> 2 & 3;
    OTG_MESH* own = &mesh[m].solid;
    const uint halfEdge = kind == OTG_POINT_VERTEX ? own->spokes[own->firstSpoke[feature]] : own->edges[feature].z;
    const otg_vec3_d normal =
        kind == OTG_POINT_VERTEX ? otgNormalOfVertex(own, feature) : otgNormalOfEdge(own, halfEdge);
    const uint other = kind == OTG_POINT_CROSSING ? p->triangle : OTG_NOT_THERE;
    otgWritePoint(list + otgRankOfKey(s, key), own, otgLoad(p->position), otgLoad(p->span), normal,
                  otgNormalInA(&mesh[1 - m].solid, other), kind, feature, ordinal, halfEdge / 3, other, key & 1);
    if (!(key & 1)) atomic_inc(&s->corners);
  }
  OTG_SYNC_ALL;
  __global otg_solid_region* out = &work->region;
  otg_solid_work w;  // what thinning needs
  w.region = out;
  w.points = list;
  w.pointCount = count;
  w.picks = (__global ushort*)(arena + (size_t)(first + pointUnits * room) * OTG_ARENA_UNIT);
  w.mean = otgUnit_d(r->measure.push);
  w.diagonal = r->measure.diagonal;
  w.candidates = 0;
  w.lo = r->lo;
  if (lane == 0) ways->bad = 0;
  otgThinPoints(ways, &w);
  const uint candidates = r->counts ? w.candidates : 0;
  if (lane == 0) {
    out->points = first;      // unordered: the pieces do not read it
    out->pointCount = count;  // unordered: the pieces do not read it
    out->picks = first + pointUnits * room;
    out->candidates = candidates;
    work->pointFlags =
        (s->corners >= 3 ? OTG_REGION_CORNERS : 0) | (fits && room && ways->bad == 0 && count > 0 ? 0 : OTG_REGION_BAD);
  }
}

/// Lists the places of the large regions of all pairs, as far as there is room.
__kernel __attribute__((reqd_work_group_size(OTG_GROUP, 1, 1))) void overlapList(
    __global const otg_overlap_task* restrict tasks, __global const uchar* restrict out, __global uint* restrict places,
    uint room, __global otg_overlap_progress* restrict progress) {
  const uint place = get_global_id(0);
  if (place >= tasks->pairs * OTG_OVERLAP_REGIONS) return;
  const otg_found_lists l = otgListsFor(out, tasks, place);
  if (!otgIsLargeRegion(&l)) return;
  const uint slot = atomic_inc(&progress->slots);
  if (slot < room) places[slot] = place;
}

/// `task`: of a single pair, which goes to `tasks` for the kernels that follow; of several it says what holds for all.
/// `places`: of the regions, by slot; null: they are the slots. The arena is free from unit `begin` on.
__kernel __attribute__((reqd_work_group_size(OTG_GROUP, 1, 1))) void overlapArena(
    const otg_overlap_task task, __global const otg_overlap_pair* restrict pairs,
    __global const float4* restrict meshes, __global const uchar* restrict out, __global const uint* restrict places,
    __global otg_overlap_task* restrict tasks, __global uchar* arena, uint begin, uint arenaUnits,
    __global otg_overlap_progress* restrict progress) {
  __local otg_arena_scratch scratch;
  __local otg_solid_ways ways;
  __local otg_overlap_mesh mesh[2];
  const uint lane = get_local_id(0), slot = get_group_id(0) / 2, isPoints = get_group_id(0) % 2;
  const int isListed = places == 0 || slot < progress->slots;
  const uint place = !isListed ? 0 : places == 0 ? slot : places[slot];
  const otg_found_lists l = otgListsOf(out, task.pairs, task.unitRoom, task.tableRoom, place);
  const int works = isListed && otgIsLargeRegion(&l);
  const uint cells = works ? l.head->counts[OTG_OVERLAP_CELLS] : 0;
  const uint points = works ? l.head->counts[OTG_OVERLAP_POINTS] : 0;
  if (places == 0 && get_group_id(0) == 0 && lane == 0) tasks[0] = task;
  if (!isPoints && lane == 0) otgRegionAt(arena, slot)->place = works ? place : OTG_NOT_THERE;
  if (!works) {
    if (lane == 0) otgRegionAt(arena, slot)->status = 0;
    return;
  }
  otgMeshesOf(meshes, pairs, place, mesh);
  const float radius = otgMin_f(mesh[0].solid.radius, mesh[1].solid.radius);
  const otg_arena_region r = otgMeasureCells(&scratch, &l, cells, 2 * (double)radius);
  if (isPoints) {
    otgArenaPoints(&scratch, &ways, &l, slot, points, &r, mesh, arena, begin, arenaUnits, progress);
  } else {
    otgArenaPieces(&scratch, &ways, &l, slot, cells, &r, mesh, arena, begin, arenaUnits, progress);
  }
}
