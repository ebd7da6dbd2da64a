// SPDX-License-Identifier: BSD-3-Clause
// One pair of meshes: the cut of one tree against the cut of the other, two levels of eight by eight children, and the
// rest depth-first within work-groups, which test the triangles of the leaves that they meet.
//
// No kernel waits for another work-group, and the host decides nothing in between: each kernel reads on the device how
// much there is to do. OTG_GROUP is the size of work-groups, a multiple of 64.
#include "pair_walk.h"
//
#include "pair_state.h"

#define OTG_CUT_TILE 16

/// A pair of nodes goes to the list of inner pairs or, if both are leaves, to that of pairs of leaves. Slots are taken
/// once for a whole work-group: a global atomic for each item would cost more than the tests.
typedef struct {
  uint inner, leaves;          // in this round
  uint innerBase, leavesBase;  // in the global lists
} otg_round;

/// Cut against cut, and the beginning of a query. Dimension 0: nodes of A's cut. Dimension 1: tiles of OTG_CUT_TILE
/// nodes of B's.
__kernel __attribute__((reqd_work_group_size(OTG_GROUP, 1, 1))) void pairCut(
    const otg_device_pair pair, __global const float4* restrict meshes, __global uint* restrict counters,
    __global uint2* restrict out, uint outCapacity, __global uint2* restrict leaves, uint leafCapacity,
    __global otg_pair_state* restrict state, __global uint* restrict chosen, uint method) {
  __local otg_moved_box boxes[OTG_CUT_TILE];
  __local int2 nodesB[OTG_CUT_TILE];  // number, count
  __local otg_round round;
  const uint lane = get_local_id(0), i = get_global_id(0);
  const uint firstB = get_group_id(1) * OTG_CUT_TILE;
  const uint tile = min((uint)OTG_CUT_TILE, pair.b.cutCount - firstB);
  uint mask = 0, inner = 0, ended = 0;
  otg_node a;
  if (i == 0 && get_group_id(1) == 0) {
    otgResetState(state, 0, &pair.a, &pair.b);
    chosen[OTG_FLAGS] = otgFirstFlags(&pair.a, &pair.b, method);
  }
  if (lane < tile) {
    const otg_node b = otgLoadNode(meshes, pair.b.cut, firstB + lane);
    boxes[lane] = otgMoveBox(&pair.boxes, b.center, b.extent);
    nodesB[lane] = (int2)(b.first, b.count);
  }
  if (lane == 0) {
    round.inner = 0;
    round.leaves = 0;
  }
  barrier(CLK_LOCAL_MEM_FENCE);
  if (i < pair.a.cutCount) {
    a = otgLoadNode(meshes, pair.a.cut, i);
    for (uint k = 0; k < tile; ++k) {
      if (!otgOverlap(&pair.boxes, a.center, a.extent, boxes[k])) continue;
      mask |= 1u << k;
      if (a.count < 0 && nodesB[k].y < 0) {
        ++ended;
      } else {
        ++inner;
      }
    }
  }
  if (inner) inner = atomic_add(&round.inner, inner);
  if (ended) ended = atomic_add(&round.leaves, ended);
  barrier(CLK_LOCAL_MEM_FENCE);
  if (lane == 0) {
    const uint width = min((uint)OTG_GROUP, pair.a.cutCount - (uint)get_group_id(0) * OTG_GROUP);
    round.innerBase = atomic_add(counters + OTG_COUNT_LEVEL0, round.inner);
    otgCount(counters + OTG_COUNT_BOX_TESTS, width * tile);
  }
  if (lane == 32) round.leavesBase = atomic_add(counters + OTG_COUNT_LEAVES, round.leaves);
  barrier(CLK_LOCAL_MEM_FENCE);
  inner += round.innerBase;
  ended += round.leavesBase;
  for (uint k = 0; k < tile; ++k) {
    if (!(mask >> k & 1)) continue;
    if (a.count < 0 && nodesB[k].y < 0) {
      if (ended < leafCapacity) leaves[ended] = (uint2)(a.first, nodesB[k].x);
      ++ended;
    } else {
      if (inner < outCapacity) out[inner] = (uint2)(a.first, nodesB[k].x);
      ++inner;
    }
  }
}

