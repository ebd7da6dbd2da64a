// SPDX-License-Identifier: BSD-3-Clause
// The hits of those pairs of a batch of solids that get contacts of the model `pairwise`, for batchReduce. OTG_GROUP:
// size of work-groups; OTG_CONTACTS is 1.
#include "pairwise/pair_record.h"
#include "shared/layout/pairwise_given.h"

/// The contact of each hit that solidRecords found to intersect, at the same place of `contacts`.
__kernel __attribute__((reqd_work_group_size(OTG_GROUP, 1, 1))) void solidPairwise(OTG_GIVEN(SolidPairwise)) {
  const uint count = min(counters[OTG_COUNT_HITS], hitCapacity);
  __global const otg_pair_record* from = (__global const otg_pair_record*)(decided + OTG_RESULT_HEAD);
  __global otg_contact_record* to = (__global otg_contact_record*)(contacts + OTG_RESULT_HEAD);
  for (uint i = get_global_id(0); i < count; i += get_global_size(0)) {
    const otg_batch_hit hit = hits[i];
    if ((chosen[OTG_FLAGS + hit.pair] & (OTG_PAIR_PAIRWISE | OTG_PAIR_LEFT_OUT)) != OTG_PAIR_PAIRWISE) continue;
    const uint soupA = places[pairs[hit.pair].meshA].soup, soupB = places[pairs[hit.pair].meshB].soup;
    otgMakeRecord(meshes, soupA + 3 * (hit.a & ~OTG_HIT_UNDECIDED), soupB + 3 * hit.b, 0, tasks[hit.pair].bInA,
                  hit.pair, to + i);
    if (from[i].kind != OTG_RECORD_HIT) to[i].kind = from[i].kind;
  }
}
