// SPDX-License-Identifier: BSD-3-Clause
// Bodies of the SIMD stages, for the instruction set that OTG_SIMD_NAMESPACE names: see wide_kernels.h.
#pragma once

#include <limits>

#include "collide/simd/triangle_filter_impl.h"
#include "collide/simd/wide_kernels_args.h"
#include "shared/tests/box_test.h"

namespace otg::OTG_SIMD_NAMESPACE {

/// Boxes of one mesh, as those of the other are tested against them.
template <class Real>
struct PlacedBox {
  Vec3<Real> center;  ///< in A's frame
  Vec3<Real> extent;  ///< along the axes of their own mesh
  Vec3<Real> across;  ///< how far they reach along the axes of the other mesh
};

template <bool kOfA, class Real>
[[gnu::always_inline]] inline PlacedBox<Real> placed(const BoxFrame<Real>& frame, const Vec3<Real>& center,
                                                     const Vec3<Real>& extent) {
  if constexpr (kOfA) {
    return {center, extent, otgBoxExtentInB(frame, extent)};
  } else {
    return {otgBoxCenterInA(frame, center), extent, otgBoxExtentInA(frame, extent)};
  }
}

inline PlacedBox<SimdReal> spread(const PlacedBox<float>& box) {
  return {spread(box.center), spread(box.extent), spread(box.across)};
}
inline BoxScale<SimdReal> spread(const BoxScale<float>& s) {
  return {spread(s.factor), spread(s.shift), spread(s.growth), spread(s.pad), SimdReal(s.slope)};
}

[[gnu::always_inline]] inline void store(float* to, const SimdVec& v) {
  std::memcpy(to, &v.x.v, sizeof v.x.v);
  std::memcpy(to + kWideArity, &v.y.v, sizeof v.y.v);
  std::memcpy(to + 2 * kWideArity, &v.z.v, sizeof v.z.v);
}

template <class Real>
[[gnu::always_inline]] inline Real areaOf(const Vec3<Real>& extent) {
  return extent.x * extent.y + extent.y * extent.z + extent.z * extent.x;
}

/// A triangle of one mesh in the frame of the other one's boxes: how far it reaches along its normal, and along what is
/// square to that and to an edge. Any axes are right, so that it does not matter how they round.
struct ThinTriangle {
  static constexpr int kAxes = 4;
  std::int32_t triangle = -1;
  SimdVec axis[kAxes], size[kAxes];  ///< and their absolute values
  SimdReal low[kAxes], high[kAxes];

  /// Of boxes of the other mesh: those that are certainly apart from it.
  [[gnu::always_inline]] unsigned apartBits(const SimdVec& center, const SimdVec& extent) const {
    unsigned apart = 0;
    for (int k = 0; k < kAxes; ++k) {
      const SimdReal at = otgDot(axis[k], center), reach = otgDot(size[k], extent);
      apart |= greaterBits(at - reach, high[k]) | greaterBits(low[k], at + reach);
    }
    return apart;
  }
};

/// kScaled: boxes are taken through the scales. kThin: bare triangles are tested against boxes, too.
template <bool kScaled, bool kThin>
class WideTraversal {
 public:
  explicit WideTraversal(WideTraversalArgs& args) : args_(args), frame_(*args.frame), out_(*args.out) {
    for (int i = 0; i < 9; ++i) {
      simd_.r[i] = frame_.r[i];
      simd_.absR[i] = frame_.absR[i];
    }
    simd_.t = spread(frame_.t);
    simd_.eps = frame_.eps;
    if constexpr (kScaled) {
      scaleA_ = spread(args.scaleA);
      scaleB_ = spread(args.scaleB);
    }
  }

  void run() {
    std::size_t top = 1;
    args_.stack[0] = {WideItem::kRoot, WideItem::kRoot, 0};
    while (top > 0) {
      const WideItem item = args_.stack[--top];
      top_ = args_.stack + top;
      const Side a = sideAt<true>(item.a), b = sideAt<false>(item.b);
      if (opensA(a, b, item.depth)) {
        open<true>(item, a, b);
      } else {
        open<false>(item, b, a);
      }
      top = static_cast<std::size_t>(top_ - args_.stack);
    }
    args_.boxTests = boxTests_;
  }

