// SPDX-License-Identifier: BSD-3-Clause
// Exclusive prefix sums in one pass over the numbers (D. Merrill and M. Garland, "Single-pass Parallel Prefix Scan with
// Decoupled Look-back", 2016): each work-group publishes the sum of its numbers. It finds the sum before them by
// looking back at what the groups before it published. A group takes its turn when it begins to run, so all that it may
// wait for are running or done.
//
// OTG_GROUP: work-items of a work-group. OTG_EACH: numbers of a work-item. OTG_TWO_SUMS: 1 for two sums at once.
#define OTG_REAL_FLOAT
#include "shared/layout/published_given.h"
#undef OTG_REAL_FLOAT
#include "walk/take_now.h"

#if OTG_TWO_SUMS
#define OTG_SUM uint2
#else
#define OTG_SUM uint
#endif
#define OTG_BLOCK (OTG_GROUP * OTG_EACH)

/// What a group publishes: OTG_SCAN_WORDS words. From OTG_UP_TO on the sum up to its end, from OTG_OWN on its own sum. Each
/// word of a sum lies beside that word xor a key of this scan and of this place. So a reader sees whether both are
/// there: words of other scans have other keys, and no order of writes has to be kept.
#define OTG_UP_TO 0
#define OTG_OWN 4
#define OTG_KEY(turn, place) ((turn) + 1 + (place))

inline static void otgPublish(__global uint* status, uint place, OTG_SUM sum, uint turn) {
  const uint key = OTG_KEY(turn, place / OTG_OWN);
#if OTG_TWO_SUMS
  atomic_xchg(status + place, sum.x);
  atomic_xchg(status + place + 1, sum.x ^ key);
  atomic_xchg(status + place + 2, sum.y);
  atomic_xchg(status + place + 3, sum.y ^ key);
#else
  atomic_xchg(status + place, sum);
  atomic_xchg(status + place + 1, sum ^ key);
#endif
}

/// Whether the sum is there; if so, `sum` gets it.
inline static int otgPublished(__global uint* status, uint place, uint turn, OTG_SUM* sum) {
  const uint key = OTG_KEY(turn, place / OTG_OWN);
  const uint x = otgReadNow(status + place);
  int there = (x ^ otgReadNow(status + place + 1)) == key;
#if OTG_TWO_SUMS
  const uint y = otgReadNow(status + place + 2);
  there = there && (y ^ otgReadNow(status + place + 3)) == key;
  *sum = (OTG_SUM)(x, y);
#else
  *sum = x;
#endif
  return there;
}

/// The sum of all groups before this one.
inline static OTG_SUM otgLookBack(__global uint* status, uint group, uint turn) {
  OTG_SUM before = (OTG_SUM)(0), sum;
  for (uint k = group; k > 0;) {
    __global uint* other = status + OTG_SCAN_WORDS * (k - 1);
    if (otgPublished(other, OTG_UP_TO, turn, &sum)) return before + sum;
    if (!otgPublished(other, OTG_OWN, turn, &sum)) continue;  // it is running, and will publish
    before += sum;
    --k;
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
    if (taken[0] == get_num_groups(0) - 1) atomic_xchg(ticket, 0u);  // no other group takes one
  }
  barrier(CLK_LOCAL_MEM_FENCE);
  const uint group = taken[0], base = OTG_BLOCK * group;
  for (uint i = lane; i < OTG_BLOCK; i += OTG_GROUP) block[i] = base + i < count ? values[base + i] : (OTG_SUM)(0);
  barrier(CLK_LOCAL_MEM_FENCE);
  for (uint i = 0; i < OTG_EACH; ++i) sum += block[OTG_EACH * lane + i];
  part[lane] = sum;
  all = otgScanLanes(part, lane);
  if (lane == 0) {
    __global uint* mine = status + OTG_SCAN_WORDS * group;
    if (group > 0) otgPublish(mine, OTG_OWN, all, turn);
    before[0] = otgLookBack(status, group, turn);
    otgPublish(mine, OTG_UP_TO, before[0] + all, turn);
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
