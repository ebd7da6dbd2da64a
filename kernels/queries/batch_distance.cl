// SPDX-License-Identifier: BSD-3-Clause
// The nearest triangles of many pairs of meshes that are apart: a work-group to a pair, both trees depth-first. As
// queries/mesh_distance.cpp, through the eight-wide trees, boxes in single precision and triangles in double.
// OTG_GROUP is the size of work-groups, a multiple of 8; OTG_LEAF the most triangles of a leaf.
#define OTG_PAIR_SPACE __local
#define OTG_FUSED
#include "walk/pair_walk.h"
#include "shared/layout/queries_given.h"
#define OTG_REAL_DOUBLE
#include "shared/tests/triangle_distance.h"
#undef OTG_REAL_DOUBLE

/// Pairs of leaves that are kept until all work-items have triangles to test.
#define OTG_LEAVES_AT_ONCE (OTG_GROUP / (OTG_LEAF * OTG_LEAF) > 0 ? OTG_GROUP / (OTG_LEAF * OTG_LEAF) : 1)

inline static otg_vec3_d otgCornerOf(float4 v) {
  return otgVec_d((double)v.x, (double)v.y, (double)v.z);
}

/// Of a number that is not negative.
inline static float otgRoundedUp(double x) {
  const float down = convert_float_rtz(x);
  return (double)down < x ? as_float(as_uint(down) + 1) : down;
}

/// No more than the distance of what is in two boxes; negative for boxes that overlap, and more so where they do so
/// more.
inline static float otgBoxesApart(const otg_box_frame_f* frame, const otg_node* a, const otg_node* b) {
  const otg_vec3_f d = otgSub_f(otgBoxCenterInA_f(*frame, b->center), a->center);
  const float squared = otgBoxDistance2Below_f(*frame, d, a->extent, b->extent);
  if (squared > 0) return sqrt(squared) * (1 - 2e-6f) - frame->eps;
  return max(otgBoxGapA_f(d, a->extent, otgBoxExtentInA_f(*frame, b->extent)),
             otgBoxGapB_f(*frame, d, a->extent, b->extent)) -
         frame->eps;
}

/// One pair of meshes.
typedef struct {
  otg_distance_task task;
  otg_device_mesh a, b;
} otg_apart_pair;

/// What one round keeps: pairs of nodes and of leaves, and lower bounds of their distances. `limitBits`: of the
/// distance beyond which nothing is looked for; distances are not negative, so that they have the order of their bits.
typedef struct {
  uint2 kept[OTG_GROUP], leaves[OTG_GROUP + OTG_LEAVES_AT_ONCE];
  float keptGaps[OTG_GROUP], leafGaps[OTG_GROUP + OTG_LEAVES_AT_ONCE];
  uint keptCount, leafCount, limitBits;
} otg_apart_round;

/// Sets both, and puts the two roots on the stack or into the list of leaves. One lane.
inline static void otgBeginApart(__global const otg_distance_task* given, __global const otg_device_mesh* places,
                                 __global const float4* meshes, __local otg_apart_pair* pair,
                                 __local otg_apart_round* round, __local uint2* stack, __local float* stackGaps) {
  pair->task = *given;
  pair->a = places[given->meshA];
  pair->b = places[given->meshB];
  round->keptCount = 0;
  round->leafCount = 0;
  round->limitBits = as_uint(otgRoundedUp(pair->task.limit));
  const otg_node a = otgLoadNode(meshes, pair->a.nodes, 0), b = otgLoadNode(meshes, pair->b.nodes, 0);
  if (pair->task.limit < 0) {
    // Left to the CPU.
  } else if (a.count < 0 && b.count < 0) {
    round->leaves[0] = otgPairOfLeaves(&a, &b);
    round->leafGaps[0] = -INFINITY;
    round->leafCount = 1;
  } else {
    stack[0] = (uint2)(0, 0);
    stackGaps[0] = -INFINITY;
    round->keptCount = 1;
  }
}