 private:
  /// A node of one tree, or ~triangle, with its box.
  struct Side {
    PlacedBox<float> box;
    std::int32_t ref;
    float size;  ///< decides which side is opened
  };
  /// The children of a node.
  struct Children {
    PlacedBox<SimdReal> boxes;
    SimdReal sizes;
    const WideNode* node;
    std::uint32_t firstSlot;
    unsigned used, triangles;  ///< lanes
  };

  bool opensA(const Side& a, const Side& b, std::uint32_t depth) const {
    if (a.ref < 0 || b.ref < 0) return a.ref >= 0;
    // "Both at once" has no meaning for one box against eight; it goes by size like the default.
    if (args_.rule == DescentRule::kAlternating) return depth % 2 == 0;
    return args_.rule == DescentRule::kFirstTreeFirst || a.size >= b.size;
  }

  template <bool kOfA>
  [[gnu::always_inline]] Side sideAt(std::uint32_t slot) const {
    if (slot == WideItem::kRoot) {
      const BoxOf& root = kOfA ? args_.rootA : args_.rootB;
      return {placed<kOfA>(frame_, root.center, root.extent), 0, std::numeric_limits<float>::infinity()};
    }
    const WideNode& node = (kOfA ? args_.nodesA : args_.nodesB)[slot / kWideArity];
    const std::uint32_t k = slot % kWideArity;
    Vec3f center{node.centerX[k], node.centerY[k], node.centerZ[k]};
    Vec3f extent{node.extentX[k], node.extentY[k], node.extentZ[k]};
    if constexpr (kScaled) {
      const BoxOf box = scaledBox(kOfA ? args_.scaleA : args_.scaleB, center, extent);
      center = box.center;
      extent = box.extent;
    }
    return {placed<kOfA>(frame_, center, extent), node.child[k], areaOf(extent)};
  }

  template <bool kOfA>
  [[gnu::always_inline]] Children childrenOf(std::int32_t ref) const {
    const WideNode& node = (kOfA ? args_.nodesA : args_.nodesB)[ref];
    SimdVec center = loadVec<SimdReal>(node.centerX, node.centerY, node.centerZ);
    SimdVec extent = loadVec<SimdReal>(node.extentX, node.extentY, node.extentZ);
    if constexpr (kScaled) {
      const BoxScale<SimdReal>& scale = kOfA ? scaleA_ : scaleB_;
      center = scaledCenter(scale, center);
      extent = scaledExtent(scale, extent, center);
    }
    SimdReal::Ints child;
    std::memcpy(&child, node.child, sizeof child);
    return {placed<kOfA>(simd_, center, extent),          areaOf(extent),         &node,
            static_cast<std::uint32_t>(kWideArity * ref), (1u << node.count) - 1, bitsOf(child < 0)};
  }

  /// Lanes in which boxes of A and B are apart.
  [[gnu::always_inline]] unsigned apartBits(const PlacedBox<SimdReal>& a, const PlacedBox<SimdReal>& b) const {
    const SimdVec d = otgSub(b.center, a.center);
    const SimdReal gap = otgMax(otgBoxGapA(d, a.extent, b.across), otgBoxGapAlongB(simd_, d, a.across, b.extent));
    unsigned apart = greaterBits(gap, simd_.eps);
    if (args_.edges) apart |= greaterBits(otgBoxGapEdges(simd_, d, a.extent, b.extent), simd_.eps);
    return apart;
  }
  /// Children of a node (of A if kOfA, else of B) whose boxes overlap a box of the other mesh.
  template <bool kOfA>
  [[gnu::always_inline]] unsigned overlapBits(const Children& children, const PlacedBox<SimdReal>& other) const {
    return children.used & ~(kOfA ? apartBits(children.boxes, other) : apartBits(other, children.boxes));
  }

  void count(const Children& children, int boxes, std::uint32_t depth) {
    const auto tests = static_cast<std::uint64_t>(children.node->count) * static_cast<std::uint64_t>(boxes);
    boxTests_ += tests;
    if (args_.testsPerDepth) args_.testsPerDepth[depth] += tests;
  }

