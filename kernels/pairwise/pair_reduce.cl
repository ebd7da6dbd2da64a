// SPDX-License-Identifier: BSD-3-Clause
// From hits to contacts for one pair of meshes with at most OTG_KEPT hits, by one work-group: the last kernel then.
// OTG_GROUP: its size. OTG_EXACT: 1 to decide in exact arithmetic what double arithmetic leaves open.
#define OTG_SINGLE 1
#include "pairwise/contact_finish.h"
#include "pairwise/contact_group.h"
#include "shared/layout/pairwise_given.h"
#if OTG_EXACT
#include "pairwise/exact_decision.h"
#endif

/// With more hits it only flags the pair (OTG_PAIR_MANY) and copies the counters to the head: the kernels of
/// contact_reduce.cl have to follow.
__kernel __attribute__((reqd_work_group_size(OTG_GROUP, 1, 1))) void pairReduce(OTG_GIVEN(PairReduce)) {
  __local otg_group_links g;
  __local uint open;
  const uint lane = get_local_id(0), found = counters[OTG_COUNT_HITS], flags = chosen[OTG_FLAGS];
  const int many = found > min((uint)OTG_KEPT, hitCapacity);
  const uint count = many ? 0 : found;
  __global otg_contact_record* records = (__global otg_contact_record*)(results + OTG_RESULT_HEAD);
  otg_lane_tally tally = otgNoTally();
  otgBeginGroup(&g, count);
  if (lane == 0) open = 0;
  barrier(CLK_LOCAL_MEM_FENCE);
  for (uint i = lane; i < count; i += OTG_GROUP) {
    const uint2 hit = hits[i];
    otgMakeRecord(meshes, pair.a.soup + 3 * (hit.x & ~OTG_HIT_UNDECIDED), pair.b.soup + 3 * hit.y,
                  (hit.x & OTG_HIT_UNDECIDED) != 0, bInA, 0, records + i);
    if (records[i].kind == OTG_RECORD_OPEN) atomic_inc(&open);
#if OTG_EXACT
    otgDecideRecord(meshes, pair.a.soup + 3 * (hit.x & ~OTG_HIT_UNDECIDED), pair.b.soup + 3 * hit.y, bInA, 0,
                    records + i);
#endif
    otgGroupHit(&g, i, records + i, &tally);
  }
  otgGather(&g, &tally);
  barrier(CLK_LOCAL_MEM_FENCE | CLK_GLOBAL_MEM_FENCE);
  const int toHost = !many && (g.open || (flags & OTG_PAIR_TO_HOST));
  const otg_reduction how = reductions[0];
  const uint stay = otgGroupContacts(&g, records, toHost ? 0 : count, meshes, pair.a.rings, pair.b.rings, &how);
  if (lane == 0) {
    answer[OTG_FLAGS] = flags | (toHost ? OTG_PAIR_TO_HOST : 0) | (many ? OTG_PAIR_MANY : 0);
    answer[OTG_PLACE(1, 0)] = 0;
    answer[OTG_PLACE(1, 0) + 1] = stay;
    counters[OTG_COUNT_OPEN] = open;
    if (!toHost) {
      counters[OTG_COUNT_INTERSECTING] = g.intersecting;
      counters[OTG_COUNT_CONTACTS] = g.contacts;
      counters[OTG_COUNT_REDUCED] = stay;
    }
  }
  otgWriteChoice(&g.choice, stay, records, meshes, pair.a.rings, pair.b.rings,
                 (__global otg_chosen_contact*)((__global uchar*)answer + OTG_RESULT_CONTACTS(1)));
  otgFinishPair(counters, answer, !many);
}
