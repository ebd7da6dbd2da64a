// SPDX-License-Identifier: BSD-3-Clause
// The hits of one pair of meshes as records. OTG_GROUP is the size of work-groups, OTG_CONTACTS as in pair_record.h.
#include "pair_record.h"

/// One record for each hit, in the order of the list. The host reads the head and as many records as it expects at
/// once.
__kernel __attribute__((reqd_work_group_size(OTG_GROUP, 1, 1))) void pairResults(
    const otg_device_pair pair, const OTG_POSE bInA, __global const float4* restrict meshes,
    __global uint* restrict counters, __global const uint2* restrict hits, uint hitCapacity,
    __global uchar* restrict results) {
  __local uint last;
  const uint count = min(counters[OTG_COUNT_HITS], hitCapacity);
  __global otg_record* records = (__global otg_record*)(results + OTG_RESULT_HEAD);
  for (uint i = get_global_id(0); i < count; i += get_global_size(0)) {
    const uint2 hit = hits[i];
    otgMakeRecord(meshes, pair.a.soup + 3 * (hit.x & ~OTG_HIT_UNDECIDED), pair.b.soup + 3 * hit.y,
                  (hit.x & OTG_HIT_UNDECIDED) != 0, bInA, 0, records + i);
  }
  otgFinish(counters, results, &last);
}
