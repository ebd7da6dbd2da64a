// SPDX-License-Identifier: BSD-3-Clause
// Pairs of solids: from hits to crossings and chords, in any order, and the sets that these are of.
#define OTG_CONTACTS 0
#include "pairwise/pair_record.h"
//
#include "solid/large/mesh.h"
#include "solid/ends.h"

/// The slot of a crossing, and whether it is new. There are more slots than there can be crossings.
OTG_INLINED uint otgEnterCrossing(OTG_OVERLAP* o, ulong key, int* isNew) {
  uint hash = (uint)(key >> 32) * 0x9e3779b1u ^ (uint)key * 0x85ebca6bu;
  hash ^= hash >> 15;
  hash *= 0x2c1b3c6du;
  for (uint slot = (hash ^ hash >> 13) & (o->sizes.slots - 1);; slot = (slot + 1) & (o->sizes.slots - 1)) {
    const ulong before = atom_cmpxchg(&o->crossings[slot].key, 0ul, key);
    *isNew = before == 0;
    if (before == 0 || before == key) return slot;
  }
}

/// Works a new crossing out: as Tracer::add in collide/solid/contour.cpp.
OTG_INLINED void otgFillCrossing(OTG_OVERLAP* o, uint slot, uint halfEdge, uint other, uint mesh, uint how) {
  OTG_MESH *mine = &o->mesh[mesh].solid, *theirs = &o->mesh[1 - mesh].solid;
  __global otg_crossing* c = o->crossings + slot;
  const uint edge = otgEdgeOf(mine, halfEdge);
  const uint4 ends = mine->edges[edge];
  const int forward = otgCornerOf(mine, halfEdge) == ends.x;
  const otg_vec3_d p = otgVertexAt(mine, ends.x), q = otgVertexAt(mine, ends.y);
  otg_vec3_d corners[3], drift;
  otgCornersAt(theirs, other, corners);
  const double t = otgHitPlane_d((int)mesh, p, q, corners, &drift);
  c->t = t;
  c->triangle = other;
  otgStore(c->point, otgAdd_d(p, otgScale_d(otgSub_d(q, p), t)));
  for (uint k = 0; k < 3; ++k) {
    c->low[k] = ~0ul;
    c->high[k] = 0;
  }
  c->first = ~0ul;
  c->largest = 0;
  c->load = 0;
  c->chord = OTG_NOT_THERE;
  c->table = 0;
  c->exits = (how & 1) == (uint)forward;
  c->link = atomic_xchg(otgEdgeMark(o, mesh, edge), slot + 1);
}

/// What a lane has entered.
typedef struct {
  uint intersecting, chords;
  ulong first;  ///< triangles of the smallest chord, inverted
} otg_entered;

/// Adds up what lanes have entered. All lanes call it. `sums`: room for two.
OTG_INLINED void otgCountEntered(const otg_entered* e, __local uint* sums, __global otg_overlap_state* state) {
  const uint lane = get_local_id(0);
  if (lane < 2) sums[lane] = 0;
  barrier(CLK_LOCAL_MEM_FENCE);
  if (e->intersecting) atomic_add(sums, e->intersecting);
  if (e->chords) atomic_add(sums + 1, e->chords);
  if (e->first) otgRaise(&state->first, e->first);
  barrier(CLK_LOCAL_MEM_FENCE);
  if (lane == 0 && sums[0]) atomic_add(state->counts + OTG_OVERLAP_INTERSECTING, sums[0]);
  if (lane == 0 && sums[1]) atomic_add(state->counts + OTG_OVERLAP_CHORDS, sums[1]);
}

/// Notes that the closed component of a triangle, if it is in one, has a chord.
OTG_INLINED void otgMarkPart(OTG_MESH* m, uint triangle, __global uint* parts) {
  if (m->flags & OTG_MESH_SOLID) return;  // it is the only one
  const uint part = m->triangles[4 * (size_t)triangle].w;
  if (part == OTG_NOT_THERE) return;
  volatile __global uint* word = parts + part / 32;
  if (!(*word >> part % 32 & 1)) atomic_or(word, 1u << part % 32);
}

