// SPDX-License-Identifier: BSD-3-Clause
// Contacts of the regions whose candidates solidEstimate has looked at: one work-group for one pair. OTG_GROUP: size of
// work-groups; OTG_SOLID_CONTACTS, _POINTS and _LARGE as in solid/choose.h.
#define OTG_MESHES_LOCAL
#include "pairwise/pair_record.h"
//
#include "solid/choose.h"
#include "solid/small/limit.h"

/// Whether contacts do not contradict each other because their normals are much alike: as in
/// collide/consistent_contacts.cpp, with a margin for what rounds.
OTG_INLINED int otgAgreePlainly(__global const otg_chosen_contact* contacts, uint count) {
  otg_vec3_d sum = otgVec_d(0, 0, 0);
  for (uint i = 0; i < count; ++i) sum = otgAdd_d(sum, otgLoad(contacts[i].normal));
  const double least = sqrt(otgDot_d(sum, sum)) / OTG_UNEVEN_LONGEST * (1 + 1e-9);
  int agree = least > 0;
  for (uint i = 0; i < count && agree; ++i) agree = otgDot_d(otgLoad(contacts[i].normal), sum) >= least;
  return agree;
}

/// From how many contacts `stay` are chosen. None where some would go of contacts that may contradict each other: the
/// CPU has to see all of them. All lanes call it.
OTG_INLINED uint otgToChooseFrom(__local otg_solid_choice* s, __global const otg_chosen_contact* found, uint stay) {
  if (get_local_id(0) == 0 && !s->bad && s->contacts > stay) s->bad = !otgAgreePlainly(found, s->contacts);
  OTG_SYNC;
  return s->bad ? 0 : s->contacts;
}

/// The contacts of one pair: region by region, then as many as it has places. `direction`: null, or gets that of the
/// last deep region, or zero.
OTG_INLINED void otgContactsOf(uint number, __local otg_solid_choice* s, __global const float4* meshes, OTG_MESH* a,
                               OTG_MESH* b, __global const otg_batch_task* task, __global const otg_pair_state* states,
                               __global const otg_reduction* reductions, __global uint* counters, __global uchar* arena,
                               uint arenaUnits, uint head, __global otg_chosen_contact* list, uint room,
                               __global double* direction, uint pairs, __global uchar* results) {
  const uint lane = get_local_id(0);
  __global uint* flag = (__global uint*)(results + OTG_RESULT_HEAD) + number;
  const otg_reduction how = reductions[task->reduction];
  const uint most = min((uint)how.bins[0], (uint)OTG_SOLID_CONTACTS);
  uint chain[OTG_SOLID_REGIONS], regions = 0;
  // From the list, which runs backwards.
  for (uint at = head; at != OTG_NOT_THERE && regions < OTG_SOLID_REGIONS;) {
    chain[regions++] = at;
    at = ((__global const otg_solid_region*)(arena + (size_t)at * OTG_ARENA_UNIT))->next;
  }
  if (lane == 0) {
    s->bad = 0;
    s->contacts = 0;
    const uint units = (regions * most * (uint)sizeof(otg_chosen_contact) + OTG_ARENA_UNIT - 1) / OTG_ARENA_UNIT;
    s->allocated = units > 0 ? atomic_add(counters + OTG_COUNT_ARENA, units) : 0;
    if (!(s->allocated <= arenaUnits && arenaUnits - s->allocated >= units)) s->allocated = OTG_NOT_THERE;
  }
  OTG_SYNC;
  if (s->allocated == OTG_NOT_THERE) regions = 0;  // the host gives the arena more room and starts again
  __global otg_chosen_contact* found =
      (__global otg_chosen_contact*)(arena + (size_t)(regions > 0 ? s->allocated : 0) * OTG_ARENA_UNIT);
  if (lane == 0 && direction != 0) otgStore(direction, otgVec_d(0, 0, 0));
  OTG_SYNC;
  uint index = 0;
  for (uint r = regions; r-- > 0;) {
    const otg_solid_work w = otgGoOnWith(arena, chain[r]);
    const uint flags = w.region->flags;
    const int counts = (flags & OTG_REGION_COUNTS) != 0;
    if (lane == 0 && (flags & OTG_REGION_BAD)) s->bad = 1;
    if (lane == 0 && direction != 0 && counts && (flags & OTG_REGION_DEEP)) {
      otgStore(direction, w.isFixed ? w.fixed : w.mean);
    }
    otgTakeEstimates(s, &w);
    otgFilterAndMerge(s, &w);
    if (lane == 0 && counts && s->count == 0) s->bad = 1;
#if OTG_SOLID_LARGE
    otgMeasureGathered(s, &w, most, meshes, a, b);
#endif
    otgSpreadCandidates(s, &w, most);
    otgMeasure(s, &w, meshes, a, b, most);
    otgEmit(s, &w, index, found + s->contacts);
    if (lane == 0) s->contacts += s->count;
    index += counts;
    OTG_SYNC_ALL;
  }
  const uint stay = min(how.places, room), contacts = otgToChooseFrom(s, found, stay);
  const uint kept = otgLimitContacts(s, found, contacts, stay, a, b, list);
  if (lane != 0) return;
  ((__global uint*)results)[OTG_PLACE(pairs, number) + 1] = kept;
  if (s->bad) {
    *flag |= OTG_PAIR_TO_HOST | OTG_SOLID_TOO_MANY << OTG_PAIR_WHY;
    atomic_inc(counters + OTG_COUNT_FLAGGED);
  } else {
    atomic_add(counters + OTG_COUNT_INTERSECTING, states[number].intersecting);
    atomic_add(counters + OTG_COUNT_CONTACTS, contacts);
    atomic_add(counters + OTG_COUNT_REDUCED, kept);
  }
}

