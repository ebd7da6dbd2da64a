// SPDX-License-Identifier: BSD-3-Clause
// Two trees walked depth-first by one work-group: eight lanes open the larger box of one pair. OTG_GROUP is the size of
// work-groups, a multiple of 8.
#ifndef OTG_PAIR_STACK_H
#define OTG_PAIR_STACK_H
#include "pair_walk.h"

/// Where the description of the pair lies: one pair's is a kernel's argument; a batch keeps it in local memory, because
/// in registers, over barriers, it would leave room for fewer work-groups.
#ifndef OTG_PAIR_SPACE
#define OTG_PAIR_SPACE __private
#endif

/// Pairs of leaves, and what a round counts.
typedef struct {
  uint2 ended[3 * OTG_GROUP];
  uint pushed, endedCount, boxTests, triangleTests;
} otg_walk;

inline static void otgBeginWalk(__local otg_walk* w) {
  if (get_local_id(0) != 0) return;
  w->endedCount = 0;
  w->boxTests = 0;
  w->triangleTests = 0;
  w->pushed = 0;
}

/// One round: opens as many of the `stacked` pairs as the stack has room for what may come of them; at least one, for
/// which room of eight times the depth of both trees is kept free. So the stack never overflows. `stackSize` counts
/// pairs of nodes. Returns how many are on the stack then. All lanes, with the same arguments.
inline static uint otgWalkRound(__global const float4* meshes, const OTG_PAIR_SPACE otg_device_pair* pair,
                                __local otg_walk* w, __local uint2* stack, uint stackSize, uint stacked) {
  const uint lane = get_local_id(0), mostAtOnce = OTG_GROUP / 8, roomForOne = 8 * (pair->a.depth + pair->b.depth) + 8;
  const uint room = stackSize - roomForOne > stacked ? (stackSize - roomForOne - stacked) / 7 : 0;
  const uint taken = min(stacked, clamp(room, 1u, mostAtOnce));
  const uint base = stacked - taken, item = lane / 8, k = lane % 8;
  uint2 nodes = (uint2)(0, 0);
  if (item < taken) nodes = stack[base + item];
  barrier(CLK_LOCAL_MEM_FENCE);  // all have read before any writes
  if (item < taken) {
    uint children;
    const otg_device_pair here = *pair;
    const int found = otgOpen(meshes, &here, &nodes, k, &children);
    if (k == 0) atomic_add(&w->boxTests, children);
    if (found == 1) stack[base + atomic_inc(&w->pushed)] = nodes;
    if (found == 2) w->ended[atomic_inc(&w->endedCount)] = nodes;
  }
  barrier(CLK_LOCAL_MEM_FENCE);
  stacked = base + w->pushed;
  barrier(CLK_LOCAL_MEM_FENCE);
  if (lane == 0) w->pushed = 0;
  return stacked;
}

/// Test number `t` of a pair of leaves, as many as OTG_LEAF squared: OTG_DISJOINT also where there are not so many
/// triangles. `hit` is the places of the two triangles in their soups, marked if they are undecided.
inline static int otgTestLeaves(__global const float4* meshes, const OTG_PAIR_SPACE otg_device_pair* pair, uint2 nodes,
                                uint t, uint2* hit, uint* tested) {
  const otg_device_pair here = *pair;
  const int i = (int)(t / OTG_LEAF), j = (int)(t % OTG_LEAF);
  const otg_node a = otgLoadNode(meshes, here.a.nodes, nodes.x), b = otgLoadNode(meshes, here.b.nodes, nodes.y);
  if (i >= -a.count || j >= -b.count) return OTG_DISJOINT;
  const uint placeA = (uint)(a.first + i), placeB = (uint)(b.first + j);
  const int answer = otgTestTriangles(meshes, &here, placeA, placeB);
  ++*tested;
  *hit = (uint2)(placeA | (answer == OTG_UNDECIDED ? OTG_HIT_UNDECIDED : 0), placeB);
  return answer;
}

/// What a work-group counted goes to the counters. All lanes.
inline static void otgEndWalk(__local otg_walk* w, uint tested, __global uint* counters) {
  if (tested) atomic_add(&w->triangleTests, tested);
  barrier(CLK_LOCAL_MEM_FENCE);
  if (get_local_id(0) != 0) return;
  if (w->boxTests) otgCount(counters + OTG_COUNT_BOX_TESTS, w->boxTests);
  if (w->triangleTests) otgCount(counters + OTG_COUNT_TRIANGLE_TESTS, w->triangleTests);
}

#endif  // OTG_PAIR_STACK_H
