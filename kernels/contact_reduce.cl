// SPDX-License-Identifier: BSD-3-Clause
// From contacts to the few that the caller asked for: regions, bins, the limit. For one pair of meshes or for many at
// once: a hit knows its pair.
//
// OTG_GROUP: size of work-groups, a multiple of 4. OTG_KEPT as in contact_choose.h. OTG_CONTACTS is 1. OTG_SINGLE: 1
// for one pair (chooseContacts is the last kernel), 0 for a batch.
#include "contact_choose.h"

/// Four lanes to a hit unite it with its neighbours; the first also enters its contact into the table of bins.
__kernel __attribute__((reqd_work_group_size(OTG_GROUP, 1, 1))) void uniteContacts(
    __global const float4* restrict meshes, __global const uint* restrict counters, __global uchar* restrict records,
    __global uint* links, __global uint* tables, uint tableSize, uint capacity,
    __global const otg_pair_state* restrict states, __global const otg_reduction* restrict reductions,
    __global const uint* restrict results) {
  const otg_links l = otgLinksOf(counters, records, links, tables, tableSize, capacity);
  const uint count = min(counters[OTG_COUNT_HITS], capacity);
  for (uint t = get_global_id(0); t < 4 * count; t += get_global_size(0)) {
    const uint hit = t / 4, share = t % 4;
    const int kind = l.records[hit].kind;
    const uint pair = l.records[hit].pair;
    if (!otgIntersects(kind) || (results[OTG_FLAGS + pair] & OTG_PAIR_TO_HOST)) continue;
    __global const otg_pair_state* state = states + pair;
    otgUniteShare(&l, (__global const uint*)(meshes + state->ringsA), (__global const uint*)(meshes + state->ringsB),
                  hit, share);
    if (share == 0 && otgIsContact(kind)) {
      const otg_reduction how = reductions[state->reduction];
      if (how.method == OTG_REDUCE_BINNING) otgEnterBin(&l, state, &how, hit);
    }
  }
}

/// Lists the contacts that stay (the best of their bins, or all) and the regions that have contacts, OTG_KEPT places a
/// pair for each, and empties the tables.
__kernel __attribute__((reqd_work_group_size(OTG_GROUP, 1, 1))) void selectContacts(
    __global const uint* restrict counters, __global uchar* restrict records, __global uint* links,
    __global uint* tables, uint tableSize, uint capacity, __global otg_pair_state* restrict states,
    __global const otg_reduction* restrict reductions, __global const uint* restrict results,
    __global uint* restrict kept, __global uint* restrict roots) {
  const otg_links l = otgLinksOf(counters, records, links, tables, tableSize, capacity);
  const uint count = min(counters[OTG_COUNT_HITS], capacity);
  for (uint hit = get_global_id(0); hit < count; hit += get_global_size(0)) {
    const uint pairSlot = *otgLink(&l, OTG_LINK_PAIR_SLOT, hit);
    if (pairSlot != OTG_NOT_THERE) l.pairTable[pairSlot] = 0;
    const uint pair = l.records[hit].pair;
    if (!otgIsContact(l.records[hit].kind) || (results[OTG_FLAGS + pair] & OTG_PAIR_TO_HOST)) continue;
    __global otg_pair_state* state = states + pair;
    volatile __global uint* mark = otgLink(&l, OTG_LINK_MARK, otgFind(&l, hit));
    if (*mark == 0 && atomic_xchg(mark, 1) == 0) {
      const uint place = atomic_inc(&state->roots);
      if (place < OTG_KEPT) roots[(size_t)pair * OTG_KEPT + place] = otgFind(&l, hit);
    }
    if (reductions[state->reduction].method == OTG_REDUCE_BINNING) {
      // Only the last holder of a slot finds itself there, and it alone empties the slot.
      const uint slot = *otgLink(&l, OTG_LINK_BIN_SLOT, hit);
      if (slot == OTG_NOT_THERE || l.binTable[slot] != hit + 1) continue;
      l.binTable[slot] = 0;
    }
    const uint place = atomic_inc(&state->kept);
    if (place < OTG_KEPT) kept[(size_t)pair * OTG_KEPT + place] = hit;
  }
}