/// Contacts of the pairs in the lists `first` to `end` of those that have regions. `kept` gets `room` places for each
/// pair, in its callers' numbers of triangles; the counts of contacts go where placeContacts expects them. If pairs
/// `remember`, `directions` get the directions of their last deep regions, or zero.
__kernel __attribute__((reqd_work_group_size(OTG_GROUP, 1, 1))) void solidContacts(
    __global const float4* restrict meshes, __global const otg_batch_task* restrict tasks,
    __global const otg_device_mesh* restrict places, __global const otg_pair_state* restrict states,
    __global const otg_reduction* restrict reductions, __global uint* restrict counters, __global uchar* arena,
    uint arenaUnits, __global const uint* restrict heads, __global const uint* restrict lists, uint pairs, uint first,
    uint end, __global otg_chosen_contact* restrict kept, uint room, __global double* restrict directions,
    uint remembers, __global uchar* restrict results) {
  __local otg_solid_choice choice;
  __local otg_solid_mesh mesh[2];
  for (uint item = get_group_id(0);; item += get_num_groups(0)) {
    const uint number = otgListed(counters, lists, pairs, 1, first, end, item);
    if (number == OTG_NOT_THERE) return;
    otgTakeMeshes(mesh, meshes, tasks + number, places);
    otgContactsOf(number, &choice, meshes, mesh, mesh + 1, tasks + number, states, reductions, counters, arena,
                  arenaUnits, heads[number], kept + (size_t)number * room, room,
                  remembers ? directions + 3 * (size_t)number : 0, pairs, results);
    OTG_SYNC_ALL;
  }
}

/// The lists one after the other, in the places that placeContacts made. Records of pairs that are left to the CPU,
/// and whose hits lie side by side, are in a list of their own. The place of such a pair becomes its number of
/// intersecting pairs of triangles. The last kernel.
__kernel __attribute__((reqd_work_group_size(OTG_GROUP, 1, 1))) void solidWrite(
    __global uint* restrict counters, __global const otg_chosen_contact* restrict lists, uint room, uint pairs,
    __global uchar* results, uint contactRoom, __global const otg_pair_state* restrict states,
    __global const uchar* restrict records, uint hitCapacity, __global uchar* restrict left, uint leftRoom) {
  __local uint last, begin;
  __global uint* words = (__global uint*)results;
  __global otg_chosen_contact* out = (__global otg_chosen_contact*)(results + OTG_RESULT_CONTACTS(pairs));
  for (size_t t = get_global_id(0); t < (size_t)pairs * room; t += get_global_size(0)) {
    const uint pair = (uint)(t / room), k = (uint)(t % room);
    // Others are written by batchReduce, or have none; places of the latter are written over below.
    if (words[OTG_FLAGS + pair] & (OTG_PAIR_PAIRWISE | OTG_PAIR_TO_HOST)) continue;
    const uint place = words[OTG_PLACE(pairs, pair)] + k;
    if (k < words[OTG_PLACE(pairs, pair) + 1] && place < contactRoom) out[place] = lists[t];
  }
  __global const otg_record* from = (__global const otg_record*)(records + OTG_RESULT_HEAD);
  __global otg_record* to = (__global otg_record*)(left + OTG_RESULT_HEAD);
  for (uint pair = get_group_id(0); pair < pairs; pair += get_num_groups(0)) {
    const uint flags = words[OTG_FLAGS + pair], first = states[pair].firstHit;
    const int isLeft = (flags & (OTG_PAIR_TO_HOST | OTG_PAIR_NO_FRAME | OTG_PAIR_MANY)) == OTG_PAIR_TO_HOST;
    const uint hits = isLeft && first < hitCapacity ? min(states[pair].hits, hitCapacity - first) : 0;
    if (get_local_id(0) == 0 && (flags & OTG_PAIR_TO_HOST)) words[OTG_PLACE(pairs, pair)] = states[pair].intersecting;
    if (get_local_id(0) == 0 && hits > 0) begin = atomic_add(counters + OTG_COUNT_LEFT, hits);
    OTG_SYNC;
    for (uint k = get_local_id(0); k < hits; k += OTG_GROUP) {
      if (begin + k < leftRoom) to[begin + k] = from[first + k];
    }
    OTG_SYNC;
  }
  otgFinish(counters, results, &last);
}
