// SPDX-License-Identifier: BSD-3-Clause
// Many pairs of meshes at once: one work-group walks one pair of trees, depth-first, and tests the triangles of the
// leaves that it meets. OTG_GROUP is the size of work-groups, a multiple of 8; OTG_LEAF the most triangles of a leaf.
#include "pair_walk.h"

/// Work-group g takes the g-th pair of the lists that batchPrepare made. `stackSize` is as for pairTail, for the
/// deepest two trees of the batch. With `anyHit` a pair is left at the first hit that single precision is sure of:
/// enough to know that it intersects; that is told in its flags in `chosen`, and only undecided hits are listed.
__kernel __attribute__((reqd_work_group_size(OTG_GROUP, 1, 1))) void batchWalk(
    __global const otg_batch_pair* restrict pairs, __global const otg_device_mesh* restrict places,
    const otg_pair_error precision, __global const float4* restrict meshes, __global uint* restrict counters,
    __global const uint* restrict order, uint orderRoom, __global uint* restrict chosen,
    __global otg_batch_hit* restrict hits, uint hitCapacity, uint anyHit, uint stackSize, __local uint2* stack) {
  __local uint2 ended[3 * OTG_GROUP];
  __local uint pushed, endedCount, boxTests, triangleTests, sure, found;
  __local uint classes[OTG_CLASSES];
  const uint lane = get_local_id(0), lanesPerLeaf = OTG_LEAF * OTG_LEAF, mostAtOnce = OTG_GROUP / 8;
  otg_device_pair pair;
  uint stacked = 0, tested = 0;
  for (uint k = lane; k < OTG_CLASSES; k += OTG_GROUP) classes[k] = counters[OTG_COUNT_CLASS + k];
  barrier(CLK_LOCAL_MEM_FENCE);
  if (lane == 0) {
    uint place = get_group_id(0), k = 0;
    while (k < OTG_CLASSES && place >= classes[k]) place -= classes[k++];
    found = k < OTG_CLASSES ? order[(size_t)k * orderRoom + place] : OTG_NOT_THERE;
  }
  barrier(CLK_LOCAL_MEM_FENCE);
  // A work-group without a pair goes through all barriers with nothing to do.
  const int isThere = found != OTG_NOT_THERE;
  const uint number = isThere ? found : 0;
  for (int k = 0; k < 9; ++k) {
    pair.boxes.r[k] = pairs[number].r[k];
    pair.boxes.absR[k] = fabs(pair.boxes.r[k]);
  }
  pair.boxes.t = pairs[number].t;
  pair.boxes.eps = pairs[number].eps;
  pair.error = precision;
  pair.error.delta = pairs[number].delta;
  pair.a = places[pairs[number].meshA];
  pair.b = places[pairs[number].meshB];
  const uint roomForOne = 8 * (pair.a.depth + pair.b.depth) + 8;
  if (lane == 0) {
    pushed = 0;
    endedCount = 0;
    boxTests = isThere ? 1 : 0;
    triangleTests = 0;
    sure = 0;
  }
  barrier(CLK_LOCAL_MEM_FENCE);
  if (lane == 0 && isThere) {
    const otg_node a = otgLoadNode(meshes, pair.a.nodes, 0), b = otgLoadNode(meshes, pair.b.nodes, 0);
    if (otgOverlap(&pair.boxes, a.center, a.extent, otgMoveBox(&pair.boxes, b.center, b.extent))) {
      if (a.count < 0 && b.count < 0) {
        ended[endedCount++] = (uint2)(0, 0);
      } else {
        stack[pushed++] = (uint2)(0, 0);
      }
    }
  }
  barrier(CLK_LOCAL_MEM_FENCE);
  stacked = pushed;
  barrier(CLK_LOCAL_MEM_FENCE);
  if (lane == 0) pushed = 0;
  // `stacked` and the loop itself are the same for all lanes.
  for (int more = stacked > 0 || endedCount > 0; more;) {
    if (stacked > 0) {
      const uint room = stackSize - roomForOne > stacked ? (stackSize - roomForOne - stacked) / 7 : 0;
      const uint taken = min(stacked, clamp(room, 1u, mostAtOnce));
      const uint base = stacked - taken, item = lane / 8, k = lane % 8;
      uint2 nodes = (uint2)(0, 0);
      if (item < taken) nodes = stack[base + item];
      barrier(CLK_LOCAL_MEM_FENCE);  // all have read before any writes
      if (item < taken) {
        uint children;
        const int found = otgOpen(meshes, &pair, &nodes, k, &children);
        if (k == 0) atomic_add(&boxTests, children);
        if (found == 1) stack[base + atomic_inc(&pushed)] = nodes;
        if (found == 2) ended[atomic_inc(&endedCount)] = nodes;
      }
      barrier(CLK_LOCAL_MEM_FENCE);
      stacked = base + pushed;
      barrier(CLK_LOCAL_MEM_FENCE);
      if (lane == 0) pushed = 0;
    }
    if (endedCount >= 2 * OTG_GROUP || stacked == 0) {
      for (uint t = lane; t < endedCount * lanesPerLeaf; t += OTG_GROUP) {
        const uint2 nodes = ended[t / lanesPerLeaf];
        const uint i = t % lanesPerLeaf / OTG_LEAF, j = t % OTG_LEAF;
        const otg_node a = otgLoadNode(meshes, pair.a.nodes, nodes.x), b = otgLoadNode(meshes, pair.b.nodes, nodes.y);
        if ((int)i >= -a.count || (int)j >= -b.count) continue;
        const uint placeA = (uint)a.first + i, placeB = (uint)b.first + j;
        const int answer = otgTestTriangles(meshes, &pair, placeA, placeB);
        ++tested;
        if (answer == OTG_DISJOINT) continue;
        if (anyHit && answer == OTG_INTERSECTING) {
          sure = 1;
          continue;
        }
        const uint slot = otgTakeHit(counters, answer);
        if (slot >= hitCapacity) continue;
        hits[slot].pair = number;
        hits[slot].a = placeA | (answer == OTG_UNDECIDED ? OTG_HIT_UNDECIDED : 0);
        hits[slot].b = placeB;
      }
      barrier(CLK_LOCAL_MEM_FENCE);
      if (lane == 0) endedCount = 0;
      if (anyHit && sure > 0) stacked = 0;
    }
    more = stacked > 0;
    barrier(CLK_LOCAL_MEM_FENCE);
  }
  if (tested) atomic_add(&triangleTests, tested);
  barrier(CLK_LOCAL_MEM_FENCE);
  if (lane == 0) {
    if (anyHit && sure) chosen[OTG_FLAGS + number] |= OTG_PAIR_INTERSECTS;
    otgCount(counters + OTG_COUNT_BOX_TESTS, boxTests);
    otgCount(counters + OTG_COUNT_TRIANGLE_TESTS, triangleTests);
  }
}
