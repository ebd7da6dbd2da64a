// SPDX-License-Identifier: BSD-3-Clause
// Many pairs of meshes at once: one work-group walks one pair of trees, depth-first, and tests the triangles of the
// leaves that it meets. OTG_GROUP is the size of work-groups, a multiple of 8; OTG_LEAF the most triangles of a leaf.
// OTG_SMALL, OTG_MEDIUM: see batchReduce.
#define OTG_PAIR_SPACE __local
#define OTG_FUSED
#include "walk/pair_stack.h"

/// The pair that is the group's: the g-th of the lists that batchPrepare made.
inline static uint otgPairOfGroup(const __local uint* classes, __global const uint* order, uint orderRoom) {
  uint place = get_group_id(0), k = 0;
  while (k < OTG_CLASSES && place >= classes[k]) place -= classes[k++];
  return k < OTG_CLASSES ? order[(size_t)k * orderRoom + place] : OTG_NOT_THERE;
}

/// `stackSize` is as for otgWalkRound, for the deepest two trees of the batch. Hits of a pair lie side by side as long
/// as there are at most OTG_MEDIUM; a pair with more is flagged, and its hits lie anywhere. `list` gets the pairs with
/// more than OTG_SMALL. With `anyHit` a pair is left at the first hit that single precision is sure of: enough to know
/// that it intersects; that is told in its flags in `chosen`, and only undecided hits are listed.
__kernel __attribute__((reqd_work_group_size(OTG_GROUP, 1, 1))) void batchWalk(
    __global const otg_batch_pair* restrict pairs, __global const otg_device_mesh* restrict places,
    const otg_pair_error precision, __global const float4* restrict meshes, __global uint* restrict counters,
    __global const uint* restrict order, uint orderRoom, __global uint* restrict chosen,
    __global otg_pair_state* restrict states, __global uint* restrict list, __global otg_batch_hit* restrict hits,
    uint hitCapacity, uint anyHit, uint stackSize, __local uint2* stack) {
  __local otg_device_pair pair;
  __local otg_walk walk;
  __local uint2 own[OTG_MEDIUM];
  __local uint ownCount, ownBegin, undecided, sure, found;
  __local uint classes[OTG_CLASSES];
  const uint lane = get_local_id(0), lanesPerLeaf = OTG_LEAF * OTG_LEAF;
  // Triangles as soon as all lanes have one pair to test, if one hit ends it all; else more at once.
  const uint enough = anyHit ? max(1u, OTG_GROUP / lanesPerLeaf) : 2 * OTG_GROUP;
  uint stacked = 0;
  for (uint k = lane; k < OTG_CLASSES; k += OTG_GROUP) classes[k] = counters[OTG_COUNT_CLASS + k];
  barrier(CLK_LOCAL_MEM_FENCE);
  if (lane == 0) found = otgPairOfGroup(classes, order, orderRoom);
  barrier(CLK_LOCAL_MEM_FENCE);
  // A work-group without a pair goes through all barriers with nothing to do.
  const int isThere = found != OTG_NOT_THERE;
  const uint number = isThere ? found : 0;
  if (lane < 9) {
    const float r = pairs[number].r[lane];
    pair.boxes.r[lane] = r;
    pair.boxes.absR[lane] = fabs(r);
  }
  if (lane == 0) {
    pair.boxes.t = pairs[number].t;
    pair.boxes.eps = pairs[number].eps;
    pair.error = precision;
    pair.error.delta = pairs[number].delta;
    pair.a = places[pairs[number].meshA];
    pair.b = places[pairs[number].meshB];
  }
  otg_lane_walk tally = otgBeginWalk(&walk);
  if (lane == 0) {
    ownCount = 0;
    undecided = 0;
    sure = 0;
  }
  barrier(CLK_LOCAL_MEM_FENCE);
  if (lane == 0 && isThere) {
    const otg_device_pair here = pair;
    const otg_node a = otgLoadNode(meshes, here.a.nodes, 0), b = otgLoadNode(meshes, here.b.nodes, 0);
    ++tally.boxes;
    if (otgOverlap(&here.boxes, a.center, a.extent, otgMoveBox(&here.boxes, b.center, b.extent))) {
      otgKeepPair(&walk, stack, walk.pushed, (uint2)(0, 0), &a, &b);
    }
  }
  barrier(CLK_LOCAL_MEM_FENCE);
  stacked = walk.pushed[0];
  barrier(CLK_LOCAL_MEM_FENCE);
  if (lane == 0) walk.pushed[0] = 0;
  // `stacked` and the loop itself are the same for all lanes.
  for (int more = stacked > 0 || walk.endedCount > 0; more;) {
    if (stacked > 0) stacked = otgWalkRound(meshes, &pair, &walk, stack, stackSize, stacked, &tally);
    if (walk.endedCount >= enough || stacked == 0) {
      for (uint t = lane; t < walk.endedCount * lanesPerLeaf; t += OTG_GROUP) {
        uint2 hit;
        const int answer = otgTestLeaves(meshes, &pair, walk.ended[t / lanesPerLeaf], t % lanesPerLeaf, &hit, &tally);
        if (answer == OTG_DISJOINT) continue;
        if (anyHit && answer == OTG_INTERSECTING) {
          sure = 1;
          continue;
        }
        if (answer == OTG_UNDECIDED) atomic_inc(&undecided);
        uint slot = atomic_inc(&ownCount);
        if (slot < OTG_MEDIUM) {
          own[slot] = hit;
        } else if ((slot = atomic_inc(counters + OTG_COUNT_HITS)) < hitCapacity) {
          hits[slot].pair = number;
          hits[slot].a = hit.x;
          hits[slot].b = hit.y;
        }
      }
      barrier(CLK_LOCAL_MEM_FENCE);
      if (lane == 0) walk.endedCount = 0;
      if (anyHit && sure > 0) stacked = 0;
      barrier(CLK_LOCAL_MEM_FENCE);
    }
    more = stacked > 0;
  }
  const uint kept = min(ownCount, (uint)OTG_MEDIUM);
  if (lane == 0 && isThere) {
    ownBegin = kept > 0 ? atomic_add(counters + OTG_COUNT_HITS, kept) : 0;
    if (undecided) atomic_add(counters + OTG_COUNT_UNDECIDED, undecided);
    states[number].hits = ownCount;
    states[number].firstHit = ownBegin;
    uint flags = anyHit && sure ? OTG_PAIR_INTERSECTS : 0;
    if (ownCount > OTG_MEDIUM) {
      flags |= OTG_PAIR_MANY;
      atomic_inc(counters + OTG_COUNT_MANY);
    } else if (ownCount > OTG_SMALL) {
      list[atomic_inc(counters + OTG_COUNT_LISTED)] = number;
    }
    if (flags) chosen[OTG_FLAGS + number] |= flags;
  }
  barrier(CLK_LOCAL_MEM_FENCE);
  for (uint i = lane; i < kept; i += OTG_GROUP) {
    if (ownBegin + i >= hitCapacity) continue;
    hits[ownBegin + i].pair = number;
    hits[ownBegin + i].a = own[i].x;
    hits[ownBegin + i].b = own[i].y;
  }
  otgEndWalk(&walk, &tally, counters);
}
