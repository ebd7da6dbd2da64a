// SPDX-License-Identifier: BSD-3-Clause
// The hits of a batch of solids, pair by pair. OTG_GROUP: size of work-groups; OTG_CONTACTS is 0.
#include "pairwise/pair_record.h"
//
#include "solid/ends.h"

/// Decides every hit, writes its record (for the CPU, should it have to finish the pair), and counts those of a pair.
__kernel __attribute__((reqd_work_group_size(OTG_GROUP, 1, 1))) void solidRecords(
    __global const otg_batch_pair* restrict pairs, __global const otg_device_mesh* restrict places,
    __global const otg_batch_task* restrict tasks, __global const float4* restrict meshes,
    __global uint* restrict counters, __global const otg_batch_hit* restrict hits, uint hitCapacity,
    __global uchar* restrict results, __global otg_pair_state* restrict states, __global uint* restrict chosen) {
  const uint count = min(counters[OTG_COUNT_HITS], hitCapacity);
  __global otg_record* records = (__global otg_record*)(results + OTG_RESULT_HEAD);
  for (uint i = get_global_id(0); i < count; i += get_global_size(0)) {
    const otg_batch_hit hit = hits[i];
    const uint soupA = places[pairs[hit.pair].meshA].soup, soupB = places[pairs[hit.pair].meshB].soup;
    otgMakeRecord(meshes, soupA + 3 * (hit.a & ~OTG_HIT_UNDECIDED), soupB + 3 * hit.b, (hit.a & OTG_HIT_UNDECIDED) != 0,
                  tasks[hit.pair].bInA, hit.pair, records + i);
    otgDecideRecord(meshes, soupA + 3 * (hit.a & ~OTG_HIT_UNDECIDED), soupB + 3 * hit.b, tasks[hit.pair].bInA, hit.pair,
                    records + i);
    if (records[i].kind == OTG_RECORD_OPEN) atomic_or(chosen + OTG_FLAGS + hit.pair, OTG_PAIR_TO_HOST);
    if (records[i].kind == OTG_RECORD_HIT) atomic_inc(&states[hit.pair].intersecting);
  }
}

/// A stretch of the list for each pair, and a place among those that solidRegions does: larger ones first, of more than
/// `smallHits` with larger limits. Pairs that are not of two solids, or of a solid and a sheet, get contacts of the
/// model `pairwise`.
__kernel __attribute__((reqd_work_group_size(OTG_GROUP, 1, 1))) void solidPlaces(
    uint pairs, __global const otg_batch_task* restrict tasks, __global const otg_device_mesh* restrict places,
    __global const otg_reduction* restrict reductions, __global uint* restrict counters,
    __global otg_pair_state* restrict states, __global uint* restrict lists, uint smallHits,
    __global uint* restrict chosen) {
  const uint i = get_global_id(0);
  if (i >= pairs) return;
  const uint a = places[tasks[i].meshA].flags, b = places[tasks[i].meshB].flags;
  const uint classes = OTG_MESH_CLOSED | OTG_MESH_SHEET;
  const int isEmpty = places[tasks[i].meshA].triangles == 0 || places[tasks[i].meshB].triangles == 0;
  const otg_reduction how = reductions[tasks[i].reduction];
  const int isAsked = how.method == OTG_REDUCE_SOLID;
  const int isSolid = isAsked && (a & classes) && (b & classes) && ((a | b) & OTG_MESH_CLOSED);
  states[i].reduction = isAsked ? (uint)how.bins[2] - 1 : tasks[i].reduction;  // of the model `pairwise`
  uint flags = chosen[OTG_FLAGS + i];
  if (isSolid && !(a & b & OTG_MESH_LISTED)) flags |= OTG_PAIR_TO_HOST;
  if (!isSolid && !isEmpty && !(flags & OTG_PAIR_LEFT_OUT)) flags |= otgPairwiseFlags(states + i, flags);
  chosen[OTG_FLAGS + i] = flags;
  const uint hits = states[i].intersecting;
  states[i].roots = atomic_add(counters + OTG_COUNT_PLACES, hits);
  chosen[OTG_PLACE(pairs, i) + 1] = 0;
  if (flags & OTG_PAIR_LEFT_OUT) {
    atomic_inc(counters + OTG_COUNT_FLAGGED);
  } else if (!isEmpty && isSolid) {
    const uint part = smallHits / (OTG_SOLID_BINS - OTG_SOLID_LARGE_BINS) + 1;
    const uint bin = hits > 2 * smallHits ? 0 : hits > smallHits ? 1 : OTG_SOLID_BINS - 1 - hits / part;
    otgList(counters, lists, pairs, 0, bin, i);
  }
}

/// The hits into the pairs' stretches, in any order, with the ends of their chords.
__kernel __attribute__((reqd_work_group_size(OTG_GROUP, 1, 1))) void solidScatter(
    __global const float4* restrict meshes, __global const otg_batch_task* restrict tasks,
    __global const otg_device_mesh* restrict places, __global const uint* restrict counters,
    __global const uchar* restrict results, uint hitCapacity, __global otg_pair_state* restrict states,
    __global otg_solid_hit* restrict list, __global uint* restrict chosen) {
  const uint count = min(counters[OTG_COUNT_HITS], hitCapacity);
  __global const otg_record* records = (__global const otg_record*)(results + OTG_RESULT_HEAD);
  for (uint i = get_global_id(0); i < count; i += get_global_size(0)) {
    const otg_record r = records[i];
    __global uint* flag = chosen + OTG_FLAGS + r.pair;
    if (r.kind != OTG_RECORD_HIT || (*flag & (OTG_PAIR_LEFT_OUT | OTG_PAIR_PAIRWISE))) continue;
    __global const otg_batch_task* task = tasks + r.pair;
    const otg_device_mesh placeA = places[task->meshA], placeB = places[task->meshB];
    const otg_solid_mesh a = otgSolidMesh(meshes, &placeA, task->bInA, 0);
    const otg_solid_mesh b = otgSolidMesh(meshes, &placeB, task->bInA, 1);
    otg_solid_hit hit;
    hit.a = r.a;
    hit.b = r.b;
    const uint why = otgFindEnds(&a, &b, &hit);
    // A sheet has contacts of the model `pairwise` where its contour with the other mesh does not close.
    const int isOpen = ((placeA.flags | placeB.flags) & OTG_MESH_SHEET) && why == OTG_SOLID_BROKEN;
    if (why != 0) atomic_or(flag, isOpen ? OTG_PAIR_PAIRWISE : OTG_PAIR_TO_HOST | why << OTG_PAIR_WHY);
    list[states[r.pair].roots + atomic_inc(&states[r.pair].kept)] = hit;
  }
}
