// SPDX-License-Identifier: BSD-3-Clause
// Decides in exact arithmetic what double arithmetic left open in the records of pair_results.cl or batch_results.cl:
// beside them, because it takes more registers than they have, and as a rule nothing is open. Needs doubles.
//
// OTG_GROUP is the size of work-groups, OTG_CONTACTS as in pair_record.h. OTG_SINGLE: 1 for one pair of meshes, 0 for a
// batch. OTG_ENTER: 1 to enter what is decided into the tables of contact_reduce.cl.
#include "pairwise/contact_links.h"
#include "pairwise/exact_decision.h"
#include "shared/layout/pairwise_given.h"

#if OTG_SINGLE

/// Of the pair whose records they are. Without OTG_ENTER this is the last kernel.
__kernel __attribute__((reqd_work_group_size(OTG_GROUP, 1, 1))) void pairDecide(
#if OTG_ENTER
    OTG_GIVEN(PairDecideEntered)
#else
    OTG_GIVEN(PairDecide)
#endif
) {
  const uint count = counters[OTG_COUNT_OPEN] > 0 ? min(counters[OTG_COUNT_HITS], hitCapacity) : 0;
  __global otg_record* records = (__global otg_record*)(results + OTG_RESULT_HEAD);
#if OTG_ENTER
  __local otg_tally tally;
  const otg_links l = otgLinksOf(counters, results, links, tables, tableSize, hitCapacity);
  otgBeginTally(&tally);
#else
  __local uint last;
#endif
  for (uint i = get_global_id(0); i < count; i += get_global_size(0)) {
    if (records[i].kind != OTG_RECORD_OPEN) continue;
    const uint2 hit = hits[i];
    otgDecideRecord(meshes, pair.a.soup + 3 * (hit.x & ~OTG_HIT_UNDECIDED), pair.b.soup + 3 * hit.y, bInA, 0,
                    records + i);
#if OTG_ENTER
    otgEnterHit(&l, state, chosen + OTG_FLAGS, i, OTG_PAIR_TO_HOST, &tally);
#endif
  }
#if OTG_ENTER
  otgEndTally(state, &tally);
#else
  otgFinish(counters, results, &last);
#endif
}

#else

/// Of the pairs of a batch that are neither skipped nor left to the CPU already; without OTG_ENTER not of those with
/// OTG_PAIR_MANY either, whose records are made again.
__kernel __attribute__((reqd_work_group_size(OTG_GROUP, 1, 1))) void batchDecide(
#if OTG_ENTER
    OTG_GIVEN(BatchDecideEntered)
#else
    OTG_GIVEN(BatchDecide)
#endif
) {
  __global uint* flags = chosen + OTG_FLAGS;
  const uint count = counters[OTG_COUNT_OPEN_OF_BATCH] > 0 ? min(counters[OTG_COUNT_HITS], hitCapacity) : 0;
  const uint others = OTG_PAIR_LEFT_OUT | (OTG_ENTER ? 0 : OTG_PAIR_MANY);
  __global otg_record* records = (__global otg_record*)(results + OTG_RESULT_HEAD);
#if OTG_ENTER
  const otg_links l = otgLinksOf(counters, results, links, tables, tableSize, hitCapacity);
#endif
  for (uint i = get_global_id(0); i < count; i += get_global_size(0)) {
    const otg_batch_hit hit = hits[i];
    if ((flags[hit.pair] & others) || records[i].kind != OTG_RECORD_OPEN) continue;
    const uint soupA = places[pairs[hit.pair].meshA].soup, soupB = places[pairs[hit.pair].meshB].soup;
    otgDecideRecord(meshes, soupA + 3 * (hit.a & ~OTG_HIT_UNDECIDED), soupB + 3 * hit.b, tasks[hit.pair].bInA, hit.pair,
                    records + i);
#if OTG_ENTER
    otgEnterHit(&l, states, flags, i, OTG_PAIR_TO_HOST, 0);
#endif
  }
}

#endif
