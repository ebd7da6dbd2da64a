// SPDX-License-Identifier: BSD-3-Clause
// Exclusive prefix sums of any length: each work-group scans as many numbers as it has work-items and gives their sum,
// the sums are scanned in the same way, and so on; then the sums before a work-group's numbers are added to them.
//
// OTG_GROUP: work-items of a work-group, 2 at least. OTG_SUM: uint, or uint2 for two sums at once.

/// `places` may be `values`. `sums` gets a number for each work-group.
__kernel __attribute__((reqd_work_group_size(OTG_GROUP, 1, 1))) void scanBlocks(
    __global const OTG_SUM* values, uint valuesBegin, __global OTG_SUM* places, uint placesBegin, uint count,
    __global OTG_SUM* sums, uint sumsBegin) {
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

/// `sums` has been scanned.
__kernel __attribute__((reqd_work_group_size(OTG_GROUP, 1, 1))) void scanAdd(__global OTG_SUM* restrict places,
                                                                             uint placesBegin, uint count,
                                                                             __global const OTG_SUM* sums,
                                                                             uint sumsBegin) {
  const uint i = get_global_id(0);
  if (i < count) places[placesBegin + i] += sums[sumsBegin + get_group_id(0)];
}
