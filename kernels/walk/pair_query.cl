// SPDX-License-Identifier: BSD-3-Clause
// One pair of meshes: the cut of one tree against the cut of the other, two levels of eight by eight children, and the
// rest depth-first within work-groups. These test the triangles of the leaves that they meet.
//
// No kernel waits for another work-group, and the CPU decides nothing in between: each kernel reads on the device how
// much there is to do. OTG_GROUP is the size of work-groups, a multiple of 64.
#define OTG_FUSED
#include "walk/pair_stack.h"
//
#include "shared/layout/walk_given.h"
#include "walk/pair_state.h"

#define OTG_CUT_TILE 4

/// A pair of nodes goes to the list of inner pairs or, if both are leaves, to that of pairs of leaves. Slots are taken
/// once for a whole work-group: a global atomic for each item would cost more than the tests.
typedef struct {
  uint inner, leaves;          // in this round
  uint innerBase, leavesBase;  // in the global lists
  uint tests;                  // of boxes, in all rounds
} otg_round;

/// Where pairs of nodes and pairs of leaves go, and how many of each fit.
typedef struct {
  __global uint* counters;
  __global uint2 *out, *leaves;
  uint outCapacity, leafCapacity;
} otg_open_lists;

inline static otg_open_lists otgOpenLists(__global uint* counters, __global uint2* out, uint outCapacity,
                                          __global uint2* leaves, uint leafCapacity) {
  otg_open_lists lists;
  lists.counters = counters;
  lists.out = out;
  lists.leaves = leaves;
  lists.outCapacity = outCapacity;
  lists.leafCapacity = leafCapacity;
  return lists;
}

/// Opens both nodes of a pair: 64 lanes to it, lane (i, j) for child i of A's node and child j of B's. A leaf is its
/// own only child. `there`: whether the 64 lanes have a pair. Counts in counters[level]. All lanes.
inline static void otgOpenBoth(__global const float4* meshes, const otg_device_pair* pair, __local otg_round* round,
                               uint2 nodes, int there, uint level, const otg_open_lists* to) {
  const uint lane = get_local_id(0), i = lane % 64 / 8, j = lane % 8;
  uint slot = 0;
  int hit = 0, ended = 0;
  uint2 pairOfLeaves = (uint2)(0, 0);
  if (lane == 0) {
    round->inner = 0;
    round->leaves = 0;
  }
  barrier(CLK_LOCAL_MEM_FENCE);
  if (there) {
    otg_node a = otgLoadNode(meshes, pair->a.nodes, nodes.x), b = otgLoadNode(meshes, pair->b.nodes, nodes.y);
    const uint na = a.count < 0 ? 1 : (uint)a.count, nb = b.count < 0 ? 1 : (uint)b.count;
    if (lane % 64 == 0) atomic_add(&round->tests, na * nb);
    if (i < na && j < nb) {
      if (a.count > 0) {
        nodes.x = (uint)a.first + i;
        a = otgLoadNode(meshes, pair->a.nodes, nodes.x);
      }
      if (b.count > 0) {
        nodes.y = (uint)b.first + j;
        b = otgLoadNode(meshes, pair->b.nodes, nodes.y);
      }
      hit = otgOverlap(&pair->boxes, a.center, a.extent, otgMoveBox(&pair->boxes, b.center, b.extent));
      ended = a.count < 0 && b.count < 0;
      if (ended) pairOfLeaves = otgPairOfLeaves(&a, &b);
    }
  }
  if (hit) slot = atomic_inc(ended ? &round->leaves : &round->inner);
  barrier(CLK_LOCAL_MEM_FENCE);
  if (lane == 0 && round->inner) round->innerBase = atomic_add(to->counters + level, round->inner);
  if (lane == 32 && round->leaves) round->leavesBase = atomic_add(to->counters + OTG_COUNT_LEAVES, round->leaves);
  barrier(CLK_LOCAL_MEM_FENCE);
  if (hit && ended) {
    slot += round->leavesBase;
    if (slot < to->leafCapacity) to->leaves[slot] = pairOfLeaves;
  } else if (hit) {
    slot += round->innerBase;
    if (slot < to->outCapacity) to->out[slot] = nodes;
  }
  barrier(CLK_LOCAL_MEM_FENCE);
}

/// Some nodes of B's cut.
typedef struct {
  otg_moved_box boxes[OTG_CUT_TILE];
  int2 nodes[OTG_CUT_TILE];  // number, count
} otg_cut_tile;

/// Whether a pair of a node of A and node `k` of the tile is one of leaves.
inline static int otgEndsInTile(const otg_node* a, __local const otg_cut_tile* tile, uint k) {
  return a->count < 0 && tile->nodes[k].y < 0;
}

/// What overlaps of a tile: a bit for each of its nodes, how many of them make a pair of inner nodes and of leaves.
typedef struct {
  uint mask, inner, ended;
} otg_tile_hits;

