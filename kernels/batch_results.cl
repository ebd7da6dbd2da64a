// SPDX-License-Identifier: BSD-3-Clause
// The hits of a batch as records. OTG_GROUP is the size of work-groups, OTG_CONTACTS as in pair_record.h.
#include "pair_record.h"

/// One record for each hit, in the order of the list. `poses` holds B in A's frame for each pair (not read without
/// doubles).
__kernel __attribute__((reqd_work_group_size(OTG_GROUP, 1, 1))) void batchResults(
    __global const otg_batch_pair* restrict pairs, __global const otg_device_mesh* restrict places,
    __global const OTG_POSE* restrict poses, __global const float4* restrict meshes, __global uint* restrict counters,
    __global const otg_batch_hit* restrict hits, uint hitCapacity, __global uchar* restrict results) {
  __local uint last;
  const uint count = min(counters[OTG_COUNT_HITS], hitCapacity);
  __global otg_record* records = (__global otg_record*)(results + OTG_RESULT_HEAD);
  for (uint i = get_global_id(0); i < count; i += get_global_size(0)) {
    const otg_batch_hit hit = hits[i];
    const uint soupA = places[pairs[hit.pair].meshA].soup, soupB = places[pairs[hit.pair].meshB].soup;
#ifdef OTG_WITH_DOUBLE
    const OTG_POSE bInA = poses[hit.pair];
#else
    const OTG_POSE bInA = 0;
#endif
    otgMakeRecord(meshes, soupA + 3 * (hit.a & ~OTG_HIT_UNDECIDED), soupB + 3 * hit.b, (hit.a & OTG_HIT_UNDECIDED) != 0,
                  bInA, hit.pair, records + i);
  }
  otgFinish(counters, results, &last);
}
