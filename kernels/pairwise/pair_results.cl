// SPDX-License-Identifier: BSD-3-Clause
// The hits of one pair of meshes as records. OTG_GROUP is the size of work-groups, OTG_CONTACTS as in pair_record.h.
// OTG_ENTER: 1 if contacts are reduced on the device.
#define OTG_SINGLE 1
#include "pairwise/contact_links.h"
#include "shared/layout/pairwise_given.h"

/// One record for each hit, in the order of the list. With `decides` kernel pairDecide follows, for what double
/// arithmetic leaves open. Without OTG_ENTER and `decides` this is the last kernel, and the host reads the head and as
/// many records as it expects at once.
__kernel __attribute__((reqd_work_group_size(OTG_GROUP, 1, 1))) void pairResults(
#if OTG_ENTER
    OTG_GIVEN(PairResultsEntered)
#else
    OTG_GIVEN(PairResults)
#endif
) {
  __local uint open;
  const uint lane = get_local_id(0), count = min(counters[OTG_COUNT_HITS], hitCapacity);
  __global otg_record* records = (__global otg_record*)(results + OTG_RESULT_HEAD);
#if OTG_ENTER
  __local otg_tally tally;
  const otg_links l = otgLinksOf(counters, results, links, tables, tableSize, hitCapacity);
  otgBeginTally(&tally);
#else
  __local uint last;
#endif
  if (lane == 0) open = 0;
  barrier(CLK_LOCAL_MEM_FENCE);
  for (uint i = get_global_id(0); i < count; i += get_global_size(0)) {
    const uint2 hit = hits[i];
    otgMakeRecord(meshes, pair.a.soup + 3 * (hit.x & ~OTG_HIT_UNDECIDED), pair.b.soup + 3 * hit.y,
                  (hit.x & OTG_HIT_UNDECIDED) != 0, bInA, 0, records + i);
#ifdef OTG_WITH_DOUBLE
    if (records[i].kind == OTG_RECORD_OPEN) atomic_inc(&open);
#endif
#if OTG_ENTER
    otgEnterHit(&l, state, chosen + OTG_FLAGS, i, decides ? 0 : OTG_PAIR_TO_HOST, &tally);
#endif
  }
  barrier(CLK_LOCAL_MEM_FENCE);
  if (lane == 0 && open > 0) atomic_add(counters + OTG_COUNT_OPEN, open);
#if OTG_ENTER
  otgEndTally(state, &tally);
#else
  if (!decides) otgFinish(counters, results, &last);
#endif
}