/// Opens the larger box of a pair of nodes, and keeps its child `k` with the other one if they may be near enough.
inline static void otgOpenApart(__global const float4* meshes, __local const otg_apart_pair* pair, uint2 nodes, uint k,
                                __local otg_apart_round* round) {
  const otg_box_frame_f frame = pair->task.boxes;
  otg_node a = otgLoadNode(meshes, pair->a.nodes, nodes.x), b = otgLoadNode(meshes, pair->b.nodes, nodes.y);
  const int openA = b.count < 0 || (a.count > 0 && otgArea(a.extent) >= otgArea(b.extent));
  if (k >= (uint)(openA ? a.count : b.count)) return;
  if (openA) {
    nodes.x = (uint)a.first + k;
    a = otgLoadNode(meshes, pair->a.nodes, nodes.x);
  } else {
    nodes.y = (uint)b.first + k;
    b = otgLoadNode(meshes, pair->b.nodes, nodes.y);
  }
  const float gap = otgBoxesApart(&frame, &a, &b);
  if (!(gap <= as_float(round->limitBits))) return;
  if (a.count < 0 && b.count < 0) {
    const uint slot = atomic_inc(&round->leafCount);
    round->leaves[slot] = otgPairOfLeaves(&a, &b);
    round->leafGaps[slot] = gap;
  } else {
    const uint slot = atomic_inc(&round->keptCount);
    round->kept[slot] = nodes;
    round->keptGaps[slot] = gap;
  }
}

/// The pairs of nodes that the round kept go to the stack, the nearest on top. All lanes.
inline static void otgStackKept(__local const otg_apart_round* round, uint count, __local uint2* stack,
                                __local float* stackGaps) {
  const uint lane = get_local_id(0);
  if (lane >= count) return;
  const float gap = round->keptGaps[lane];
  uint below = 0;
  for (uint i = 0; i < count; ++i) below += round->keptGaps[i] > gap || (round->keptGaps[i] == gap && i < lane) ? 1 : 0;
  stack[below] = round->kept[lane];
  stackGaps[below] = gap;
}

typedef struct {
  double distance;
  uint2 triangles;
} otg_nearest_found;

/// Ties by the triangles' numbers, A's first.
inline static int otgIsNearer(double distance, uint2 triangles, otg_nearest_found than) {
  const int earlier = triangles.x != than.triangles.x ? triangles.x < than.triangles.x : triangles.y < than.triangles.y;
  return distance < than.distance || (distance == than.distance && earlier);
}

/// Test number `test` of the triangles of all pairs of leaves: the nearer of what it finds and of what was found.
inline static otg_nearest_found otgTestApart(__global const float4* meshes, __local const otg_apart_pair* pair,
                                             __local otg_apart_round* round, uint test, otg_nearest_found own) {
  const uint2 leaves = round->leaves[test / (OTG_LEAF * OTG_LEAF)];
  const uint i = test % (OTG_LEAF * OTG_LEAF) / OTG_LEAF, j = test % OTG_LEAF;
  if (i > (leaves.x & 7) || j > (leaves.y & 7)) return own;
  if (round->leafGaps[test / (OTG_LEAF * OTG_LEAF)] > as_float(round->limitBits)) return own;  // unordered
  __global const float4* soupA = meshes + pair->a.soup + 3 * ((leaves.x >> 3) + i);
  __global const float4* soupB = meshes + pair->b.soup + 3 * ((leaves.y >> 3) + j);
  const float4 u0 = soupA[0], u1 = soupA[1], u2 = soupA[2], v0 = soupB[0], v1 = soupB[1], v2 = soupB[2];
  if (as_uint(u1.w) != 0 || as_uint(v1.w) != 0) return own;  // no area
  otg_transform_d toA;
  for (int n = 0; n < 9; ++n) toA.r[n] = pair->task.r[n];
  toA.t = otgVec_d(pair->task.t[0], pair->task.t[1], pair->task.t[2]);
  const otg_nearest_pair_d found = otgNearestOnTriangles_d(
      otgCornerOf(u0), otgCornerOf(u1), otgCornerOf(u2), otgTransform_d(toA, otgCornerOf(v0)),
      otgTransform_d(toA, otgCornerOf(v1)), otgTransform_d(toA, otgCornerOf(v2)));
  const double distance = sqrt(found.distance2);
  if (!(distance <= pair->task.limit)) return own;
  const uint2 triangles = (uint2)(as_uint(u0.w), as_uint(v0.w));
  if (otgIsNearer(distance, triangles, own)) {
    own.distance = distance;
    own.triangles = triangles;
    atomic_min(&round->limitBits, as_uint(otgRoundedUp(distance)));
  }
  return own;
}

