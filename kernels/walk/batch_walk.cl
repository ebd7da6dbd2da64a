// SPDX-License-Identifier: BSD-3-Clause
// Many pairs of meshes at once: one work-group walks one pair of trees, depth-first, and tests the triangles of the
// leaves that it meets. OTG_GROUP is the size of work-groups, a multiple of 8; OTG_LEAF the most triangles of a leaf.
// OTG_SMALL, OTG_MEDIUM: see batchReduce.
#define OTG_PAIR_SPACE __local
#define OTG_FUSED
#include "walk/pair_stack.h"
//
#include "shared/layout/walk_given.h"

/// The pair that is the group's: the g-th of the lists that batchPrepare made.
inline static uint otgPairOfGroup(const __local uint* classes, __global const uint* order, uint orderRoom) {
  uint place = get_group_id(0), k = 0;
  while (k < OTG_CLASSES && place >= classes[k]) place -= classes[k++];
  return k < OTG_CLASSES ? order[(size_t)k * orderRoom + place] : OTG_NOT_THERE;
}

/// Sets what lies in local memory of a pair. All lanes; a barrier comes after it.
inline static void otgSetPair(__local otg_device_pair* pair, __global const otg_batch_pair* given,
                              __global const otg_device_mesh* places, otg_pair_error precision) {
  const uint lane = get_local_id(0);
  if (lane < 9) {
    const float r = given->r[lane];
    pair->boxes.r[lane] = r;
    pair->boxes.absR[lane] = fabs(r);
  }
  if (lane == 0) {
    pair->boxes.t = given->t;
    pair->boxes.eps = given->eps;
    pair->error = precision;
    pair->error.delta = given->delta;
    pair->a = places[given->meshA];
    pair->b = places[given->meshB];
  }
}

/// The two roots. One lane.
inline static void otgTestRoots(__global const float4* meshes, const __local otg_device_pair* pair,
                                __local otg_walk* walk, __local uint2* stack, otg_lane_walk* tally) {
  const otg_device_pair here = *pair;
  const otg_node a = otgLoadNode(meshes, here.a.nodes, 0), b = otgLoadNode(meshes, here.b.nodes, 0);
  ++tally->boxes;
  if (otgOverlap(&here.boxes, a.center, a.extent, otgMoveBox(&here.boxes, b.center, b.extent))) {
    otgKeepPair(walk, stack, walk->pushed, (uint2)(0, 0), &a, &b);
  }
}

/// The hits of a pair, as far as they lie side by side; how many there are, how many of them single precision cannot
/// decide, and whether there is one that it is sure of.
typedef struct {
  uint2 hits[OTG_MEDIUM];
  uint count, undecided, sure;
} otg_own_hits;

/// The list of the hits of all pairs, and the number of the pair whose hits come.
typedef struct {
  __global otg_batch_hit* hits;
  __global uint* counters;
  uint capacity, pair;
} otg_hit_list;

/// Hits beyond the capacity are counted only.
inline static void otgListHit(const otg_hit_list* list, uint slot, uint2 hit) {
  if (slot >= list->capacity) return;
  list->hits[slot].pair = list->pair;
  list->hits[slot].a = hit.x;
  list->hits[slot].b = hit.y;
}

/// The triangles of the pairs of leaves that were met. All lanes.
inline static void otgTestEnded(__global const float4* meshes, const __local otg_device_pair* pair,
                                const __local otg_walk* walk, uint anyHit, __local otg_own_hits* own,
                                const otg_hit_list* list, otg_lane_walk* tally) {
  const uint lanesPerLeaf = OTG_LEAF * OTG_LEAF;
  for (uint t = get_local_id(0); t < walk->endedCount * lanesPerLeaf; t += OTG_GROUP) {
    uint2 hit;
    const int answer = otgTestLeaves(meshes, pair, walk->ended[t / lanesPerLeaf], t % lanesPerLeaf, &hit, tally);
    if (answer == OTG_DISJOINT) continue;
    if (anyHit && answer == OTG_INTERSECTING) {
      own->sure = 1;
      continue;
    }
    if (answer == OTG_UNDECIDED) atomic_inc(&own->undecided);
    const uint slot = atomic_inc(&own->count);
    if (slot < OTG_MEDIUM) {
      own->hits[slot] = hit;
    } else {
      otgListHit(list, atomic_inc(list->counters + OTG_COUNT_HITS), hit);
    }
  }
}

