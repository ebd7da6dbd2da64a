// SPDX-License-Identifier: BSD-3-Clause
// What the per-instruction-set kernels take: plain data only (see wide_kernels.h for why).
#pragma once

#include <cstddef>
#include <cstdint>

#include "base/triangle.h"
#include "bvh/box_scale.h"
#include "bvh/wide_node.h"
#include "collide/simd/near_frame.h"
#include "collide/traversal.h"
#include "shared/tests/box_test.h"

namespace otg {

/// Pairs going out; `grow` makes room for at least one more, or throws.
struct PairSink {
  TrianglePair* data;
  std::size_t size, capacity;
  void (*grow)(PairSink& self);
  void* owner;
};

/// Nodes of both trees, waiting to be tested further: eight times a wide node plus the lane there.
struct WideItem {
  static constexpr std::uint32_t kRoot = ~0u;
  std::uint32_t a, b;
  std::uint32_t depth;  ///< nodes opened on the way here
};

/// What a triangle of one mesh is tested by against boxes of the other.
struct ThinTest {
  const Vec3f *verticesA, *verticesB;
  const Triangle *trianglesA, *trianglesB;
  Vec3f originA, originB;  ///< of the frames of the boxes
  const Transformf* turn;  ///< B's frame to A's
  double error;            ///< of a corner's coordinate in the other frame, and of what is computed in float
};

struct WideTraversalArgs {
  const BoxFrame<float>* frame;
  const WideNode* nodesA;
  const WideNode* nodesB;
  BoxOf rootA, rootB;              ///< scaled
  BoxScale<float> scaleA, scaleB;  ///< of the nodes' boxes
  bool scaled;                     ///< whether any of these is not kSameBoxes
  WideItem* stack;                 ///< room for kWideArity^2 * (depth A + depth B) + 1 items
  DescentRule rule;
  bool edges;                    ///< test the nine edge axes too
  std::uint64_t boxTests;        ///< out
  std::uint64_t* testsPerDepth;  ///< depth A + depth B counters to add to, or null
  PairSink* out;
  /// If not null, bare triangles are tested against boxes by themselves, too. No boxes are scaled then.
  const ThinTest* thin;
};

struct TriangleFilterArgs {
  const Vec3f *verticesA, *verticesB;
  const Triangle *trianglesA, *trianglesB;
  const Transformd* bInA;
  const Transformf* turn;  ///< its rotation in float
  const NearFilterError* error;
  const FilterError<double>* doubleError;
  const TrianglePair* candidates;
  std::size_t count;
  TrianglePair *intersecting, *undecided;                 ///< room for `count` each
  std::size_t intersectingCount = 0, undecidedCount = 0;  ///< out
};

#define OTG_DECLARE_WIDE_KERNELS(set)                     \
  namespace set {                                         \
  void traverseWide(WideTraversalArgs& args);             \
  void filterTriangles(TriangleFilterArgs& args);         \
  void filterTrianglesInDouble(TriangleFilterArgs& args); \
  }
OTG_DECLARE_WIDE_KERNELS(simd_baseline)
OTG_DECLARE_WIDE_KERNELS(simd_avx2)
OTG_DECLARE_WIDE_KERNELS(simd_avx512)
#undef OTG_DECLARE_WIDE_KERNELS

}  // namespace otg
