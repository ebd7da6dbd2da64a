// SPDX-License-Identifier: BSD-3-Clause
// The published traversal: one level of both binary trees in each iteration. Boxes of all pairs of nodes are tested,
// pairs that overlap are moved together, pairs of leaves are split out. The rest spawn four pairs of children (both
// nodes inner) or two (one is a leaf). Places come from prefix sums, so lists have the same order in every run.
//
// OTG_GROUP: work-items of a work-group; each has one pair of nodes. OTG_LEAF is 1. OTG_QUANTIZED: 1 for nodes of
// integers, a unit each (QuantizedNode), behind two units with the steps of their centres and extents.
#include "walk/pair_walk.h"
//
#include "shared/layout/published_given.h"

#define OTG_LEVELS_KERNEL __kernel __attribute__((reqd_work_group_size(OTG_GROUP, 1, 1)))

#if OTG_QUANTIZED
inline static otg_node otgLevelNode(__global const float4* meshes, uint base, uint index) {
  const float4 c = meshes[base], e = meshes[base + 1], unit = meshes[base + 2 + index];
  const short8 centers = as_short8(unit);
  const ushort8 extents = as_ushort8(unit);
  const int child = as_int(unit.w);
  otg_node n;
  n.center = otgVec_f((float)centers.s0 * c.x, (float)centers.s1 * c.y, (float)centers.s2 * c.z);
  n.extent = otgVec_f((float)extents.s3 * e.x, (float)extents.s4 * e.y, (float)extents.s5 * e.z);
  n.first = child < 0 ? ~child : child;
  n.count = child < 0 ? -1 : 2;
  return n;
}
#else
#define otgLevelNode otgLoadNode
#endif

/// Every node of A's start list with every node of B's. `starts`: A's list, then B's.
OTG_LEVELS_KERNEL void levelsBegin(OTG_GIVEN(LevelsBegin)) {
  const uint i = get_global_id(0);
  if (i < countA * countB) pairs[i] = (uint2)(starts[i / countB], starts[countA + i % countB]);
}

/// 1 for each pair of nodes whose boxes overlap, else 0.
OTG_LEVELS_KERNEL void levelsTest(OTG_GIVEN(LevelsTest)) {
  const uint i = get_global_id(0);
  if (i >= count) return;
  const otg_node a = otgLevelNode(meshes, pair.a.nodes, pairs[i].x);
  const otg_node b = otgLevelNode(meshes, pair.b.nodes, pairs[i].y);
  overlaps[i] = otgOverlap(&pair.boxes, a.center, a.extent, otgMoveBox(&pair.boxes, b.center, b.extent)) ? 1u : 0u;
}

/// Moves the pairs that overlap together. `places`: the prefix sums of `overlaps`; `total`: their sum. `weights` gets
/// for each pair that is kept how many pairs of leaves and of children come of it. The rest of its `count` places get
/// 0.
OTG_LEVELS_KERNEL void levelsCompact(OTG_GIVEN(LevelsCompact)) {
  const uint i = get_global_id(0);
  if (i >= count) return;
  if (i >= *total) weights[i] = (uint2)(0, 0);
  if (!overlaps[i]) return;
  const uint2 nodes = pairs[i];
  const int innerA = otgLevelNode(meshes, nodesA, nodes.x).count > 0;
  const int innerB = otgLevelNode(meshes, nodesB, nodes.y).count > 0;
  kept[places[i]] = nodes;
  weights[places[i]] = innerA || innerB ? (uint2)(0, innerA && innerB ? 4 : 2) : (uint2)(1, 0);
}

/// Pairs of leaves go to `leaves` from place `begin` on, as the places of their triangles. `places`: the prefix sums of
/// `weights`. Places beyond the capacity are not written: the host gives the list more room and starts again.
OTG_LEVELS_KERNEL void levelsSplit(OTG_GIVEN(LevelsSplit)) {
  const uint i = get_global_id(0);
  if (i >= count || !weights[i].x) return;
  const uint place = begin + places[i].x;
  if (place >= leafCapacity) return;
  leaves[place] =
      (uint2)((uint)otgLevelNode(meshes, nodesA, kept[i].x).first, (uint)otgLevelNode(meshes, nodesB, kept[i].y).first);
}

/// The pairs of children of all others go to `next`. Capacity as above.
OTG_LEVELS_KERNEL void levelsSpawn(OTG_GIVEN(LevelsSpawn)) {
  const uint i = get_global_id(0);
  if (i >= count) return;
  const uint children = weights[i].y;
  if (!children) return;
  const uint2 nodes = kept[i];
  const otg_node a = otgLevelNode(meshes, nodesA, nodes.x), b = otgLevelNode(meshes, nodesB, nodes.y);
  for (uint k = 0; k < children; ++k) {
    const uint place = places[i].y + k;
    const uint ofA = children == 4 ? k / 2 : k, ofB = children == 4 ? k % 2 : k;
    if (place >= nextCapacity) return;
    next[place] = (uint2)(a.count > 0 ? (uint)a.first + ofA : nodes.x, b.count > 0 ? (uint)b.first + ofB : nodes.y);
  }
}
