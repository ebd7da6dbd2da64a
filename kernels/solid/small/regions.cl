// SPDX-License-Identifier: BSD-3-Clause
// The overlap regions of pairs of solids: one work-group for one pair. What is not plain (see OTG_SOLID_*) is flagged
// for the CPU. OTG_GROUP: size of work-groups, 32 at least; OTG_SOLID_HITS as in solid/small/scratch.h.
#define OTG_MESHES_LOCAL
#include "solid/small/contour.h"
//
#include "solid/small/surface.h"

/// Sorts the pair's hits by triangles into local memory.
OTG_INLINED void otgSortHits(__local otg_solid_scratch* s, __global const otg_solid_hit* list, uint hits) {
  for (uint i = get_local_id(0); i < hits; i += OTG_GROUP) {
    const otg_solid_hit mine = list[i];
    uint place = 0;
    for (uint j = 0; j < hits; ++j) {
      const uint a = list[j].a, b = list[j].b;
      place += a < mine.a || (a == mine.a && b < mine.b);
    }
    s->a[place] = mine.a;
    s->b[place] = mine.b;
    for (uint k = 0; k < 2; ++k) {
      s->halfEdge[2 * place + k] = mine.halfEdge[k];
      s->how[2 * place + k] = (uchar)mine.how[k];
    }
  }
}

OTG_INLINED void otgClearScratch(__local otg_solid_scratch* s, uint bad) {
  const uint lane = get_local_id(0);
  for (uint i = lane; i < OTG_SOLID_SLOTS; i += OTG_GROUP) {
    s->vertexKey[i] = 0;
    s->vote[i] = 0;
    s->side[i] = OTG_SIDE_UNKNOWN;
  }
  for (uint i = lane; i < 2 * OTG_SOLID_HITS; i += OTG_GROUP) s->edgeKey[i] = 0;
  for (uint i = lane; i < OTG_CHORD_WORDS; i += OTG_GROUP) s->chordBits[i] = 0;
  for (uint i = lane; i < OTG_SOLID_HITS + OTG_SOLID_SLOTS; i += OTG_GROUP) s->parent[i] = i;
  for (uint i = lane; i < 2 * OTG_SOLID_MOST_PARTS / 32; i += OTG_GROUP) s->crossedParts[i % 2][i / 2] = 0;
  if (lane == 0) {
    s->bad = bad;
    s->tied = 0;
    s->entered = 0;
    s->queued = 0;
    s->crossings = 0;
    s->chords = 0;
    s->regions = 0;
  }
  OTG_SYNC;
}

/// Whether a closed component of `inner` that has no chord may be contained in `outer`, a solid: where all its samples
/// are in the bounds of that.
OTG_INLINED void otgCheckContained(__local otg_solid_scratch* s, OTG_MESH* inner, OTG_MESH* outer, int works) {
  const uint lane = get_local_id(0);
  const uint parts = works && (outer->flags & OTG_MESH_CLOSED) ? as_uint(inner->bounds[OTG_SOLID_PART_COUNT].w) : 0;
  __global const float4* list = inner->bounds + as_uint(inner->bounds[OTG_SOLID_PARTS_AT].w);
  for (uint part = 0; part < parts; ++part, list += OTG_SOLID_SAMPLES) {
    const uint samples = otgIsCrossed(s, inner, part) ? 0 : as_uint(list[0].w);
    if (lane == 0) s->items = 0;
    OTG_SYNC;
    for (uint i = lane; i < samples; i += OTG_GROUP) {
      const float4 p = list[i];
      if (otgInBounds(outer, otgInFrame(inner, otgVec_d((double)p.x, (double)p.y, (double)p.z)))) {
        atomic_inc(&s->items);
      }
    }
    OTG_SYNC;
    if (lane == 0 && samples > 0 && s->items == samples) otgGiveUp(s, OTG_SOLID_CONTAINED);
    OTG_SYNC;
  }
}