/// Enters the ends of the chord of hit `i` as crossings; `why` as otgFindEnds.
OTG_INLINED void otgEnterHit(OTG_OVERLAP* o, uint i, const otg_solid_hit* ends, uint why,
                             __global otg_overlap_state* state, otg_entered* entered) {
  otg_overlap_hit own;
  own.a = ends->a;
  own.b = ends->b;
  own.start = own.end = OTG_NOT_THERE;
  own.link[0] = own.link[1] = 0;
  if (why != 0) otgGiveUpOverlap(state, why | otgIsOpen(o, why));
  ++entered->intersecting;
  if (why == 0 && ends->halfEdge[1] != OTG_NOT_THERE) {
    for (uint k = 0; k < 2; ++k) {
      const uint mesh = ends->halfEdge[k] & 1, halfEdge = ends->halfEdge[k] >> 1;
      const uint other = mesh == 0 ? ends->b : ends->a, edge = otgEdgeOf(&o->mesh[mesh].solid, halfEdge);
      int isNew;
      const uint slot = otgEnterCrossing(o, (ulong)((edge << 1 | mesh) + 1) << 32 | other, &isNew);
      if (isNew) {
        otgFillCrossing(o, slot, halfEdge, other, mesh, ends->how[k]);
        o->slots[atomic_inc(state->counts + OTG_OVERLAP_CROSSINGS)] = slot;
      }
      atomic_inc(&o->crossings[slot].seen);
      if (ends->how[k] & 2) {
        own.start = slot;
      } else {
        own.end = slot;
      }
    }
    ++entered->chords;
    entered->first = max(entered->first, ~((ulong)ends->a << 32 | ends->b));
    otgMarkPart(&o->mesh[0].solid, ends->a, state->crossedParts[0]);
    otgMarkPart(&o->mesh[1].solid, ends->b, state->crossedParts[1]);
  }
  o->hits[i] = own;
}

/// Every element becomes a set of its own, without votes.
OTG_INLINED void otgBeginSets(OTG_OVERLAP* o) {
  for (uint e = get_global_id(0); e < o->sizes.elements; e += get_global_size(0)) {
    o->parents[e] = e;
    if (e >= o->sizes.slots) o->balances[e - o->sizes.slots] = 0;
  }
}

/// One pair alone, `single`: decides every hit, finds the ends of its chord, and enters these as crossings. Writes the
/// record of each hit, from which the CPU finishes the pair if need be, and the table of the one pair.
__kernel __attribute__((reqd_work_group_size(OTG_GROUP, 1, 1))) void overlapContour(
    const otg_overlap_pair single, __global const float4* restrict meshes, __global const uint* restrict counters,
    __global const uint2* restrict found, uint hitCapacity, __global uchar* restrict results,
    __global otg_overlap_pair* restrict pairs, __global otg_overlap_state* restrict state,
    __global otg_crossing* restrict crossings, __global uint* restrict slots, __global otg_overlap_hit* restrict hits,
    __global uint* restrict parents, __global uint* restrict marks, __global int* restrict balances) {
  __local otg_overlap o;
  __local uint sums[2];
  otg_entered entered = {0, 0, 0};
  const uint lane = get_local_id(0), count = min(counters[OTG_COUNT_HITS], hitCapacity);
  if (lane < 2) {
    otgSetOverlap(&o, lane, meshes, &single, otgArrays(crossings, slots, hits, parents, marks, balances, 0, 0));
  }
  barrier(CLK_LOCAL_MEM_FENCE);
  if (get_global_id(0) == 0) {
    pairs[0] = single;
    pairs[0].hits = count;
  }
  const uint placeA = o.mesh[0].solid.soup, placeB = o.mesh[1].solid.soup;
  const otg_transform_d bInA = o.mesh[1].solid.pose;
  __global otg_record* records = (__global otg_record*)(results + OTG_RESULT_HEAD);
  for (uint i = get_global_id(0); i < count; i += get_global_size(0)) {
    const uint2 hit = found[i];
    const uint soupA = placeA + 3 * (hit.x & ~OTG_HIT_UNDECIDED), soupB = placeB + 3 * hit.y;
    otgMakeRecord(meshes, soupA, soupB, (hit.x & OTG_HIT_UNDECIDED) != 0, bInA, 0, records + i);
    otg_solid_hit ends;
    ends.a = records[i].a;
    ends.b = records[i].b;
    int kind = records[i].kind;
    if (kind == OTG_RECORD_OPEN) {
      otg_vec3_d corners[6];
      otgCornersInDouble(meshes, soupA, soupB, bInA, corners, corners + 3);
      kind = otgDecideExactly(corners);
      records[i].kind = kind;
    }
    if (kind == OTG_RECORD_HIT) {
      const uint why = otgFindEnds(&o.mesh[0].solid, &o.mesh[1].solid, &ends);
      otgEnterHit(&o, i, &ends, why, state, &entered);
    } else {
      if (kind == OTG_RECORD_OPEN) otgGiveUpOverlap(state, OTG_SOLID_INEXACT);
      o.hits[i].a = OTG_NOT_THERE;
    }
  }
  otgCountEntered(&entered, sums, state);
  otgBeginSets(&o);
}