/// Opens both nodes of each pair of counters[level]: 64 lanes to a pair, lane (i, j) for child i of A's node and child
/// j of B's. A leaf is its own only child.
__kernel __attribute__((reqd_work_group_size(OTG_GROUP, 1, 1))) void pairLevel(
    const otg_device_pair pair, __global const float4* restrict meshes, __global uint* restrict counters, uint level,
    __global const uint2* restrict in, uint inCapacity, __global uint2* restrict out, uint outCapacity,
    __global uint2* restrict leaves, uint leafCapacity) {
  __local otg_round round;
  __local uint tests;
  const uint lane = get_local_id(0), pairsAtOnce = OTG_GROUP / 64;
  const uint count = min(counters[level], inCapacity);
  if (lane == 0) tests = 0;
  for (uint begin = get_group_id(0) * pairsAtOnce; begin < count; begin += get_num_groups(0) * pairsAtOnce) {
    const uint item = begin + lane / 64, i = lane % 64 / 8, j = lane % 8;
    uint slot = 0;
    int hit = 0, ended = 0;
    uint2 next = (uint2)(0, 0);
    if (lane == 0) {
      round.inner = 0;
      round.leaves = 0;
    }
    barrier(CLK_LOCAL_MEM_FENCE);
    if (item < count) {
      const uint2 nodes = in[item];
      otg_node a = otgLoadNode(meshes, pair.a.nodes, nodes.x), b = otgLoadNode(meshes, pair.b.nodes, nodes.y);
      const uint na = a.count < 0 ? 1 : (uint)a.count, nb = b.count < 0 ? 1 : (uint)b.count;
      if (lane % 64 == 0) atomic_add(&tests, na * nb);
      if (i < na && j < nb) {
        next = nodes;
        if (a.count > 0) {
          next.x = (uint)a.first + i;
          a = otgLoadNode(meshes, pair.a.nodes, next.x);
        }
        if (b.count > 0) {
          next.y = (uint)b.first + j;
          b = otgLoadNode(meshes, pair.b.nodes, next.y);
        }
        hit = otgOverlap(&pair.boxes, a.center, a.extent, otgMoveBox(&pair.boxes, b.center, b.extent));
        ended = a.count < 0 && b.count < 0;
      }
    }
    if (hit) slot = atomic_inc(ended ? &round.leaves : &round.inner);
    barrier(CLK_LOCAL_MEM_FENCE);
    if (lane == 0 && round.inner) round.innerBase = atomic_add(counters + level + 1, round.inner);
    if (lane == 32 && round.leaves) round.leavesBase = atomic_add(counters + OTG_COUNT_LEAVES, round.leaves);
    barrier(CLK_LOCAL_MEM_FENCE);
    if (hit && ended) {
      slot += round.leavesBase;
      if (slot < leafCapacity) leaves[slot] = next;
    } else if (hit) {
      slot += round.innerBase;
      if (slot < outCapacity) out[slot] = next;
    }
    barrier(CLK_LOCAL_MEM_FENCE);
  }
  if (lane == 0 && tests) otgCount(counters + OTG_COUNT_BOX_TESTS, tests);
}

/// Triangle `i` of A's leaf against triangle `j` of B's, if they have so many. Returns the number of tests.
inline static uint otgTestLeaves(const otg_device_pair* pair, __global const float4* meshes, uint2 nodes, uint i,
                                 uint j, __global uint* counters, __global uint2* hits, uint hitCapacity) {
  const otg_node a = otgLoadNode(meshes, pair->a.nodes, nodes.x), b = otgLoadNode(meshes, pair->b.nodes, nodes.y);
  if ((int)i >= -a.count || (int)j >= -b.count) return 0;
  const uint placeA = (uint)a.first + i, placeB = (uint)b.first + j;
  const int answer = otgTestTriangles(meshes, pair, placeA, placeB);
  if (answer != OTG_DISJOINT) {
    const uint slot = otgTakeHit(counters, answer);
    if (slot < hitCapacity) hits[slot] = (uint2)(placeA | (answer == OTG_UNDECIDED ? OTG_HIT_UNDECIDED : 0), placeB);
  }
  return 1;
}