/// `units` of the arena for the work-group: its first unit, or OTG_NOT_THERE if there is no room.
OTG_INLINED uint otgTakeArena(__local otg_solid_scratch* s, uint units, __global uint* counters, uint arenaUnits) {
  OTG_SYNC;
  if (get_local_id(0) == 0) s->allocated = units > 0 ? atomic_add(counters + OTG_COUNT_ARENA, units) : 0;
  OTG_SYNC;
  const uint begin = s->allocated;
  OTG_SYNC;
  return begin <= arenaUnits && arenaUnits - begin >= units ? begin : OTG_NOT_THERE;
}

/// Adds a term of each lane to the sums of vector areas of A and B, areas, and moment: in the order of the lanes, each
/// sum by one of them. `what`: 1 for a piece of A, 2 of B, 0 for none. All lanes call it.
OTG_INLINED void otgAddInOrder(__local otg_solid_scratch* s, uint what, otg_vec3_d vector, double area, double moment) {
  const uint lane = get_local_id(0);
  OTG_SYNC;
  OTG_COUNTS(s)[lane] = what;
  s->reduce[lane] = vector.x;
  s->reduce[OTG_GROUP + lane] = vector.y;
  s->reduce[2 * OTG_GROUP + lane] = vector.z;
  s->reduce[3 * OTG_GROUP + lane] = area;
  s->reduce[4 * OTG_GROUP + lane] = moment;
  OTG_SYNC;
  for (uint k = lane; k < 9; k += OTG_GROUP) {
    __local const double* terms = s->reduce + (k < 6 ? k % 3 : k < 8 ? 3 : 4) * OTG_GROUP;
    const uint wanted = k < 3 ? 1 : k < 6 ? 2 : k < 8 ? k - 5 : 0;
    double sum = s->sums[k];
    for (uint l = 0; l < OTG_GROUP; ++l) {
      const uint there = OTG_COUNTS(s)[l];
      const double more = sum + terms[l];
      sum = there != 0 && (wanted == 0 || there == wanted) ? more : sum;
    }
    s->sums[k] = sum;
  }
}

/// More points or pieces than these are for the kernel with the larger limits.
typedef struct {
  uint points, faces;
} otg_solid_limits;