  /// Opens `side`, which is A's if kOfA. Of its children those that are to open the other side next do so together: its
  /// children are placed once for them.
  template <bool kOfA>
  [[gnu::always_inline]] void open(const WideItem& item, const Side& side, const Side& other) {
    const Children children = childrenOf<kOfA>(side.ref);
    count(children, 1, item.depth);
    unsigned bits = overlapBits<kOfA>(children, spread(other.box));
    const std::uint32_t otherSlot = kOfA ? item.b : item.a;
    if (other.ref < 0) {
      if constexpr (kThin) bits &= ~thinBits<!kOfA>(~other.ref, children, bits);
      addPairs<!kOfA>(~other.ref, *children.node, bits & children.triangles);
      pushAll<!kOfA>(otherSlot, children, bits & ~children.triangles, item.depth + 1);
      return;
    }
    const unsigned next = bits & (children.triangles | nextBits<kOfA>(children.sizes, other.size));
    if (next != 0) openOther<kOfA>(children, next, other.ref, item.depth + 1);
    pushAll<!kOfA>(otherSlot, children, bits & ~next, item.depth + 1);
  }

  /// Inner nodes in `sizes`, of A if kOfA, beside which the other side is opened.
  template <bool kOfA>
  [[gnu::always_inline]] unsigned nextBits(const SimdReal& sizes, float other) const {
    if (args_.rule == DescentRule::kAlternating) return ~0u;
    if (args_.rule == DescentRule::kFirstTreeFirst) return kOfA ? 0u : ~0u;
    return kOfA ? greaterBits(SimdReal(other), sizes) : ~greaterBits(sizes, SimdReal(other));
  }

  template <bool kOfA>
  [[gnu::always_inline]] void openOther(const Children& children, unsigned next, std::int32_t ref,
                                        std::uint32_t depth) {
    alignas(32) float lanes[9 * kWideArity];
    store(lanes, children.boxes.center);
    store(lanes + 3 * kWideArity, children.boxes.extent);
    store(lanes + 6 * kWideArity, children.boxes.across);
    const Children others = childrenOf<!kOfA>(ref);
    count(others, __builtin_popcount(next), depth);
    for (; next; next &= next - 1) {
      const int k = __builtin_ctz(next);
      const auto vec = [&](int i) {
        const float* const x = lanes + i * kWideArity + k;
        return spread(Vec3f{x[0], x[kWideArity], x[2 * kWideArity]});
      };
      unsigned bits = overlapBits<!kOfA>(others, {vec(0), vec(3), vec(6)});
      if (!bits) continue;
      const std::int32_t child = children.node->child[k];
      if (child < 0) {
        if constexpr (kThin) bits &= ~thinBits<kOfA>(~child, others, bits);
        addPairs<kOfA>(~child, *others.node, bits & others.triangles);
        bits &= ~others.triangles;
      }
      pushAll<kOfA>(children.firstSlot + static_cast<std::uint32_t>(k), others, bits, depth + 1);
    }
  }

  /// Of children of a node of the other mesh those that are apart from a triangle, of A if kOfA. It costs as much to
  /// measure a triangle as to decide ten pairs: not for few.
  template <bool kOfA>
  unsigned thinBits(std::int32_t triangle, const Children& others, unsigned bits) {
    ThinTriangle& thin = thin_[kOfA ? 0 : 1];
    if (thin.triangle != triangle) {
      const unsigned inner = bits & ~others.triangles;
      if ((inner & (inner - 1)) == 0) return 0;
      measureThin<kOfA>(triangle, thin);
    }
    const WideNode& node = *others.node;
    return thin.apartBits(loadVec<SimdReal>(node.centerX, node.centerY, node.centerZ),
                          loadVec<SimdReal>(node.extentX, node.extentY, node.extentZ));
  }

  /// Zero where there is none: nothing is apart along that.
  static Vec3f unitOf(const Vec3d& v) {
    const double length = __builtin_sqrt(otgDot(v, v));
    const double scale = length > 0 ? 1 / length : 0;
    return {static_cast<float>(v.x * scale), static_cast<float>(v.y * scale), static_cast<float>(v.z * scale)};
  }