/// A node of A's cut against the first `count` of the tile.
inline static otg_tile_hits otgTestTile(const otg_device_pair* pair, const otg_node* a,
                                        __local const otg_cut_tile* tile, uint count) {
  otg_tile_hits hits = {0, 0, 0};
  for (uint k = 0; k < count; ++k) {
    if (!otgOverlap(&pair->boxes, a->center, a->extent, tile->boxes[k])) continue;
    hits.mask |= 1u << k;
    if (otgEndsInTile(a, tile, k)) {
      ++hits.ended;
    } else {
      ++hits.inner;
    }
  }
  return hits;
}

/// A pair of leaves of the cuts, which name them by their numbers, goes to place `slot` of the list.
inline static void otgListLeaves(__global const float4* meshes, const otg_device_pair* pair, uint2 nodes, uint slot,
                                 const otg_open_lists* to) {
  const otg_node a = otgLoadNode(meshes, pair->a.nodes, nodes.x), b = otgLoadNode(meshes, pair->b.nodes, nodes.y);
  if (slot < to->leafCapacity) to->leaves[slot] = otgPairOfLeaves(&a, &b);
}

/// Cut against cut, and the beginning of a query. Dimension 0: nodes of A's cut. Dimension 1: tiles of OTG_CUT_TILE
/// nodes of B's. With `opens` each work-group goes on with the first level for the pairs that it found: few, because
/// cuts are in shuffled order. `out` gets the pairs of the level, else of the cut.
__kernel __attribute__((reqd_work_group_size(OTG_GROUP, 1, 1))) void pairCut(OTG_GIVEN(PairCut)) {
  __local otg_cut_tile tile;
  __local uint2 found[OTG_GROUP * OTG_CUT_TILE];
  __local otg_round round;
  const uint lane = get_local_id(0), i = get_global_id(0), pairsAtOnce = OTG_GROUP / 64;
  const uint firstB = get_group_id(1) * OTG_CUT_TILE, tiled = min((uint)OTG_CUT_TILE, pair.b.cutCount - firstB);
  const otg_open_lists to = otgOpenLists(counters, out, outCapacity, leaves, leafCapacity);
  otg_tile_hits own = {0, 0, 0};
  otg_node a;
  if (i == 0 && get_group_id(1) == 0) {
    otgResetState(state, 0, &pair.a, &pair.b);
    chosen[OTG_FLAGS] = otgFirstFlags(&pair.a, &pair.b, method);
  }
  if (lane < tiled) {
    const otg_node b = otgLoadNode(meshes, pair.b.cut, firstB + lane);
    tile.boxes[lane] = otgMoveBox(&pair.boxes, b.center, b.extent);
    tile.nodes[lane] = (int2)(b.first, b.count);
  }
  if (lane == 0) {
    round.inner = 0;
    round.leaves = 0;
    round.tests = min((uint)OTG_GROUP, pair.a.cutCount - (uint)get_group_id(0) * OTG_GROUP) * tiled;
  }
  barrier(CLK_LOCAL_MEM_FENCE);
  if (i < pair.a.cutCount) {
    a = otgLoadNode(meshes, pair.a.cut, i);
    own = otgTestTile(&pair, &a, &tile, tiled);
  }
  // From here on: places in the lists.
  uint inner = own.inner ? atomic_add(&round.inner, own.inner) : 0;
  uint ended = own.ended ? atomic_add(&round.leaves, own.ended) : 0;
  barrier(CLK_LOCAL_MEM_FENCE);
  const uint count = opens ? round.inner : 0;
  if (lane == 0) round.innerBase = !opens && round.inner ? atomic_add(counters + OTG_COUNT_LEVEL0, round.inner) : 0;
  if (lane == 32) round.leavesBase = round.leaves ? atomic_add(counters + OTG_COUNT_LEAVES, round.leaves) : 0;
  barrier(CLK_LOCAL_MEM_FENCE);
  inner += round.innerBase;
  ended += round.leavesBase;
  for (uint k = 0; k < tiled; ++k) {
    if (!(own.mask >> k & 1)) continue;
    const uint2 nodes = (uint2)(a.first, tile.nodes[k].x);
    if (otgEndsInTile(&a, &tile, k)) {
      otgListLeaves(meshes, &pair, nodes, ended++, &to);
    } else {
      if (opens) {
        found[inner] = nodes;
      } else if (inner < outCapacity) {
        out[inner] = nodes;
      }
      ++inner;
    }
  }
  barrier(CLK_LOCAL_MEM_FENCE);
  for (uint begin = 0; begin < count; begin += pairsAtOnce) {
    const uint item = begin + lane / 64;
    const int there = item < count;
    otgOpenBoth(meshes, &pair, &round, there ? found[item] : (uint2)(0, 0), there, OTG_COUNT_LEVEL1, &to);
  }
  if (lane == 0) otgCount(counters + OTG_COUNT_BOX_TESTS, round.tests);
}

