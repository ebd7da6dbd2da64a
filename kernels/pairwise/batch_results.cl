// SPDX-License-Identifier: BSD-3-Clause
// The hits of a batch as records. OTG_GROUP is the size of work-groups, OTG_CONTACTS as in pair_record.h. OTG_ENTER: 1
// to enter them into the tables of contact_reduce.cl. OTG_EXACT: 1 to decide in exact arithmetic what double arithmetic
// leaves open (without contacts; needs doubles).
#define OTG_SINGLE 0
#include "pairwise/contact_links.h"
#include "shared/layout/pairwise_given.h"
#if OTG_EXACT
#include "pairwise/exact_decision.h"
#endif

/// One record for each hit of the pairs that are not skipped, in the order of the list. `tasks` holds B in A's frame
/// for each pair. The flags in `chosen` say of each pair what its records say: OTG_PAIR_INTERSECTS (only without
/// contacts), or OTG_PAIR_TO_HOST when one is open (without contacts, or with OTG_ENTER; not with `decides`). With
/// contacts open hits are counted, and with `decides` kernel batchDecide follows. Without contacts this is the last
/// kernel.
__kernel __attribute__((reqd_work_group_size(OTG_GROUP, 1, 1))) void batchResults(
#if OTG_ENTER
    OTG_GIVEN(BatchResultsEntered)
#else
    OTG_GIVEN(BatchResults)
#endif
) {
  __global uint* flags = chosen + OTG_FLAGS;
  const uint count = min(counters[OTG_COUNT_HITS], hitCapacity);
  __global otg_record* records = (__global otg_record*)(results + OTG_RESULT_HEAD);
#if OTG_ENTER
  const otg_links l = otgLinksOf(counters, results, links, tables, tableSize, hitCapacity);
#elif !OTG_CONTACTS
  __local uint last;
#endif
#if OTG_CONTACTS
  __local uint open;
  if (get_local_id(0) == 0) open = 0;
  barrier(CLK_LOCAL_MEM_FENCE);
#endif
  for (uint i = get_global_id(0); i < count; i += get_global_size(0)) {
    const otg_batch_hit hit = hits[i];
    if (flags[hit.pair] & OTG_PAIR_SKIPPED) continue;  // unordered
    const uint soupA = places[pairs[hit.pair].meshA].soup, soupB = places[pairs[hit.pair].meshB].soup;
    const otg_task_pose bInA = tasks[hit.pair].bInA;
    otgMakeRecord(meshes, soupA + 3 * (hit.a & ~OTG_HIT_UNDECIDED), soupB + 3 * hit.b, (hit.a & OTG_HIT_UNDECIDED) != 0,
                  bInA, hit.pair, records + i);
#if OTG_EXACT
    // A pair that has a hit for certain needs no other.
    if (!(flags[hit.pair] & OTG_PAIR_INTERSECTS)) {
      otgDecideRecord(meshes, soupA + 3 * (hit.a & ~OTG_HIT_UNDECIDED), soupB + 3 * hit.b, bInA, hit.pair, records + i);
    }
#endif
#if OTG_CONTACTS
    if (records[i].kind == OTG_RECORD_OPEN && !(flags[hit.pair] & OTG_PAIR_TO_HOST)) atomic_inc(&open);
#endif
#if OTG_ENTER
    otgEnterHit(&l, states, flags, i, decides ? 0 : OTG_PAIR_TO_HOST, 0);
#elif !OTG_CONTACTS
    const uint flag = records[i].kind == OTG_RECORD_OPEN ? OTG_PAIR_TO_HOST : OTG_PAIR_INTERSECTS;
    if (records[i].kind != OTG_RECORD_APART && !(flags[hit.pair] & flag) &&
        !(atomic_or(flags + hit.pair, flag) & flag) && flag == OTG_PAIR_TO_HOST) {
      atomic_inc(counters + OTG_COUNT_FLAGGED);
    }
#endif
  }
#if OTG_CONTACTS
  barrier(CLK_LOCAL_MEM_FENCE);
  if (get_local_id(0) == 0 && open > 0) atomic_add(counters + OTG_COUNT_OPEN_OF_BATCH, open);
#else
  otgFinish(counters, (__global uchar*)chosen, &last);
#endif
}