/// Pairs of a batch: the table of those that are listed in `tasks`.
__kernel __attribute__((reqd_work_group_size(OTG_GROUP, 1, 1))) void overlapTake(
    uint count, __global const otg_listed_overlap* restrict tasks, __global const otg_batch_task* restrict batch,
    __global const otg_device_mesh* restrict places, __global const float4* restrict meshes,
    __global const otg_pair_state* restrict states, __global otg_overlap_pair* restrict pairs) {
  const uint i = get_global_id(0);
  if (i >= count) return;
  const otg_listed_overlap task = tasks[i];
  otg_overlap_pair pair;
  otg_overlap_counts counts[2];
  pair.bInA = batch[task.number].bInA;
  pair.mesh[0] = places[batch[task.number].meshA];
  pair.mesh[1] = places[batch[task.number].meshB];
  for (uint k = 0; k < 2; ++k) {
    __global const float4* bounds = meshes + pair.mesh[k].rings + pair.mesh[k].triangles;
    counts[k].clusters = as_uint(bounds[OTG_SOLID_CLUSTER_COUNT].w);
    counts[k].vertices = as_uint(bounds[0].w);
    counts[k].edges = as_uint(bounds[1].w);
    counts[k].triangles = pair.mesh[k].triangles;
  }
  pair.sizes = otgOverlapSizes(otgSlotsFor(task.hits), counts[0], counts[1]);
  pair.number = task.number;
  pair.hits = task.hits;
  pair.firstHit = states[task.number].roots;
  pair.firstSlot = task.firstSlot;
  pair.firstInside = task.firstInside;
  pair.firstElement = task.firstSlot + task.firstInside;
  pair.firstMark = task.firstMark;
  pair.unused = 0;
  pairs[i] = pair;
}

/// Pairs of a batch: enters the ends of the chords that solidScatter found as crossings.
__kernel __attribute__((reqd_work_group_size(OTG_GROUP, 1, 1))) void overlapEnter(
    __global const otg_overlap_pair* restrict pairs, __global const float4* restrict meshes,
    __global const otg_solid_hit* restrict found, __global otg_overlap_state* restrict states,
    __global otg_crossing* restrict crossings, __global uint* restrict slots, __global otg_overlap_hit* restrict hits,
    __global uint* restrict parents, __global uint* restrict marks, __global int* restrict balances) {
  __local otg_overlap o;
  __local uint sums[2];
  otg_entered entered = {0, 0, 0};
  otgTakePair(&o, meshes, pairs, otgArrays(crossings, slots, hits, parents, marks, balances, 0, 0));
  __global const otg_solid_hit* own = found + pairs[get_group_id(1)].firstHit;
  for (uint i = get_global_id(0); i < o.hitCount; i += get_global_size(0)) {
    const otg_solid_hit ends = own[i];
    otgEnterHit(&o, i, &ends, 0, states + get_group_id(1), &entered);
  }
  otgCountEntered(&entered, sums, states + get_group_id(1));
  otgBeginSets(&o);
}