  template <bool kOfA>
  void measureThin(std::int32_t triangle, ThinTriangle& thin) const {
    const ThinTest& test = *args_.thin;
    const auto wide = [](const Vec3f& v) { return Vec3d{v.x, v.y, v.z}; };
    const Transformf& turn = *test.turn;
    const Transformd inA{
        {turn.r[0], turn.r[1], turn.r[2], turn.r[3], turn.r[4], turn.r[5], turn.r[6], turn.r[7], turn.r[8]},
        wide(turn.t)};
    Vec3d corner[3];
    for (int k = 0; k < 3; ++k) {
      const std::uint32_t v = (kOfA ? test.trianglesA : test.trianglesB)[triangle].v[k];
      const Vec3d own =
          otgSub(wide((kOfA ? test.verticesA : test.verticesB)[v]), wide(kOfA ? test.originA : test.originB));
      corner[k] = kOfA ? otgRotateBack(inA, otgSub(own, inA.t)) : otgTransform(inA, own);
    }
    const Vec3d normal = otgCross(otgSub(corner[1], corner[0]), otgSub(corner[2], corner[0]));
    for (int k = 0; k < ThinTriangle::kAxes; ++k) {
      const Vec3f axis = unitOf(k == 3 ? normal : otgCross(normal, otgSub(corner[(k + 1) % 3], corner[k])));
      double low = std::numeric_limits<double>::infinity(), high = -low;
      for (const Vec3d& c : corner) {
        const double at = otgDot(wide(axis), c);
        low = at < low ? at : low;
        high = at > high ? at : high;
      }
      thin.axis[k] = spread(axis);
      thin.size[k] = spread(Vec3f{__builtin_fabsf(axis.x), __builtin_fabsf(axis.y), __builtin_fabsf(axis.z)});
      thin.low[k] = static_cast<float>(low - test.error);
      thin.high[k] = static_cast<float>(high + test.error);
    }
    thin.triangle = triangle;
  }

  /// One node, of A if kOfA, with some of the other mesh's.
  template <bool kOfA>
  [[gnu::always_inline]] void pushAll(std::uint32_t slot, const Children& others, unsigned bits, std::uint32_t depth) {
    for (; bits; bits &= bits - 1) {
      const auto k = static_cast<std::uint32_t>(__builtin_ctz(bits));
      const std::int32_t child = others.node->child[k];
      if (child >= 0) __builtin_prefetch((kOfA ? args_.nodesB : args_.nodesA) + child);
      const std::uint32_t other = others.firstSlot + k;
      *top_++ = {kOfA ? slot : other, kOfA ? other : slot, depth};
    }
  }

  /// A triangle, of A if kOfA, with those of a node's lanes.
  template <bool kOfA>
  [[gnu::always_inline]] void addPairs(std::int32_t triangle, const WideNode& others, unsigned bits) {
    const auto pairWith = [&](int k) {
      const auto one = static_cast<std::uint32_t>(triangle), other = static_cast<std::uint32_t>(~others.child[k]);
      return kOfA ? TrianglePair{one, other} : TrianglePair{other, one};
    };
    if (out_.capacity - out_.size < kWideArity) {
      for (; bits; bits &= bits - 1) {
        if (out_.size == out_.capacity) out_.grow(out_);
        out_.data[out_.size++] = pairWith(__builtin_ctz(bits));
      }
      return;
    }
    // Without a branch that nobody could predict: what does not count is overwritten.
    for (int k = 0; k < kWideArity; ++k) {
      out_.data[out_.size] = pairWith(k);
      out_.size += bits >> k & 1;
    }
  }

  WideTraversalArgs& args_;
  const BoxFrame<float>& frame_;
  PairSink& out_;
  BoxFrame<SimdReal> simd_;
  BoxScale<SimdReal> scaleA_, scaleB_;  ///< if kScaled
  WideItem* top_ = nullptr;             ///< of the stack
  ThinTriangle thin_[kThin ? 2 : 1];    ///< the last ones of A and B
  std::uint64_t boxTests_ = 0;
};

void traverseWide(WideTraversalArgs& args) {
  if (args.scaled) {
    WideTraversal<true, false>(args).run();
  } else if (args.thin != nullptr) {
    WideTraversal<false, true>(args).run();
  } else {
    WideTraversal<false, false>(args).run();
  }
}

}  // namespace otg::OTG_SIMD_NAMESPACE
