// SPDX-License-Identifier: BSD-3-Clause
// What the kernels that walk two trees have in common: nodes, box tests, triangle tests, lists.
//
// OTG_LEAF is the most triangles that a leaf holds. With OTG_FUSED multiplications and additions of single precision
// may be fused: all that they decide has a bound on its error, and fewer roundings keep it.
#ifndef OTG_PAIR_WALK_H
#define OTG_PAIR_WALK_H
#include "shared/math/platform.h"
#ifdef OTG_FUSED
#pragma OPENCL FP_CONTRACT ON
#endif
#define OTG_REAL_FLOAT
#include "shared/tests/box_test.h"
#include "shared/tests/triangle_test.h"
#undef OTG_REAL_FLOAT
#pragma OPENCL FP_CONTRACT OFF
#ifdef OTG_WITH_DOUBLE
#pragma OPENCL EXTENSION cl_khr_fp64 : enable
#endif
#include "shared/layout/device_layout.h"

typedef struct {
  otg_vec3_f center, extent;
  int first, count;  // as PackedNode: count < 0 for a leaf
} otg_node;

inline static otg_node otgLoadNode(__global const float4* meshes, uint base, uint index) {
  const float4 p = meshes[base + 2 * index], q = meshes[base + 2 * index + 1];
  otg_node n;
  n.center = otgVec_f(p.x, p.y, p.z);
  n.extent = otgVec_f(q.x, q.y, q.z);
  n.first = as_int(p.w);
  n.count = as_int(q.w);
  return n;
}

/// A box of B as the test wants it.
typedef struct {
  otg_vec3_f center, extent, extentInA;  // centre in A's frame
} otg_moved_box;

inline static otg_moved_box otgMoveBox(const otg_box_frame_f* frame, otg_vec3_f center, otg_vec3_f extent) {
  otg_moved_box box;
  box.center = otgBoxCenterInA_f(*frame, center);
  box.extent = extent;
  box.extentInA = otgBoxExtentInA_f(*frame, extent);
  return box;
}

/// Written so that NaN means "may overlap".
inline static int otgOverlap(const otg_box_frame_f* frame, otg_vec3_f centerA, otg_vec3_f extentA, otg_moved_box b) {
  const otg_vec3_f d = otgSub_f(b.center, centerA);
  if (otgBoxGapA_f(d, extentA, b.extentInA) > frame->eps) return 0;
  return !(otgBoxGapB_f(*frame, d, extentA, b.extent) > frame->eps);
}

inline static float otgArea(otg_vec3_f e) {
  return e.x * e.y + e.y * e.z + e.z * e.x;
}

/// A pair of leaves, ready for the triangles to be tested: the place of the first one and, in three bits, how many
/// there are, minus one.
inline static uint2 otgPairOfLeaves(const otg_node* a, const otg_node* b) {
  return (uint2)((uint)a->first << 3 | (uint)(-a->count - 1), (uint)b->first << 3 | (uint)(-b->count - 1));
}

/// Adds to a counter of two words.
inline static void otgCount(__global uint* counter, uint n) {
  const uint before = atomic_add(counter, n);
  if (before + n < before) atomic_inc(counter + 1);
}

/// Opens the larger box of a pair of nodes that are not both leaves, and tests its child `k` against the other box:
/// 0 if there is no such child or the boxes are apart, 1 for a pair to open further, 2 for a pair of leaves; `nodes` is
/// that pair then. `children` is how many there are.
inline static int otgOpen(__global const float4* meshes, const otg_device_pair* pair, uint2* nodes, uint k,
                          uint* children) {
  otg_node a = otgLoadNode(meshes, pair->a.nodes, nodes->x), b = otgLoadNode(meshes, pair->b.nodes, nodes->y);
  const int openA = b.count < 0 || (a.count > 0 && otgArea(a.extent) >= otgArea(b.extent));
  *children = (uint)(openA ? a.count : b.count);
  if (k >= *children) return 0;
  if (openA) {
    nodes->x = (uint)a.first + k;
    a = otgLoadNode(meshes, pair->a.nodes, nodes->x);
  } else {
    nodes->y = (uint)b.first + k;
    b = otgLoadNode(meshes, pair->b.nodes, nodes->y);
  }
  if (!otgOverlap(&pair->boxes, a.center, a.extent, otgMoveBox(&pair->boxes, b.center, b.extent))) return 0;
  return a.count < 0 && b.count < 0 ? 2 : 1;
}

/// The float filter for the triangles at two places of the soups: OTG_DISJOINT also for triangles without area.
inline static int otgTestTriangles(__global const float4* meshes, const otg_device_pair* pair, uint placeA,
                                   uint placeB) {
  const uint soupA = pair->a.soup + 3 * placeA, soupB = pair->b.soup + 3 * placeB;
  otg_transform_f toA;
  otg_vec3_f a[3], b[3];
  uint flags = 0;
  for (int k = 0; k < 9; ++k) toA.r[k] = pair->boxes.r[k];
  toA.t = pair->boxes.t;
  for (int k = 0; k < 3; ++k) {
    const float4 p = meshes[soupA + k], q = meshes[soupB + k];
    a[k] = otgSub_f(otgVec_f(p.x, p.y, p.z), pair->a.center);
    b[k] = otgTransform_f(toA, otgSub_f(otgVec_f(q.x, q.y, q.z), pair->b.center));
    if (k == 1) flags = as_uint(p.w) | as_uint(q.w);
  }
  return flags != 0 ? OTG_DISJOINT : otgTrianglesFilter_f(pair->error, a, b);
}

/// A place in the list of hits. Places beyond the capacity are counted and not written: the host gives the list more
/// room and starts again.
inline static uint otgTakeHit(__global uint* counters, int answer) {
  if (answer == OTG_UNDECIDED) atomic_inc(counters + OTG_COUNT_UNDECIDED);
  return atomic_inc(counters + OTG_COUNT_HITS);
}

#endif  // OTG_PAIR_WALK_H
