// SPDX-License-Identifier: BSD-3-Clause
// Two trees walked depth-first by one work-group: eight lanes open the larger box of one pair. OTG_GROUP is the size of
// work-groups, a multiple of 8.
#ifndef OTG_PAIR_STACK_H
#define OTG_PAIR_STACK_H
#include "walk/pair_walk.h"

/// Where the description of the pair lies: one pair's is a kernel's argument; a batch keeps it in local memory, because
/// in registers, over barriers, it would leave room for fewer work-groups.
#ifndef OTG_PAIR_SPACE
#define OTG_PAIR_SPACE __private
#endif

/// Pairs of leaves (otgPairOfLeaves), and how many pairs each of two successive rounds pushed.
typedef struct {
  uint2 ended[3 * OTG_GROUP];
  uint pushed[2], endedCount, boxTests, triangleTests;
} otg_walk;

/// What one lane counts.
typedef struct {
  uint boxes, triangles, rounds;
} otg_lane_walk;

inline static otg_lane_walk otgBeginWalk(__local otg_walk* w) {
  otg_lane_walk own;
  own.boxes = 0;
  own.triangles = 0;
  own.rounds = 0;
  if (get_local_id(0) == 0) {
    w->endedCount = 0;
    w->boxTests = 0;
    w->triangleTests = 0;
    w->pushed[0] = 0;
    w->pushed[1] = 0;
  }
  return own;
}

/// A pair of nodes that are not both leaves, as it lies on the stack: whoever puts it there has both nodes at hand, and
/// those that open it need not read the one that is opened. x: the other one's number, how many children there are (3
/// bits, minus one), 1 if A's is opened; y: the first child's number.
inline static uint2 otgPairToOpen(uint2 nodes, const otg_node* a, const otg_node* b) {
  const int openA = b->count < 0 || (a->count > 0 && otgArea(a->extent) >= otgArea(b->extent));
  return openA ? (uint2)(nodes.y << 4 | (uint)(a->count - 1) << 1 | 1, (uint)a->first)
               : (uint2)(nodes.x << 4 | (uint)(b->count - 1) << 1, (uint)b->first);
}

/// The same from the nodes' numbers alone.
inline static uint2 otgPairToOpenOf(__global const float4* meshes, const OTG_PAIR_SPACE otg_device_pair* pair,
                                    uint2 nodes) {
  const otg_node a = otgLoadNode(meshes, pair->a.nodes, nodes.x), b = otgLoadNode(meshes, pair->b.nodes, nodes.y);
  return otgPairToOpen(nodes, &a, &b);
}

/// A pair of nodes whose boxes overlap: on the stack from `base` on, or to the list of pairs of leaves.
inline static void otgKeepPair(__local otg_walk* w, __local uint2* stack, __local uint* pushed, uint2 nodes,
                               const otg_node* a, const otg_node* b) {
  if (a->count < 0 && b->count < 0) {
    w->ended[atomic_inc(&w->endedCount)] = otgPairOfLeaves(a, b);
  } else {
    stack[atomic_inc(pushed)] = otgPairToOpen(nodes, a, b);
  }
}

/// Pairs of nodes that have to stay free on the stack for what one pair may lead to.
inline static uint otgRoomForOne(const OTG_PAIR_SPACE otg_device_pair* pair) {
  return 8 * (pair->a.depth + pair->b.depth) + 8;
}

/// One round: opens as many of the `stacked` pairs as the stack has room for what may come of them; at least one, for
/// which room of eight times the depth of both trees is kept free. So the stack never overflows. `stackSize` counts
/// pairs of nodes. Returns how many are on the stack then. All lanes, with the same arguments.
inline static uint otgWalkRound(__global const float4* meshes, const OTG_PAIR_SPACE otg_device_pair* pair,
                                __local otg_walk* w, __local uint2* stack, uint stackSize, uint stacked,
                                otg_lane_walk* own) {
  const uint lane = get_local_id(0), mostAtOnce = OTG_GROUP / 8, roomForOne = otgRoomForOne(pair);
  const uint room = stackSize - roomForOne > stacked ? (stackSize - roomForOne - stacked) / 7 : 0;
  const uint taken = min(stacked, clamp(room, 1u, mostAtOnce));
  const uint base = stacked - taken, item = lane / 8, k = lane % 8;
  __local uint *pushed = w->pushed + own->rounds % 2, *pushedNext = w->pushed + (own->rounds + 1) % 2;
  uint2 what = (uint2)(0, 0);
  ++own->rounds;
  if (item < taken) what = stack[base + item];
  barrier(CLK_LOCAL_MEM_FENCE);  // all have read before any writes
  // That of the round before has been read by all, too.
  if (lane == 0) *pushedNext = 0;
  if (item < taken && k <= (what.x >> 1 & 7)) {
    const otg_device_pair here = *pair;
    const uint child = what.y + k, other = what.x >> 4;
    const uint2 nodes = what.x & 1 ? (uint2)(child, other) : (uint2)(other, child);
    const otg_node a = otgLoadNode(meshes, here.a.nodes, nodes.x), b = otgLoadNode(meshes, here.b.nodes, nodes.y);
    ++own->boxes;
    if (otgOverlap(&here.boxes, a.center, a.extent, otgMoveBox(&here.boxes, b.center, b.extent))) {
      otgKeepPair(w, stack + base, pushed, nodes, &a, &b);
    }
  }
  barrier(CLK_LOCAL_MEM_FENCE);
  return base + *pushed;
}

/// Test number `t` of a pair of leaves, as many as OTG_LEAF squared: OTG_DISJOINT also where there are not so many
/// triangles. `hit` is the places of the two triangles in their soups, marked if they are undecided.
inline static int otgTestLeaves(__global const float4* meshes, const OTG_PAIR_SPACE otg_device_pair* pair, uint2 leaves,
                                uint t, uint2* hit, otg_lane_walk* own) {
  const otg_device_pair here = *pair;
  const uint i = t / OTG_LEAF, j = t % OTG_LEAF;
  if (i > (leaves.x & 7) || j > (leaves.y & 7)) return OTG_DISJOINT;
  const uint placeA = (leaves.x >> 3) + i, placeB = (leaves.y >> 3) + j;
  const int answer = otgTestTriangles(meshes, &here, placeA, placeB);
  ++own->triangles;
  *hit = (uint2)(placeA | (answer == OTG_UNDECIDED ? OTG_HIT_UNDECIDED : 0), placeB);
  return answer;
}

/// What a work-group counted goes to the counters. All lanes.
inline static void otgEndWalk(__local otg_walk* w, const otg_lane_walk* own, __global uint* counters) {
  if (own->boxes) atomic_add(&w->boxTests, own->boxes);
  if (own->triangles) atomic_add(&w->triangleTests, own->triangles);
  barrier(CLK_LOCAL_MEM_FENCE);
  if (get_local_id(0) != 0) return;
  if (w->boxTests) otgCount(counters + OTG_COUNT_BOX_TESTS, w->boxTests);
  if (w->triangleTests) otgCount(counters + OTG_COUNT_TRIANGLE_TESTS, w->triangleTests);
}

#endif  // OTG_PAIR_STACK_H
