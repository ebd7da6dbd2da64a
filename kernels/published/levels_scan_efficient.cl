// SPDX-License-Identifier: BSD-3-Clause
// Exclusive prefix sums in work that grows as the numbers do (G. Blelloch, "Prefix Sums and Their Applications", 1990):
// each work-group adds up a tree of its numbers in local memory, then goes down again with the sums before them. Sums
// of work-groups are scanned in the same way, and scanAdd of levels_scan.cl adds them.
//
// OTG_GROUP: work-items of a work-group. OTG_BLOCK: numbers of a work-group, a power of two. OTG_TWO_SUMS: 1 for two
// sums at once.
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
  __local OTG_SUM part[OTG_BLOCK];
  const uint lane = get_local_id(0), base = OTG_BLOCK * get_group_id(0);
  for (uint i = lane; i < OTG_BLOCK; i += OTG_GROUP) {
    part[i] = base + i < count ? values[valuesBegin + base + i] : (OTG_SUM)(0);
  }
  for (uint step = 1; step < OTG_BLOCK; step *= 2) {  // up
    barrier(CLK_LOCAL_MEM_FENCE);
    for (uint i = lane; i < OTG_BLOCK / (2 * step); i += OTG_GROUP) {
      part[2 * step * (i + 1) - 1] += part[2 * step * i + step - 1];
    }
  }
  barrier(CLK_LOCAL_MEM_FENCE);
  if (lane == 0) {
    sums[sumsBegin + get_group_id(0)] = part[OTG_BLOCK - 1];
    part[OTG_BLOCK - 1] = (OTG_SUM)(0);
  }
  for (uint step = OTG_BLOCK / 2; step > 0; step /= 2) {  // down
    barrier(CLK_LOCAL_MEM_FENCE);
    for (uint i = lane; i < OTG_BLOCK / (2 * step); i += OTG_GROUP) {
      const uint left = 2 * step * i + step - 1, right = 2 * step * (i + 1) - 1;
      const OTG_SUM before = part[left];
      part[left] = part[right];
      part[right] += before;
    }
  }
  barrier(CLK_LOCAL_MEM_FENCE);
  for (uint i = lane; i < OTG_BLOCK && base + i < count; i += OTG_GROUP) places[placesBegin + base + i] = part[i];
}
