// SPDX-License-Identifier: BSD-3-Clause
// Exclusive prefix sums in one pass over the numbers (D. Merrill and M. Garland, "Single-pass Parallel Prefix Scan with
// Decoupled Look-back", 2016): each work-group tells the sum of its numbers, and finds the sum before them by looking
// back at what the groups before it told. A group takes its turn when it begins to run, so that all whom it may wait
// for are running or done.
//
// OTG_GROUP: work-items of a work-group. OTG_EACH: numbers of a work-item. OTG_TWO_SUMS: 1 for two sums at once.
#define OTG_REAL_FLOAT
#include "shared/layout/published_given.h"
#undef OTG_REAL_FLOAT

#if OTG_TWO_SUMS
#define OTG_SUM uint2
#define OTG_SUM_WORDS 2
#else
#define OTG_SUM uint
#define OTG_SUM_WORDS 1
#endif
#define OTG_BLOCK (OTG_GROUP * OTG_EACH)

/// What a group tells: OTG_SCAN_WORDS words. A flag, its own sum, and the sum up to its end. The flag is `turn` + 1 when
/// its own sum is there, and `turn` + 2 when both are.
inline static void otgTell(__global uint* told, uint at, OTG_SUM sum, uint flag) {
#if OTG_TWO_SUMS
  atomic_xchg(told + at, sum.x);
  atomic_xchg(told + at + 1, sum.y);
#else
  atomic_xchg(told + at, sum);
#endif
  mem_fence(CLK_GLOBAL_MEM_FENCE);
  atomic_xchg(told, flag);
}

inline static OTG_SUM otgTold(__global uint* told, uint at) {
#if OTG_TWO_SUMS
  return (OTG_SUM)(atomic_or(told + at, 0u), atomic_or(told + at + 1, 0u));
#else
  return atomic_or(told + at, 0u);
#endif
}

/// The sum of all groups before this one.
inline static OTG_SUM otgLookBack(__global uint* told, uint group, uint turn) {
  OTG_SUM before = (OTG_SUM)(0);
  for (uint k = group; k-- > 0;) {
    __global uint* other = told + OTG_SCAN_WORDS * k;
    uint flag;
    do {
      flag = atomic_or(other, 0u);
    } while (flag != turn + 1 && flag != turn + 2);
    mem_fence(CLK_GLOBAL_MEM_FENCE);
    before += otgTold(other, flag == turn + 1 ? 1 : 1 + OTG_SUM_WORDS);
    if (flag == turn + 2) break;
  }
  return before;
}

/// Each work-item's sum becomes that of the work-items before it; the sum of all.
inline static OTG_SUM otgScanLanes(__local OTG_SUM* part, uint lane) {
  const OTG_SUM mine = part[lane];
  OTG_SUM sum = mine, all;
  for (uint step = 1; step < OTG_GROUP; step *= 2) {
    barrier(CLK_LOCAL_MEM_FENCE);
    if (lane >= step) sum += part[lane - step];
    barrier(CLK_LOCAL_MEM_FENCE);
    part[lane] = sum;
  }
  barrier(CLK_LOCAL_MEM_FENCE);
  all = part[OTG_GROUP - 1];
  barrier(CLK_LOCAL_MEM_FENCE);
  part[lane] = sum - mine;
  return all;
}

__kernel __attribute__((reqd_work_group_size(OTG_GROUP, 1, 1))) void scanOnce(
#if OTG_TWO_SUMS
    OTG_GIVEN(OnceTwos)
#else
    OTG_GIVEN(OnceOnes)
#endif
) {
  __local OTG_SUM block[OTG_BLOCK], part[OTG_GROUP], before[1];
  __local uint taken[1];
  const uint lane = get_local_id(0);
  OTG_SUM sum = (OTG_SUM)(0), all;
  if (lane == 0) {
    taken[0] = atomic_inc(ticket);
    if (taken[0] == get_num_groups(0) - 1) atomic_xchg(ticket, 0u);  // nobody else takes one
  }
  barrier(CLK_LOCAL_MEM_FENCE);
  const uint group = taken[0], base = OTG_BLOCK * group;
  for (uint i = lane; i < OTG_BLOCK; i += OTG_GROUP) block[i] = base + i < count ? values[base + i] : (OTG_SUM)(0);
  barrier(CLK_LOCAL_MEM_FENCE);
  for (uint i = 0; i < OTG_EACH; ++i) sum += block[OTG_EACH * lane + i];
  part[lane] = sum;
  all = otgScanLanes(part, lane);
  if (lane == 0) {
    __global uint* mine = told + OTG_SCAN_WORDS * group;
    if (group > 0) otgTell(mine, 1, all, turn + 1);
    before[0] = otgLookBack(told, group, turn);
    otgTell(mine, 1 + OTG_SUM_WORDS, before[0] + all, turn + 2);
    if (group == get_num_groups(0) - 1) total[totalAt] = before[0] + all;
  }
  barrier(CLK_LOCAL_MEM_FENCE);
  sum = before[0] + part[lane];
  for (uint i = 0; i < OTG_EACH; ++i) {
    const OTG_SUM value = block[OTG_EACH * lane + i];
    block[OTG_EACH * lane + i] = sum;
    sum += value;
  }
  barrier(CLK_LOCAL_MEM_FENCE);
  for (uint i = lane; i < OTG_BLOCK && base + i < count; i += OTG_GROUP) places[base + i] = block[i];
}
