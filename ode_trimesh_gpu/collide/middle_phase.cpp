// SPDX-License-Identifier: BSD-3-Clause
// Middle phase over binary trees: the three published traversals and the four descent rules, as one template.
#include <chrono>

#include "collide/pair_frame.h"
#include "collide/pair_limit.h"
#include "collide/query.h"
#include "collide/rotation_tolerance.h"
#include "collide/simd/wide_kernels.h"
#include "collide/triangle_box.h"
#include "shared/tests/box_test.h"

namespace otg {
namespace {

using Box = BoxOf;

/// Uniform view of a tree: a reference is >= 0 for an inner node and ~triangle for a leaf.
template <class Boxes>
struct StandardView {
  const BinaryTree& tree;
  Boxes boxes;
  std::size_t size() const { return tree.nodes.size(); }
  std::int32_t root() const { return 0; }
  bool isLeaf(std::int32_t n) const { return tree.nodes[n].isLeaf(); }
  std::uint32_t triangle(std::int32_t n) const { return tree.nodes[n].triangle(); }
  std::int32_t left(std::int32_t n) const { return tree.nodes[n].child; }
  std::int32_t right(std::int32_t n) const { return tree.nodes[n].child + 1; }
  Box box(std::int32_t n) const {
    const auto& box = boxes(tree.nodes[n]);
    return {box.center, box.extent};
  }
};

template <class Boxes>
struct QuantizedView {
  const QuantizedTree& tree;
  Boxes boxes;
  std::size_t size() const { return tree.nodes.size(); }
  std::int32_t root() const { return 0; }
  bool isLeaf(std::int32_t n) const { return tree.nodes[n].child < 0; }
  std::uint32_t triangle(std::int32_t n) const { return static_cast<std::uint32_t>(~tree.nodes[n].child); }
  std::int32_t left(std::int32_t n) const { return tree.nodes[n].child; }
  std::int32_t right(std::int32_t n) const { return tree.nodes[n].child + 1; }
  Box box(std::int32_t n) const {
    const QuantizedNode& q = tree.nodes[n];
    return boxes(
        Box{{q.center[0] * tree.centerStep.x, q.center[1] * tree.centerStep.y, q.center[2] * tree.centerStep.z},
            {q.extent[0] * tree.extentStep.x, q.extent[1] * tree.extentStep.y, q.extent[2] * tree.extentStep.z}});
  }
};

float sizeOf(const Box& b) {  // half of the half-area: only compared
  return b.extent.x * b.extent.y + b.extent.y * b.extent.z + b.extent.z * b.extent.x;
}

class BoxPairTest {
 public:
  BoxPairTest(const BoxFrame<float>& frame, int axes) : frame_(frame), edges_(axes > 6) {}
  bool apart(const Box& a, const Box& b) const {
    const Vec3f d = otgSub(otgBoxCenterInA(frame_, b.center), a.center);
    if (otgBoxGapA(d, a.extent, otgBoxExtentInA(frame_, b.extent)) > frame_.eps) return true;
    if (otgBoxGapB(frame_, d, a.extent, b.extent) > frame_.eps) return true;
    return edges_ && otgBoxGapEdges(frame_, d, a.extent, b.extent) > frame_.eps;
  }

 private:
  const BoxFrame<float>& frame_;
  bool edges_;
};

struct Item {
  std::int32_t a, b;
  std::uint16_t depth;  ///< steps down from the pair of roots, both trees together
  bool descendA;        ///< alternating rule: whose turn it is
};

class Counter {
 public:
  Counter(CollideStats& stats, bool perDepth) : stats_(stats), perDepth_(perDepth) {}
  void boxTest(unsigned depth) {
    ++stats_.boxTests;
    if (perDepth_) {
      if (stats_.boxTestsPerDepth.size() <= depth) stats_.boxTestsPerDepth.resize(depth + 1);
      ++stats_.boxTestsPerDepth[depth];
    }
  }
  void triangleBoxTest() { ++stats_.triangleBoxTests; }