/// What the two levels leave, depth-first: eight lanes open the larger box of one pair. A work-group takes as many
/// pairs off its stack at once as the stack has room for what may come of them; at least one, for which room of eight
/// times the depth of both trees is kept free. So the stack never overflows. `stackSize` counts pairs of nodes.
__kernel __attribute__((reqd_work_group_size(OTG_GROUP, 1, 1))) void pairTail(
    const otg_device_pair pair, __global const float4* restrict meshes, __global uint* restrict counters,
    __global const uint2* restrict seeds, uint seedCapacity, __global const uint2* restrict leaves, uint leafCapacity,
    __global uint2* restrict hits, uint hitCapacity, uint stackSize, __local uint2* stack) {
  __local uint2 ended[3 * OTG_GROUP];
  __local uint pushed, endedCount, boxTests, triangleTests, firstSeed;
  const uint lane = get_local_id(0), lanesPerLeaf = OTG_LEAF * OTG_LEAF;
  const uint seedCount = min(counters[OTG_COUNT_LEVEL2], seedCapacity);
  const uint leafCount = min(counters[OTG_COUNT_LEAVES], leafCapacity);
  const uint roomForOne = 8 * (pair.a.depth + pair.b.depth) + 8;
  const uint mostAtOnce = OTG_GROUP / 8;
  // Few seeds for many groups: one at a time, else the unlucky group decides the time. Many: several for one ticket.
  const uint perTicket = clamp(seedCount / (4 * (uint)get_num_groups(0)), 1u, mostAtOnce);
  uint tested = 0, stacked = 0;
  int more = 1, firstTicket = 1;
  if (lane == 0) {
    endedCount = 0;
    boxTests = 0;
    triangleTests = 0;
    pushed = 0;
  }
  // The leaves that the levels met.
  for (uint t = get_global_id(0); t < leafCount * lanesPerLeaf; t += get_global_size(0)) {
    tested += otgTestLeaves(&pair, meshes, leaves[t / lanesPerLeaf], t % lanesPerLeaf / OTG_LEAF, t % OTG_LEAF,
                            counters, hits, hitCapacity);
  }
  barrier(CLK_LOCAL_MEM_FENCE);
  // `more`, `stacked` and the loop itself are the same for all lanes of a group.
  while (more || stacked > 0) {
    if (stacked == 0) {
      if (lane == 0) {
        firstSeed = firstTicket
                        ? (uint)get_group_id(0) * perTicket
                        : get_num_groups(0) * perTicket + atomic_add(counters + OTG_COUNT_SEED_TICKET, perTicket);
      }
      barrier(CLK_LOCAL_MEM_FENCE);
      firstTicket = 0;
      more = firstSeed < seedCount;
      stacked = more ? min(perTicket, seedCount - firstSeed) : 0;
      if (lane < stacked) stack[lane] = seeds[firstSeed + lane];
      barrier(CLK_LOCAL_MEM_FENCE);
    }
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
    // Triangles when all lanes have some to test, or there is nothing else left to do.
    if (endedCount >= 2 * OTG_GROUP || (!more && stacked == 0)) {
      for (uint t = lane; t < endedCount * lanesPerLeaf; t += OTG_GROUP) {
        tested += otgTestLeaves(&pair, meshes, ended[t / lanesPerLeaf], t % lanesPerLeaf / OTG_LEAF, t % OTG_LEAF,
                                counters, hits, hitCapacity);
      }
      barrier(CLK_LOCAL_MEM_FENCE);
      if (lane == 0) endedCount = 0;
    }
    barrier(CLK_LOCAL_MEM_FENCE);
  }
  if (tested) atomic_add(&triangleTests, tested);
  barrier(CLK_LOCAL_MEM_FENCE);
  if (lane == 0 && boxTests) otgCount(counters + OTG_COUNT_BOX_TESTS, boxTests);
  if (lane == 0 && triangleTests) otgCount(counters + OTG_COUNT_TRIANGLE_TESTS, triangleTests);
}
