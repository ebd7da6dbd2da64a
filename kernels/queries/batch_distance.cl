// SPDX-License-Identifier: BSD-3-Clause
// The nearest triangles of many pairs of meshes that are apart: a work-group to a pair, both trees depth-first. As
// queries/mesh_distance.cpp, through the eight-wide trees, boxes in single precision and triangles in double.
// OTG_GROUP is the size of work-groups, a multiple of 8; OTG_LEAF the most triangles of a leaf.
#define OTG_PAIR_SPACE __local
#define OTG_FUSED
#include "walk/pair_walk.h"
#include "shared/layout/distance_layout.h"
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

/// Tasks 0 to the number of work-groups - 1 -> the nearest triangles of each, ties by their numbers, A's first.
/// `stackSize` as for otgWalkRound (pair_stack.h), for the deepest two trees.
__kernel __attribute__((reqd_work_group_size(OTG_GROUP, 1, 1))) void batchDistance(
    __global const otg_distance_task* restrict tasks, __global const otg_device_mesh* restrict places,
    __global const float4* restrict meshes, __global uint2* restrict answers, uint stackSize, __local uint2* stack,
    __local float* stackGaps) {
  __local otg_distance_task task;
  __local otg_device_mesh meshA, meshB;
  // What one round keeps: pairs of nodes and of leaves, and lower bounds of their distances.
  __local uint2 kept[OTG_GROUP], leaves[OTG_GROUP + OTG_LEAVES_AT_ONCE];
  __local float keptGaps[OTG_GROUP], leafGaps[OTG_GROUP + OTG_LEAVES_AT_ONCE];
  __local uint keptCount, leafCount, limitBits;
  __local double bestDistances[OTG_GROUP];
  __local uint2 bestPairs[OTG_GROUP];
  const uint lane = get_local_id(0), number = get_group_id(0), item = lane / 8, k = lane % 8;
  if (lane == 0) {
    task = tasks[number];
    meshA = places[tasks[number].meshA];
    meshB = places[tasks[number].meshB];
    keptCount = 0;
    leafCount = 0;
    // Distances are not negative, so that they have the order of their bits.
    limitBits = as_uint(otgRoundedUp(task.limit));
    const otg_node a = otgLoadNode(meshes, meshA.nodes, 0), b = otgLoadNode(meshes, meshB.nodes, 0);
    if (task.limit < 0) {
      // The host's.
    } else if (a.count < 0 && b.count < 0) {
      leaves[0] = otgPairOfLeaves(&a, &b);
      leafGaps[0] = -INFINITY;
      leafCount = 1;
    } else {
      stack[0] = (uint2)(0, 0);
      stackGaps[0] = -INFINITY;
      keptCount = 1;
    }
  }
  double own = INFINITY;
  uint2 ownPair = (uint2)(OTG_DISTANCE_NOTHING, OTG_DISTANCE_NOTHING);
  barrier(CLK_LOCAL_MEM_FENCE);
  const uint roomForOne = 8 * (meshA.depth + meshB.depth) + 8;
  uint stacked = keptCount, ended = leafCount;
  // The same for all lanes.
  while (stacked > 0 || ended > 0) {
    const uint room = stackSize - roomForOne > stacked ? (stackSize - roomForOne - stacked) / 7 : 0;
    const uint taken = min(stacked, clamp(room, 1u, (uint)(OTG_GROUP / 8)));
    const uint base = stacked - taken;
    barrier(CLK_LOCAL_MEM_FENCE);
    if (lane == 0) keptCount = 0;
    uint2 nodes = (uint2)(0, 0);
    int isOpen = 0;
    if (item < taken) {
      nodes = stack[base + item];
      isOpen = stackGaps[base + item] <= as_float(limitBits);
    }
    barrier(CLK_LOCAL_MEM_FENCE);
    if (isOpen) {
      const otg_box_frame_f frame = task.boxes;
      otg_node a = otgLoadNode(meshes, meshA.nodes, nodes.x), b = otgLoadNode(meshes, meshB.nodes, nodes.y);
      const int openA = b.count < 0 || (a.count > 0 && otgArea(a.extent) >= otgArea(b.extent));
      if (k < (uint)(openA ? a.count : b.count)) {
        if (openA) {
          nodes.x = (uint)a.first + k;
          a = otgLoadNode(meshes, meshA.nodes, nodes.x);
        } else {
          nodes.y = (uint)b.first + k;
          b = otgLoadNode(meshes, meshB.nodes, nodes.y);
        }
        const float gap = otgBoxesApart(&frame, &a, &b);
        if (gap <= as_float(limitBits)) {
          if (a.count < 0 && b.count < 0) {
            const uint slot = atomic_inc(&leafCount);
            leaves[slot] = otgPairOfLeaves(&a, &b);
            leafGaps[slot] = gap;
          } else {
            const uint slot = atomic_inc(&keptCount);
            kept[slot] = nodes;
            keptGaps[slot] = gap;
          }
        }
      }
    }
    barrier(CLK_LOCAL_MEM_FENCE);
    const uint more = keptCount;
    stacked = base + more;
    ended = leafCount;
    // The nearest comes to lie on top.
    if (lane < more) {
      const float gap = keptGaps[lane];
      uint below = 0;
      for (uint i = 0; i < more; ++i) below += keptGaps[i] > gap || (keptGaps[i] == gap && i < lane) ? 1 : 0;
      stack[base + below] = kept[lane];
      stackGaps[base + below] = gap;
    }
    const int tests = ended > 0 && (ended >= OTG_LEAVES_AT_ONCE || stacked == 0);
    const uint testCount = tests ? ended * OTG_LEAF * OTG_LEAF : 0;
    for (uint test = lane; test < testCount; test += OTG_GROUP) {
      const uint2 pair = leaves[test / (OTG_LEAF * OTG_LEAF)];
      const uint i = test % (OTG_LEAF * OTG_LEAF) / OTG_LEAF, j = test % OTG_LEAF;
      if (i > (pair.x & 7) || j > (pair.y & 7)) continue;
      if (leafGaps[test / (OTG_LEAF * OTG_LEAF)] > as_float(limitBits)) continue;  // unordered
      __global const float4* soupA = meshes + meshA.soup + 3 * ((pair.x >> 3) + i);
      __global const float4* soupB = meshes + meshB.soup + 3 * ((pair.y >> 3) + j);
      const float4 u0 = soupA[0], u1 = soupA[1], u2 = soupA[2], v0 = soupB[0], v1 = soupB[1], v2 = soupB[2];
      if (as_uint(u1.w) != 0 || as_uint(v1.w) != 0) continue;  // no area
      otg_transform_d toA;
      for (int n = 0; n < 9; ++n) toA.r[n] = task.r[n];
      toA.t = otgVec_d(task.t[0], task.t[1], task.t[2]);
      const otg_nearest_pair_d found = otgNearestOnTriangles_d(
          otgCornerOf(u0), otgCornerOf(u1), otgCornerOf(u2), otgTransform_d(toA, otgCornerOf(v0)),
          otgTransform_d(toA, otgCornerOf(v1)), otgTransform_d(toA, otgCornerOf(v2)));
      const double distance = sqrt(found.distance2);
      if (!(distance <= task.limit)) continue;
      const uint2 triangles = (uint2)(as_uint(u0.w), as_uint(v0.w));
      const int earlier =
          triangles.x != ownPair.x ? triangles.x < ownPair.x : triangles.y < ownPair.y;
      if (distance < own || (distance == own && earlier)) {
        own = distance;
        ownPair = triangles;
        atomic_min(&limitBits, as_uint(otgRoundedUp(distance)));
      }
    }
    barrier(CLK_LOCAL_MEM_FENCE);
    if (tests) ended = 0;
    if (lane == 0) leafCount = ended;
    barrier(CLK_LOCAL_MEM_FENCE);
  }
  bestDistances[lane] = own;
  bestPairs[lane] = ownPair;
  barrier(CLK_LOCAL_MEM_FENCE);
  if (lane == 0) {
    for (uint i = 1; i < OTG_GROUP; ++i) {
      const uint2 pair = bestPairs[i];
      const int earlier = pair.x != ownPair.x ? pair.x < ownPair.x : pair.y < ownPair.y;
      if (bestDistances[i] < own || (bestDistances[i] == own && earlier)) {
        own = bestDistances[i];
        ownPair = pair;
      }
    }
    answers[number] = ownPair;
  }
}