/// Marks and lists the cluster of a vertex as one with a crossed edge. The list lies where what is inside will be
/// listed.
OTG_INLINED void otgMix(OTG_OVERLAP* o, uint mesh, uint vertex, __global otg_overlap_state* state) {
  const uint cluster = otgClusterOf(&o->mesh[mesh], vertex);
  if (cluster >= o->mesh[mesh].clusterCount) return;
  __global uint* mark = otgMixedMark(o, mesh, cluster);
  if (*mark != 0) return;  // unordered
  if (atomic_xchg(mark, 1) != 0) return;
  o->clusters[atomic_inc(state->counts + OTG_OVERLAP_MIXED)].what = cluster << 1 | mesh;
}

/// Where a crossing lies along its edge. Those at the same place go by triangle, until overlapUnite puts them in order.
OTG_INLINED uint otgPlaceCrossing(OTG_OVERLAP* o, uint slot, __global otg_overlap_state* state) {
  __global otg_crossing* c = o->crossings + slot;
  const uint mesh = otgMeshOf(c), edge = otgEdgeOfCrossing(c), triangle = c->triangle;
  const double t = c->t;
  uint rank = 0, previous = OTG_NOT_THERE, next = OTG_NOT_THERE, triangleBefore = 0, triangleAfter = 0;
  double before = 0, after = 0;
  for (uint d = *otgEdgeMark(o, mesh, edge); d != 0; d = o->crossings[d - 1].link) {
    if (d - 1 == slot) continue;
    const double u = o->crossings[d - 1].t;
    const uint other = o->crossings[d - 1].triangle;
    if (u < t || (u == t && other < triangle)) {
      ++rank;
      if (previous == OTG_NOT_THERE || u > before || (u == before && other > triangleBefore)) {
        previous = d - 1;
        before = u;
        triangleBefore = other;
      }
    } else if (next == OTG_NOT_THERE || u < after || (u == after && other < triangleAfter)) {
      next = d - 1;
      after = u;
      triangleAfter = other;
    }
  }
  c->rank = rank;
  c->previous = previous;
  c->next = next;
  c->stretch = OTG_NOT_THERE;
  const uint4 ends = o->mesh[mesh].solid.edges[edge];
  if (previous == OTG_NOT_THERE) otgMix(o, mesh, ends.x, state);
  if (next == OTG_NOT_THERE) otgMix(o, mesh, ends.y, state);
  return (t == t ? 0 : OTG_SOLID_TIE) |
         (c->seen == 2 ? 0 : OTG_SOLID_BROKEN);  // a place that is no number has no order
}

/// Unites the ends of a chord, and has its start name it.
OTG_INLINED void otgTakeChord(OTG_OVERLAP* o, uint number) {
  const otg_overlap_hit hit = o->hits[number];
  otgUniteElements(o, hit.start, hit.end);
  o->crossings[hit.start].chord = number;
}

/// Puts crossings in order along their edges, and hits in lists by triangle; unites what hangs together by chords.
__kernel __attribute__((reqd_work_group_size(OTG_GROUP, 1, 1))) void overlapEdges(
    __global const otg_overlap_pair* restrict pairs, __global const float4* restrict meshes,
    __global otg_overlap_state* restrict states, __global otg_crossing* restrict crossings, __global uint* slots,
    __global otg_overlap_hit* restrict hits, __global uint* restrict parents, __global uint* restrict marks,
    __global otg_found_inside* restrict inside) {
  __local otg_overlap o;
  __global otg_overlap_state* state = states + get_group_id(1);
  otgTakePair(&o, meshes, pairs, otgArrays(crossings, slots, hits, parents, marks, 0, inside, 0));
  const uint count = state->counts[OTG_OVERLAP_CROSSINGS];
  for (uint i = get_global_id(0); i < count; i += get_global_size(0)) {
    const uint why = otgPlaceCrossing(&o, o.slots[i], state);
    if (why != 0) otgGiveUpOverlap(state, why | otgIsOpen(&o, why));
  }
  for (uint i = otgIdFromTheEnd(); i < o.hitCount; i += get_global_size(0)) {
    const otg_overlap_hit hit = o.hits[i];
    if (hit.a == OTG_NOT_THERE || hit.start == OTG_NOT_THERE) continue;
    otgTakeChord(&o, i);
    for (uint mesh = 0; mesh < 2; ++mesh) {
      o.hits[i].link[mesh] = atomic_xchg(otgTriangleMark(&o, mesh, mesh == 0 ? hit.a : hit.b), i + 1);
    }
  }
}