/// Work-group g chooses for pair g. `results`: the head, the pairs' flags, `pairs` + 1 numbers from which the contacts'
/// places follow, contacts. What does not fit into the lists is left to the host.
__kernel __attribute__((reqd_work_group_size(OTG_GROUP, 1, 1))) void chooseContacts(
    __global const float4* restrict meshes, __global uint* restrict counters, __global uchar* restrict records,
    __global uint* links, __global uint* tables, uint tableSize, uint capacity,
    __global otg_pair_state* restrict states, __global const otg_reduction* restrict reductions,
    __global const uint* restrict kept, __global const uint* restrict roots, __global uint2* restrict chosen,
    uint chosenRoom, __global uchar* restrict results) {
  __local otg_choice choice;
  const uint lane = get_local_id(0), pair = get_group_id(0), pairs = get_num_groups(0);
  const otg_links l = otgLinksOf(counters, records, links, tables, tableSize, capacity);
  __global uint* flag = (__global uint*)(results + OTG_RESULT_HEAD) + pair;
  __global uint* first = (__global uint*)(results + OTG_RESULT_HEAD) + pairs;
  __global const otg_pair_state* state = states + pair;
  const int leftOut = (*flag & (OTG_PAIR_TO_HOST | OTG_PAIR_REFUSED | OTG_PAIR_SKIPPED)) != 0;
  const int tooMany = !leftOut && (state->kept > OTG_KEPT || state->roots > OTG_KEPT);
  const int works = !leftOut && !tooMany;
  const size_t room = (size_t)pair * OTG_KEPT, list = (size_t)pair * chosenRoom;
  const uint count = otgChoose(&l, kept + room, works ? state->kept : 0, roots + room, works ? state->roots : 0,
                               reductions[state->reduction].places, &choice, chosen + list);
  barrier(CLK_LOCAL_MEM_FENCE | CLK_GLOBAL_MEM_FENCE);
  if (lane == 0) {
    if (tooMany) *flag |= OTG_PAIR_TO_HOST;
    first[pair + 1] = count;
    if (pair == 0) first[0] = 0;
    if (leftOut || tooMany) {
      atomic_inc(counters + OTG_COUNT_FLAGGED);
    } else if (state->intersecting) {
      atomic_add(counters + OTG_COUNT_INTERSECTING, state->intersecting);
      atomic_add(counters + OTG_COUNT_CONTACTS, state->contacts);
      atomic_add(counters + OTG_COUNT_REDUCED, count);
    }
  }
#if OTG_SINGLE
  __global otg_chosen_contact* out = (__global otg_chosen_contact*)(results + OTG_RESULT_CONTACTS(1));
  for (uint i = lane; i < count; i += OTG_GROUP) otgWriteChosen(&l, meshes, state, chosen[i], out + i);
  barrier(CLK_GLOBAL_MEM_FENCE);
  for (uint i = lane; i < OTG_COUNTERS; i += OTG_GROUP) {
    if (i < OTG_RESULT_HEAD / sizeof(uint)) ((__global uint*)results)[i] = counters[i];
    counters[i] = 0;
  }
#endif
}

#if !OTG_SINGLE

/// Counts to places, by one work-group: first[i] becomes the place of pair i's first contact.
__kernel __attribute__((reqd_work_group_size(OTG_GROUP, 1, 1))) void placeContacts(uint pairs,
                                                                                   __global uchar* restrict results) {
  __local uint sums[OTG_GROUP];
  __global uint* counts = (__global uint*)(results + OTG_RESULT_HEAD) + pairs + 1;
  const uint lane = get_local_id(0), stretch = (pairs + OTG_GROUP - 1) / OTG_GROUP;
  const uint from = min(pairs, lane * stretch), to = min(pairs, from + stretch);
  uint sum = 0;
  for (uint i = from; i < to; ++i) sum += counts[i];
  sums[lane] = sum;
  barrier(CLK_LOCAL_MEM_FENCE);
  sum = 0;
  for (uint i = 0; i < lane; ++i) sum += sums[i];
  for (uint i = from; i < to; ++i) {
    sum += counts[i];
    counts[i] = sum;
  }
}

/// One lane for each place that a pair may fill. The last kernel: see otgFinish.
__kernel __attribute__((reqd_work_group_size(OTG_GROUP, 1, 1))) void writeContacts(
    __global const float4* restrict meshes, __global uint* restrict counters, __global uchar* restrict records,
    uint capacity, __global const otg_pair_state* restrict states, __global const uint2* restrict chosen,
    uint chosenRoom, uint pairs, __global uchar* restrict results, uint contactRoom) {
  __local uint last;
  const otg_links l = otgLinksOf(counters, records, 0, 0, 0, capacity);
  __global const uint* first = (__global const uint*)(results + OTG_RESULT_HEAD) + pairs;
  __global otg_chosen_contact* out = (__global otg_chosen_contact*)(results + OTG_RESULT_CONTACTS(pairs));
  for (size_t t = get_global_id(0); t < (size_t)pairs * chosenRoom; t += get_global_size(0)) {
    const uint pair = (uint)(t / chosenRoom), place = first[pair] + (uint)(t % chosenRoom);
    if (place < min(first[pair + 1], contactRoom)) otgWriteChosen(&l, meshes, states + pair, chosen[t], out + place);
  }
  otgFinish(counters, results, &last);
}

#endif
