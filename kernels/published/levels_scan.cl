// SPDX-License-Identifier: BSD-3-Clause
// Exclusive prefix sums of any length: each work-group scans as many numbers as it has work-items and gives their sum,
// the sums are scanned in the same way, and so on; then the sums before a work-group's numbers are added to them.
//
// OTG_GROUP: work-items of a work-group, 2 at least. OTG_BLOCK: numbers of a block whose sum scanAdd adds; scanBlocks
// takes OTG_GROUP. OTG_TWO_SUMS: 1 for two sums at once.
#define OTG_REAL_FLOAT
#include "shared/layout/published_given.h"
#undef OTG_REAL_FLOAT

#if OTG_TWO_SUMS
#define OTG_SUM uint2
#else
#define OTG_SUM uint
#endif

/// Sums within each work-group, and its own sum.
__kernel __attribute__((reqd_work_group_size(OTG_GROUP, 1, 1))) void scanBlocks(
#if OTG_TWO_SUMS
    OTG_GIVEN(ScanTwos)
#else
    OTG_GIVEN(ScanOnes)
#endif
) {
  __local OTG_SUM part[2][OTG_GROUP];
  const uint lane = get_local_id(0), i = get_global_id(0);
  const OTG_SUM mine = i < count ? values[valuesBegin + i] : (OTG_SUM)(0);
  uint now = 0;
  part[0][lane] = mine;
  barrier(CLK_LOCAL_MEM_FENCE);
  for (uint step = 1; step < OTG_GROUP; step *= 2) {
    OTG_SUM sum = part[now][lane];
    if (lane >= step) sum += part[now][lane - step];
    part[1 - now][lane] = sum;
    now = 1 - now;
    barrier(CLK_LOCAL_MEM_FENCE);
  }
  if (i < count) places[placesBegin + i] = part[now][lane] - mine;
  if (lane == OTG_GROUP - 1) sums[sumsBegin + get_group_id(0)] = part[now][lane];
}

/// The sums before a block's numbers are added to them.
__kernel __attribute__((reqd_work_group_size(OTG_GROUP, 1, 1))) void scanAdd(
#if OTG_TWO_SUMS
    OTG_GIVEN(AddTwos)
#else
    OTG_GIVEN(AddOnes)
#endif
) {
  const uint i = get_global_id(0);
  if (i < count) places[placesBegin + i] += sums[sumsBegin + i / OTG_BLOCK];
}
