// SPDX-License-Identifier: BSD-3-Clause
// The hits of one pair of meshes as records. OTG_GROUP is the size of work-groups, OTG_CONTACTS as in pair_record.h.
// OTG_REDUCE: 1 if contacts are reduced on the device.
#define OTG_SINGLE 1
#include "contact_links.h"

/// One record for each hit, in the order of the list. Without OTG_REDUCE this is the last kernel, and the host reads
/// the head and as many records as it expects at once.
__kernel __attribute__((reqd_work_group_size(OTG_GROUP, 1, 1))) void pairResults(
    const otg_device_pair pair, const OTG_POSE bInA, __global const float4* restrict meshes,
    __global uint* restrict counters, __global const uint2* restrict hits, uint hitCapacity,
    __global uchar* restrict results
#if OTG_REDUCE
    ,
    __global uint* links, __global uint* tables, uint tableSize, __global otg_pair_state* restrict state,
    __global uint* restrict chosen
#endif
) {
  const uint count = min(counters[OTG_COUNT_HITS], hitCapacity);
  __global otg_record* records = (__global otg_record*)(results + OTG_RESULT_HEAD);
#if OTG_REDUCE
  __local otg_tally tally;
  const otg_links l = otgLinksOf(counters, results, links, tables, tableSize, hitCapacity);
  otgBeginTally(&tally);
#else
  __local uint last;
#endif
  for (uint i = get_global_id(0); i < count; i += get_global_size(0)) {
    const uint2 hit = hits[i];
    otgMakeRecord(meshes, pair.a.soup + 3 * (hit.x & ~OTG_HIT_UNDECIDED), pair.b.soup + 3 * hit.y,
                  (hit.x & OTG_HIT_UNDECIDED) != 0, bInA, 0, records + i);
#if OTG_REDUCE
    otgEnterHit(&l, state, chosen + OTG_FLAGS, i, &tally);
#endif
  }
#if OTG_REDUCE
  otgEndTally(state, &tally);
#else
  otgFinish(counters, results, &last);
#endif
}