/// Surface and points of one region into the arena. `head`: the last region; `size`: the points of the largest, or
/// OTG_NOT_THERE if one is large.
OTG_INLINED void otgDescribeRegion(const otg_solid_pair* pair, uint region, __global uchar* arena, uint arenaUnits,
                                   __global uint* counters, uint* head, uint works, otg_solid_limits limits,
                                   uint* size) {
  __local otg_solid_scratch* s = pair->s;
  const uint lane = get_local_id(0), chords = works ? s->chords : 0, crossings = works ? s->crossings : 0;
  const uint vertices = works ? s->queued : 0;
  uint total, pieces = 0, points = 0;
  for (uint k = lane; k < 9; k += OTG_GROUP) s->sums[k] = 0;
  OTG_SYNC;
  // Room for as many as there may be, and for one more point: see otgAddPass.
  uint most = 0, mostPoints = 0;
  for (uint c = lane; c < chords; c += OTG_GROUP) most += (s->firsts[c] & 1) + (s->firsts[c] >> 1);
  for (uint i = lane; i < vertices; i += OTG_GROUP) {
    if (otgRegionOf(pair, OTG_SOLID_HITS + s->inside[i]) != region) continue;
    const uint key = s->vertexKey[s->inside[i]] - 1;
    __global const uint* first = ((key & 1) ? pair->b->firstSpoke : pair->a->firstSpoke) + (key >> 1);
    most += first[1] - first[0];
    ++mostPoints;
  }
  for (uint c = lane; c < crossings; c += OTG_GROUP) mostPoints += 3;
  otgPlaceAmong(OTG_COUNTS(s), most, &total);
  const uint pieceUnits = total * (sizeof(otg_solid_piece) / OTG_ARENA_UNIT);
  otgPlaceAmong(OTG_COUNTS(s), mostPoints, &total);
  const uint pointUnits = (total + 1) * (sizeof(otg_solid_point) / OTG_ARENA_UNIT);
  const uint headUnits = works ? sizeof(otg_solid_region) / OTG_ARENA_UNIT : 0;
  const uint begin = otgTakeArena(s, headUnits + pieceUnits + pointUnits, counters, arenaUnits);
  const int room = works && begin != OTG_NOT_THERE;
  __global otg_solid_region* out = (__global otg_solid_region*)(arena + (size_t)begin * OTG_ARENA_UNIT * room);
  __global otg_solid_piece* pieceList = (__global otg_solid_piece*)(out + 1);
  __global otg_solid_point* pointList =
      (__global otg_solid_point*)((__global uchar*)pieceList + (size_t)pieceUnits * OTG_ARENA_UNIT);
  for (uint base = 0; base < 2 * chords; base += OTG_GROUP) {
    const uint item = base + lane, mesh = item >= chords, c = mesh ? item - chords : item;
    otg_outline loop;
    otg_vec3_d normal = otgVec_d(0, 0, 0);
    double area = 0;
    loop.corner = normal;
    uint triangle = 0;
    OTG_MESH* m = mesh ? pair->b : pair->a;
    if (item < 2 * chords && (s->firsts[c] >> mesh & 1)) {
      triangle = mesh ? s->b[s->hit[c]] : s->a[s->hit[c]];
      area = otgClip(pair, m, triangle, region, &loop, &normal);
    }
    const int isPiece = area > 0;  // else nothing, or a sliver turned over
    const uint place = pieces + otgPlaceAmong(OTG_COUNTS(s), isPiece, &total);
    pieces += total;
    if (isPiece && room) {
      otgWritePiece(pieceList + place, mesh, triangle, normal, area, otgDot_d(normal, loop.corner), loop.lo, loop.hi);
    }
    otgAddInOrder(s, isPiece ? 1 + mesh : 0, otgScale_d(normal, area), area, otgDot_d(normal, loop.corner) * area);
  }
  const uint boundary = pieces;
  for (uint base = 0; base < vertices; base += OTG_GROUP) {
    const uint i = base + lane;
    const int isMine = i < vertices && otgRegionOf(pair, OTG_SOLID_HITS + s->inside[i]) == region;
    const ulong interior = isMine ? otgInteriorAt(pair, s->inside[i]) : 0;
    uint count = 0;
    for (ulong rest = interior; rest != 0; rest &= rest - 1) ++count;
    const uint place = pieces + otgPlaceAmong(OTG_COUNTS(s), count, &total);
    pieces += total;
    if (count > 0 && room) otgWriteInterior(pair, s->inside[i], interior, pieceList + place);
    const uint point = points + otgPlaceAmong(OTG_COUNTS(s), isMine, &total);
    points += total;
    if (isMine && room) otgWriteVertexPoint(pair, s->inside[i], pointList + point);
  }
  uint load = points;
  for (uint base = 0; base < crossings; base += OTG_GROUP) {
    const uint i = base + lane;
    const uint count = i < crossings ? otgStretchPoints(pair, s->order[i], region, 0) : 0;
    const uint place = points + otgPlaceAmong(OTG_COUNTS(s), count, &total);
    points += total;
    if (count > 0 && room) otgStretchPoints(pair, s->order[i], region, pointList + place);
  }
  for (uint base = 0; base < chords; base += OTG_GROUP) {
    const uint c = base + lane;
    otgPlaceAmong(OTG_COUNTS(s), c < chords && otgRegionOf(pair, s->start[c]) == region, &total);
    load += total;
  }
  OTG_SYNC_ALL;
  if (!room) {
    pieces = 0;
    points = 0;
  }
  if (load > OTG_SOLID_LARGE_REGION && lane == 0) otgGiveUp(s, OTG_SOLID_ODD | OTG_SOLID_BY_CELLS);
  // Bounds: every crossing and every vertex is among the points.
  otg_vec3_d lo = otgVec_d(INFINITY, INFINITY, INFINITY), hi = otgVec_d(-INFINITY, -INFINITY, -INFINITY);
  for (uint i = lane; i < points; i += OTG_GROUP) {
    const otg_vec3_d p = otgLoad(pointList[i].position);
    lo = otgLower(lo, p);
    hi = otgHigher(hi, p);
  }
  s->reduce[lane] = lo.x;
  s->reduce[OTG_GROUP + lane] = lo.y;
  s->reduce[2 * OTG_GROUP + lane] = lo.z;
  s->reduce[3 * OTG_GROUP + lane] = hi.x;
  s->reduce[4 * OTG_GROUP + lane] = hi.y;
  s->reduce[5 * OTG_GROUP + lane] = hi.z;
  OTG_SYNC;
  for (uint i = lane; i < 6; i += OTG_GROUP) {
    double x = s->reduce[i * OTG_GROUP];
    for (uint k = 1; k < OTG_GROUP; ++k) {
      const double y = s->reduce[i * OTG_GROUP + k];
      x = i < 3 ? (y < x ? y : x) : (x < y ? y : x);
    }
    s->bound[i] = x;
  }
  // The sums of what is wholly inside follow.
  for (uint base = boundary; base < pieces; base += OTG_GROUP) {
    const uint i = base + lane;
    __global const otg_solid_piece* p = pieceList + i;
    const int isPiece = i < pieces;
    otgAddInOrder(s, isPiece ? 1 + p->mesh : 0, isPiece ? otgLoad(p->vector) : otgVec_d(0, 0, 0), isPiece ? p->area : 0,
                  isPiece ? p->offset * p->area : 0);
  }
  const int isLarge = points > limits.points || pieces > limits.faces;
  OTG_SYNC;
  if (lane == 0 && room) {
    lo = otgVec_d(s->bound[0], s->bound[1], s->bound[2]);
    hi = otgVec_d(s->bound[3], s->bound[4], s->bound[5]);
    const otg_vec3_d a = otgVec_d(s->sums[0], s->sums[1], s->sums[2]), b = otgVec_d(s->sums[3], s->sums[4], s->sums[5]);
    const otg_region_measure_d measure = otgMeasureRegion_d(a, b, s->sums[6], s->sums[7], s->sums[8], lo, hi);
    if (measure.bad || measure.coherence < OTG_SOLID_COHERENT) otgGiveUp(s, OTG_SOLID_ODD);
    otgStore(out->origin, pair->origin);
    otgStore(out->lo, lo);
    otgStore(out->hi, hi);
    otgStore(out->push, measure.push);
    out->areaA = s->sums[6];
    out->areaB = s->sums[7];
    out->diagonal = measure.diagonal;
    out->thickness = measure.thickness;
    out->coherence = measure.coherence;
    out->pieces = begin + headUnits;
    out->pieceCount = pieces;
    out->points = begin + headUnits + pieceUnits;
    out->pointCount = points;
    out->next = *head;
    *size = max(*size, isLarge ? OTG_NOT_THERE : points);
  }
  if (room) *head = begin;
  OTG_SYNC_ALL;
}