/// Opens both nodes of each pair of counters[level]: see otgOpenBoth.
__kernel __attribute__((reqd_work_group_size(OTG_GROUP, 1, 1))) void pairLevel(OTG_GIVEN(PairLevel)) {
  __local otg_round round;
  const uint lane = get_local_id(0), pairsAtOnce = OTG_GROUP / 64;
  const uint count = min(counters[level], inCapacity);
  const otg_open_lists to = otgOpenLists(counters, out, outCapacity, leaves, leafCapacity);
  if (lane == 0) round.tests = 0;
  for (uint begin = get_group_id(0) * pairsAtOnce; begin < count; begin += get_num_groups(0) * pairsAtOnce) {
    const uint item = begin + lane / 64;
    const int there = item < count;
    otgOpenBoth(meshes, &pair, &round, there ? in[item] : (uint2)(0, 0), there, level + 1, &to);
  }
  if (lane == 0 && round.tests) otgCount(counters + OTG_COUNT_BOX_TESTS, round.tests);
}

/// Where hits go, and how many are enough for the CPU to do the pair.
typedef struct {
  __global uint* counters;
  __global uint2* hits;
  uint capacity, most;
} otg_tail_hits;

/// Tests triangles and lists those that may intersect. `isCut` becomes 1 if there are too many.
inline static void otgTestAndList(__global const float4* meshes, const otg_device_pair* pair, uint2 leaves, uint t,
                                  const otg_tail_hits* to, __local uint* isCut, otg_lane_walk* own) {
  uint2 hit;
  const int answer = otgTestLeaves(meshes, pair, leaves, t, &hit, own);
  if (answer == OTG_DISJOINT) return;
  const uint slot = otgTakeHit(to->counters, answer);
  if (slot < to->capacity) to->hits[slot] = hit;
  if (slot >= to->most) atomic_xchg(isCut, 1);
}

/// What `level` levels leave (counters[level] pairs), depth-first: see otgWalkRound. Each work-group begins with as
/// many pairs as it can open at once. They are taken from all over the list, so that no group has all those of one
/// place; what is left of a long list is taken by ticket. A work-group ends where it lists a hit beyond the first
/// `mostHits`.
__kernel __attribute__((reqd_work_group_size(OTG_GROUP, 1, 1))) void pairTail(OTG_GIVEN(PairTail)) {
  __local otg_walk walk;
  __local uint firstSeed, isCut;
  const uint lane = get_local_id(0), group = get_group_id(0), groups = get_num_groups(0);
  const uint lanesPerLeaf = OTG_LEAF * OTG_LEAF, perTicket = OTG_GROUP / 16;
  const uint seedCount = min(counters[level], seedCapacity);
  const uint leafCount = min(counters[OTG_COUNT_LEAVES], leafCapacity);
  const uint share = min((uint)OTG_GROUP / 8, stackSize - otgRoomForOne(&pair)), dealt = share * groups;
  const otg_tail_hits to = {counters, hits, hitCapacity, mostHits};
  otg_lane_walk own = otgBeginWalk(&walk);
  int more = seedCount > dealt;
  uint stacked = seedCount > group ? min(share, (seedCount - group - 1) / groups + 1) : 0;
  if (lane < stacked) stack[lane] = otgPairToOpenOf(meshes, &pair, seeds[group + lane * groups]);
  if (lane == 0) isCut = 0;
  barrier(CLK_LOCAL_MEM_FENCE);
  // The leaves that the levels met.
  for (uint t = get_global_id(0); t < leafCount * lanesPerLeaf; t += get_global_size(0)) {
    otgTestAndList(meshes, &pair, leaves[t / lanesPerLeaf], t % lanesPerLeaf, &to, &isCut, &own);
  }
  barrier(CLK_LOCAL_MEM_FENCE);
  // `more`, `stacked` and the loop itself are the same for all lanes of a group.
  while (!isCut && (more || stacked > 0)) {
    if (more && stacked < perTicket) {
      if (lane == 0) firstSeed = dealt + atomic_add(counters + OTG_COUNT_SEED_TICKET, perTicket);
      barrier(CLK_LOCAL_MEM_FENCE);
      more = firstSeed < seedCount;
      const uint taken = more ? min(perTicket, seedCount - firstSeed) : 0;
      if (lane < taken) stack[stacked + lane] = otgPairToOpenOf(meshes, &pair, seeds[firstSeed + lane]);
      stacked += taken;
      barrier(CLK_LOCAL_MEM_FENCE);
    }
    if (stacked > 0) stacked = otgWalkRound(meshes, &pair, &walk, stack, stackSize, stacked, &own);
    // Triangles when all lanes have some to test, or there is nothing else left to do.
    if (walk.endedCount >= 2 * OTG_GROUP || (!more && stacked == 0)) {
      for (uint t = lane; t < walk.endedCount * lanesPerLeaf; t += OTG_GROUP) {
        otgTestAndList(meshes, &pair, walk.ended[t / lanesPerLeaf], t % lanesPerLeaf, &to, &isCut, &own);
      }
      barrier(CLK_LOCAL_MEM_FENCE);
      if (lane == 0) walk.endedCount = 0;
      barrier(CLK_LOCAL_MEM_FENCE);
    }
  }
  otgEndWalk(&walk, &own, counters);
}