/// Tasks 0 to the number of work-groups - 1 -> the nearest triangles of each, ties by their numbers, A's first.
/// `stackSize` as for otgWalkRound (pair_stack.h), for the deepest two trees.
__kernel __attribute__((reqd_work_group_size(OTG_GROUP, 1, 1))) void batchDistance(OTG_GIVEN(BatchDistance)) {
  __local otg_apart_pair pair;
  __local otg_apart_round round;
  __local double bestDistances[OTG_GROUP];
  __local uint2 bestPairs[OTG_GROUP];
  const uint lane = get_local_id(0), number = get_group_id(0), item = lane / 8, k = lane % 8;
  if (lane == 0) otgBeginApart(tasks + number, places, meshes, &pair, &round, stack, stackGaps);
  otg_nearest_found own = {INFINITY, (uint2)(OTG_DISTANCE_NOTHING, OTG_DISTANCE_NOTHING)};
  barrier(CLK_LOCAL_MEM_FENCE);
  const uint roomForOne = 8 * (pair.a.depth + pair.b.depth) + 8;
  uint stacked = round.keptCount, ended = round.leafCount;
  // The same for all lanes.
  while (stacked > 0 || ended > 0) {
    const uint room = stackSize - roomForOne > stacked ? (stackSize - roomForOne - stacked) / 7 : 0;
    const uint taken = min(stacked, clamp(room, 1u, (uint)(OTG_GROUP / 8)));
    const uint base = stacked - taken;
    barrier(CLK_LOCAL_MEM_FENCE);
    if (lane == 0) round.keptCount = 0;
    uint2 nodes = (uint2)(0, 0);
    int isOpen = 0;
    if (item < taken) {
      nodes = stack[base + item];
      isOpen = stackGaps[base + item] <= as_float(round.limitBits);
    }
    barrier(CLK_LOCAL_MEM_FENCE);
    if (isOpen) otgOpenApart(meshes, &pair, nodes, k, &round);
    barrier(CLK_LOCAL_MEM_FENCE);
    const uint more = round.keptCount;
    stacked = base + more;
    ended = round.leafCount;
    otgStackKept(&round, more, stack + base, stackGaps + base);
    const int tests = ended > 0 && (ended >= OTG_LEAVES_AT_ONCE || stacked == 0);
    const uint testCount = tests ? ended * OTG_LEAF * OTG_LEAF : 0;
    for (uint test = lane; test < testCount; test += OTG_GROUP) own = otgTestApart(meshes, &pair, &round, test, own);
    barrier(CLK_LOCAL_MEM_FENCE);
    if (tests) ended = 0;
    if (lane == 0) round.leafCount = ended;
    barrier(CLK_LOCAL_MEM_FENCE);
  }
  bestDistances[lane] = own.distance;
  bestPairs[lane] = own.triangles;
  barrier(CLK_LOCAL_MEM_FENCE);
  if (lane != 0) return;
  for (uint i = 1; i < OTG_GROUP; ++i) {
    if (!otgIsNearer(bestDistances[i], bestPairs[i], own)) continue;
    own.distance = bestDistances[i];
    own.triangles = bestPairs[i];
  }
  answers[number] = own.triangles;
}