/// Finds the regions of one pair. `heads`: the last region of each pair; they are linked backwards.
OTG_INLINED void otgRegionsOf(uint number, __local otg_solid_scratch* s, OTG_MESH* a, OTG_MESH* b,
                              __global const otg_pair_state* state, __global const otg_solid_hit* sorted,
                              uint hitCapacity, __global uint* counters, __global uchar* arena, uint arenaUnits,
                              __global uint* heads, __global uint* lists, uint pairs, otg_solid_limits limits,
                              __global uint* chosen) {
  const uint lane = get_local_id(0);
  __global uint* flag = chosen + OTG_FLAGS + number;
  const int settled = (*flag & (OTG_PAIR_LEFT_OUT | OTG_PAIR_PAIRWISE)) != 0;  // by the kernel before
  const uint found = settled ? 0 : state->intersecting, begin = state->roots;
  const int fits = found <= OTG_SOLID_HITS && begin + found <= hitCapacity;
  const uint hits = fits ? found : 0;
  otgClearScratch(s, fits ? 0 : OTG_SOLID_TOO_MANY | OTG_SOLID_BY_CELLS);
  otgSortHits(s, sorted + begin, hits);
  OTG_SYNC;
  otgTraceContour(s, hits, a, b);
  const int isOpen = ((a->flags | b->flags) & OTG_MESH_SHEET) && s->bad == OTG_SOLID_BROKEN;
  const int mayContain = !settled && !s->bad;
  otgCheckContained(s, a, b, mayContain);
  otgCheckContained(s, b, a, mayContain);
  otgFloodInside(s, a, b);
  otgUniteRegions(s, a, b);
  otg_solid_pair pair;
  pair.s = s;
  pair.a = a;
  pair.b = b;
  pair.origin = s->crossings > 0 ? otgVec_d(s->x[0], s->y[0], s->z[0]) : otgVec_d(0, 0, 0);
  uint head = OTG_NOT_THERE, size = 0;
  const uint regions = s->bad ? 0 : s->regions;
  OTG_SYNC_ALL;
  for (uint r = 0; r < regions; ++r) {
    otgDescribeRegion(&pair, r, arena, arenaUnits, counters, &head, 1, limits, &size);
  }
  if (lane != 0) return;
  heads[number] = head;
  if (settled || s->bad) {
    if (isOpen || (*flag & OTG_PAIR_PAIRWISE)) {
      *flag |= otgPairwiseFlags(state, *flag);
    } else if (!settled) {
      // Where a sheet is at odds its contour may not close, and it is not described.
      const int isSheet = ((a->flags | b->flags) & OTG_MESH_SHEET) != 0;
      uint bad = s->bad;
      if (!isSheet && (bad & OTG_SOLID_BROKEN) && found >= OTG_SOLID_ODD_HITS) bad |= OTG_SOLID_AT_ODDS;
      *flag |= OTG_PAIR_TO_HOST | bad << OTG_PAIR_WHY;
    }
    if (*flag & OTG_PAIR_LEFT_OUT) atomic_inc(counters + OTG_COUNT_FLAGGED);
  } else if (head == OTG_NOT_THERE) {
    atomic_add(counters + OTG_COUNT_INTERSECTING, found);
  } else {
    const uint part = limits.points / (OTG_SOLID_BINS - OTG_SOLID_LARGE_BINS) + 1;
    otgList(counters, lists, pairs, 1, size == OTG_NOT_THERE ? 1 : OTG_SOLID_BINS - 1 - size / part, number);
  }
}