/// Reports what is known of a pair beside its hits. One lane. With OTG_SMALL hits or fewer it is not in `listed`.
inline static void otgFlagPair(const __local otg_own_hits* own, const otg_hit_list* list, __global uint* listed,
                               __global uint* chosen, uint anyHit, uint most) {
  uint flags = anyHit && own->sure ? OTG_PAIR_INTERSECTS : 0;
  const int isCut = own->count > most;
  if (own->undecided) atomic_add(list->counters + OTG_COUNT_UNDECIDED, own->undecided);
  if (isCut) {
    flags |= OTG_PAIR_TO_HOST | OTG_PAIR_NO_FRAME;
    atomic_inc(list->counters + OTG_COUNT_FLAGGED);
  } else if (own->count > OTG_MEDIUM) {
    flags |= OTG_PAIR_MANY;
    atomic_inc(list->counters + OTG_COUNT_MANY);
  } else if (own->count > OTG_SMALL) {
    listed[atomic_inc(list->counters + OTG_COUNT_LISTED)] = list->pair;
  }
  if (flags) chosen[OTG_FLAGS + list->pair] |= flags;
}

/// `stackSize` is as for otgWalkRound, for the deepest two trees of the batch. Hits of a pair lie side by side as long
/// as there are at most OTG_MEDIUM; a pair with more is flagged, and its hits lie anywhere. `listed` gets the pairs
/// with more than OTG_SMALL. With `anyHit` a pair is left at the first hit that single precision is sure of: enough to
/// know that it intersects; its flags in `chosen` say so, and only undecided hits are listed. A pair with more
/// than `mostHits` is left, too: the CPU does all of it.
__kernel __attribute__((reqd_work_group_size(OTG_GROUP, 1, 1))) void batchWalk(OTG_GIVEN(BatchWalk)) {
  __local otg_device_pair pair;
  __local otg_walk walk;
  __local otg_own_hits own;
  __local uint ownBegin, found;
  __local uint classes[OTG_CLASSES];
  const uint lane = get_local_id(0);
  // Triangles as soon as all lanes have one pair to test, if one hit ends it all; else more at once.
  const uint enough = anyHit ? max(1u, (uint)(OTG_GROUP / (OTG_LEAF * OTG_LEAF))) : 2 * OTG_GROUP;
  uint stacked = 0;
  for (uint k = lane; k < OTG_CLASSES; k += OTG_GROUP) classes[k] = counters[OTG_COUNT_CLASS + k];
  barrier(CLK_LOCAL_MEM_FENCE);
  if (lane == 0) found = otgPairOfGroup(classes, order, orderRoom);
  barrier(CLK_LOCAL_MEM_FENCE);
  // A work-group without a pair goes through all barriers with nothing to do.
  const int isThere = found != OTG_NOT_THERE;
  const uint number = isThere ? found : 0;
  const otg_hit_list list = {hits, counters, hitCapacity, number};
  otgSetPair(&pair, pairs + number, places, precision);
  otg_lane_walk tally = otgBeginWalk(&walk);
  if (lane == 0) {
    own.count = 0;
    own.undecided = 0;
    own.sure = 0;
  }
  barrier(CLK_LOCAL_MEM_FENCE);
  if (lane == 0 && isThere) otgTestRoots(meshes, &pair, &walk, stack, &tally);
  barrier(CLK_LOCAL_MEM_FENCE);
  stacked = walk.pushed[0];
  barrier(CLK_LOCAL_MEM_FENCE);
  if (lane == 0) walk.pushed[0] = 0;
  // `stacked` and the loop itself are the same for all lanes.
  for (int more = stacked > 0 || walk.endedCount > 0; more;) {
    if (stacked > 0) stacked = otgWalkRound(meshes, &pair, &walk, stack, stackSize, stacked, &tally);
    if (walk.endedCount >= enough || stacked == 0) {
      otgTestEnded(meshes, &pair, &walk, anyHit, &own, &list, &tally);
      barrier(CLK_LOCAL_MEM_FENCE);
      if (lane == 0) walk.endedCount = 0;
      if ((anyHit && own.sure > 0) || own.count > mostHits) stacked = 0;
      barrier(CLK_LOCAL_MEM_FENCE);
    }
    more = stacked > 0;
  }
  const uint kept = min(own.count, (uint)OTG_MEDIUM);
  if (lane == 0 && isThere) {
    ownBegin = kept > 0 ? atomic_add(counters + OTG_COUNT_HITS, kept) : 0;
    states[number].hits = own.count;
    states[number].firstHit = ownBegin;
    otgFlagPair(&own, &list, listed, chosen, anyHit, mostHits);
  }
  barrier(CLK_LOCAL_MEM_FENCE);
  for (uint i = lane; i < kept; i += OTG_GROUP) otgListHit(&list, ownBegin + i, own.hits[i]);
  otgEndWalk(&walk, &tally, counters);
}