 private:
  CollideStats& stats_;
  bool perDepth_;
};

/// Both trees with boxes at every node.
template <class View>
void traverseBoxed(const View& a, const View& b, const BoxPairTest& test, DescentRule rule, Counter count,
                   CandidateList out) {
  std::vector<Item> stack;
  stack.reserve(2 * kMaxTreeDepth + 8);
  stack.push_back({a.root(), b.root(), 0, true});
  while (!stack.empty()) {
    const Item item = stack.back();
    stack.pop_back();
    const Box boxA = a.box(item.a), boxB = b.box(item.b);
    count.boxTest(item.depth);
    if (test.apart(boxA, boxB)) continue;
    const bool leafA = a.isLeaf(item.a), leafB = b.isLeaf(item.b);
    if (leafA && leafB) {
      out.add({a.triangle(item.a), b.triangle(item.b)});
      continue;
    }
    const auto depth = static_cast<std::uint16_t>(item.depth + 1);
    if (rule == DescentRule::kBoth && !leafA && !leafB) {
      const auto two = static_cast<std::uint16_t>(item.depth + 2);
      stack.push_back({a.left(item.a), b.left(item.b), two, true});
      stack.push_back({a.left(item.a), b.right(item.b), two, true});
      stack.push_back({a.right(item.a), b.left(item.b), two, true});
      stack.push_back({a.right(item.a), b.right(item.b), two, true});
      continue;
    }
    bool descendA = !leafA;
    if (!leafA && !leafB) {
      if (rule == DescentRule::kLargerFirst) descendA = sizeOf(boxA) >= sizeOf(boxB);
      if (rule == DescentRule::kAlternating) descendA = item.descendA;
    }
    if (descendA) {
      stack.push_back({a.left(item.a), item.b, depth, false});
      stack.push_back({a.right(item.a), item.b, depth, false});
    } else {
      stack.push_back({item.a, b.left(item.b), depth, true});
      stack.push_back({item.a, b.right(item.b), depth, true});
    }
  }
}

/// Trees whose leaves are bare triangles: box against box, triangle against box, and pairs of triangles as candidates.
template <class Boxes>
void traverseNoLeaf(const Query& query, const PairFrame& frame, const Boxes& boxesA, const Boxes& boxesB, Counter count,
                    CandidateList out) {
  const NoLeafTree& a = query.a->noLeaf();
  const NoLeafTree& b = query.b->noLeaf();
  const DescentRule rule = query.options.middle.descent;
  const BoxPairTest boxes(frame.boxes, query.options.middle.axes);
  const TriangleBoxTest triangles(query, frame);
  // A reference is an inner node (>= 0) or ~triangle.
  std::vector<Item> stack;
  stack.reserve(2 * kMaxTreeDepth + 8);
  stack.push_back({a.nodes.empty() ? ~0 : 0, b.nodes.empty() ? ~0 : 0, 0, true});
  while (!stack.empty()) {
    const Item item = stack.back();
    stack.pop_back();
    const bool leafA = item.a < 0, leafB = item.b < 0;
    if (leafA && leafB) {
      out.add({static_cast<std::uint32_t>(~item.a), static_cast<std::uint32_t>(~item.b)});
      continue;
    }
    bool descendA = !leafA;
    const auto depth = static_cast<std::uint16_t>(item.depth + 1);
    if (!leafA && !leafB) {
      const NoLeafNode &na = a.nodes[item.a], &nb = b.nodes[item.b];
      const auto& placedA = boxesA(na);
      const auto& placedB = boxesB(nb);
      const Box boxA{placedA.center, placedA.extent}, boxB{placedB.center, placedB.extent};
      count.boxTest(item.depth);
      if (boxes.apart(boxA, boxB)) continue;
      if (rule == DescentRule::kBoth) {
        const auto two = static_cast<std::uint16_t>(item.depth + 2);
        stack.push_back({na.left, nb.left, two, true});
        stack.push_back({na.left, nb.right, two, true});
        stack.push_back({na.right, nb.left, two, true});
        stack.push_back({na.right, nb.right, two, true});
        continue;
      }
      if (rule == DescentRule::kLargerFirst) descendA = sizeOf(boxA) >= sizeOf(boxB);
      if (rule == DescentRule::kAlternating) descendA = item.descendA;
    } else if (leafA) {
      const NoLeafNode& nb = b.nodes[item.b];
      count.triangleBoxTest();
      const auto& box = boxesB(nb);
      if (triangles.apartA(static_cast<std::uint32_t>(~item.a), box.center, box.extent)) continue;
    } else {
      const NoLeafNode& na = a.nodes[item.a];
      count.triangleBoxTest();
      const auto& box = boxesA(na);
      if (triangles.apartB(static_cast<std::uint32_t>(~item.b), box.center, box.extent)) continue;
    }
    if (descendA) {
      stack.push_back({a.nodes[item.a].left, item.b, depth, false});
      stack.push_back({a.nodes[item.a].right, item.b, depth, false});
    } else {
      stack.push_back({item.a, b.nodes[item.b].left, depth, true});
      stack.push_back({item.a, b.nodes[item.b].right, depth, true});
    }
  }
}

/// With the boxes of both meshes.
template <class Boxes>
void traverse(const Query& query, const PairFrame& frame, const Boxes& boxesA, const Boxes& boxesB, Counter count,
              CandidateList out) {
  const MiddleOptions& options = query.options.middle;
  const BoxPairTest test(frame.boxes, options.axes);
  if (options.traversal == Traversal::kQuantized) {
    using View = QuantizedView<Boxes>;
    traverseBoxed(View{query.a->quantized(), boxesA}, View{query.b->quantized(), boxesB}, test, options.descent, count,
                  out);
  } else if (options.traversal == Traversal::kNoLeaf) {
    traverseNoLeaf(query, frame, boxesA, boxesB, count, out);
  } else {
    using View = StandardView<Boxes>;
    traverseBoxed(View{query.a->tree(), boxesA}, View{query.b->tree(), boxesB}, test, options.descent, count, out);
  }
}

}  // namespace

void middlePhase(const Query& query, Workspace& workspace) {
  using Clock = std::chrono::steady_clock;
  const auto start = query.options.timings ? Clock::now() : Clock::time_point{};
  // Nothing of the query before may pass for a result of this one, should it be refused.
  workspace.clear();
  CollideStats& stats = workspace.stats;
  requireRigid(query.bInA);
  if (query.a->mesh().triangleCount() == 0 || query.b->mesh().triangleCount() == 0) return;
  const PairFrame frame = makePairFrame(query);
  if (!frame.finite) return;
  const Counter count(stats, query.options.countPerDepth);
  if (query.options.middle.traversal == Traversal::kWide) {
    traverseWide(bestSimdLevel(), query, frame, workspace.candidates, stats);
  } else {
    withBoxes(query.a->boxScale(), query.b->boxScale(), [&](const auto& boxesA, const auto& boxesB) {
      const auto most = static_cast<std::size_t>(query.options.middle.maxPairs);
      traverse(query, frame, boxesA, boxesB, count, CandidateList(workspace.candidates, most));
    });
  }
  stats.candidatePairs = workspace.candidates.size();
  if (query.options.timings) stats.middleMs = std::chrono::duration<double, std::milli>(Clock::now() - start).count();
}

}  // namespace otg