/// Finds the regions of the pairs in the lists `first` to `end`, a work-group for each pair or for several.
__kernel __attribute__((reqd_work_group_size(OTG_GROUP, 1, 1))) void solidRegions(
    __global const float4* restrict meshes, __global const otg_batch_task* restrict tasks,
    __global const otg_device_mesh* restrict places, __global const otg_pair_state* restrict states,
    __global const otg_solid_hit* restrict sorted, uint hitCapacity, __global uint* restrict counters,
    __global uchar* arena, uint arenaUnits, __global uint* heads, __global uint* restrict lists, uint pairs, uint first,
    uint end, uint mostPoints, uint mostFaces, __global uint* restrict chosen) {
  __local otg_solid_scratch scratch;
  __local otg_solid_mesh mesh[2];
  otg_solid_limits limits;
  limits.points = mostPoints;
  limits.faces = mostFaces;
  for (uint item = get_group_id(0);; item += get_num_groups(0)) {
    const uint number = otgListed(counters, lists, pairs, 0, first, end, item);
    if (number == OTG_NOT_THERE) return;
    otgTakeMeshes(mesh, meshes, tasks + number, places);
    otgRegionsOf(number, &scratch, mesh, mesh + 1, states + number, sorted, hitCapacity, counters, arena, arenaUnits,
                 heads, lists, pairs, limits, chosen);
    OTG_SYNC;
  }
}
