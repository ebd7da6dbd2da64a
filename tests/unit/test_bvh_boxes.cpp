// SPDX-License-Identifier: BSD-3-Clause
// Boxes of every layout against brute force in exact arithmetic: they contain their triangles, and not much more.
#include <algorithm>

#include "bvh/collision_mesh.h"
#include "bvh/mesh_box.h"
#include "support/catch.h"
#include "support/exact_sum.h"
#include "support/mesh_samples.h"

using namespace otg;
using namespace otg::samples;

namespace {

const float* at(const Vec3f& v) {
  return &v.x;
}

/// Whether every corner of the triangle lies in the box [center - extent, center + extent] of the centred frame.
bool contains(const TriMesh& mesh, const Vec3f& center, const Vec3f& extent, std::uint32_t triangle) {
  for (const std::uint32_t v : mesh.triangles()[triangle].v) {
    for (int k = 0; k < 3; ++k) {
      const float x = at(mesh.vertices()[v])[k], o = at(mesh.center())[k];
      const float c = at(center)[k], e = at(extent)[k];
      if (std::isinf(e)) continue;
      if (ExactSum().add(x).subtract(o).subtract(c).add(e).sign() < 0) return false;
      if (ExactSum().add(x).subtract(o).subtract(c).subtract(e).sign() > 0) return false;
    }
  }
  return true;
}

/// Leaves below each node, by walking up from each leaf: calls check(node, triangle).
template <class Check>
void forEachAncestor(const BinaryTree& tree, const Check& check) {
  for (std::size_t i = 0; i < tree.nodes.size(); ++i) {
    if (!tree.nodes[i].isLeaf()) continue;
    for (auto node = static_cast<std::uint32_t>(i); node != kNone; node = tree.nodes[node].parent) {
      check(node, tree.nodes[i].triangle());
    }
  }
}

Vec3f decode(const std::int16_t (&q)[3], const Vec3f& step) {
  return {q[0] * step.x, q[1] * step.y, q[2] * step.z};
}
Vec3f decode(const std::uint16_t (&q)[3], const Vec3f& step) {
  return {q[0] * step.x, q[1] * step.y, q[2] * step.z};
}

std::vector<NamedMesh> allMeshes() {
  std::vector<NamedMesh> meshes = ordinaryMeshes();
  for (NamedMesh& mesh : pathologicalMeshes()) {
    if (mesh.mesh->triangleCount() <= 20000) meshes.push_back(std::move(mesh));
  }
  // Coordinates whose difference from the middle of the mesh is not a double.
  Soup wide;
  std::mt19937 random(5);
  std::uniform_int_distribution<int> exponent(-140, 120), sign(0, 1);
  std::uniform_real_distribution<float> mantissa(1, 2);
  const auto any = [&] { return (sign(random) ? -1.0f : 1.0f) * std::ldexp(mantissa(random), exponent(random)); };
  for (int i = 0; i < 2000; ++i) wide.add({any(), any(), any()}, {any(), any(), any()}, {any(), any(), any()});
  meshes.push_back({"all magnitudes", wide.build()});
  return meshes;
}

}  // namespace

TEST_CASE("the oracle adds exactly") {
  constexpr float kTiny = std::numeric_limits<float>::denorm_min(), kLargest = std::numeric_limits<float>::max();
  REQUIRE(ExactSum().sign() == 0);
  REQUIRE(ExactSum().add(kLargest).add(kTiny).subtract(kLargest).sign() == 1);
  REQUIRE(ExactSum().add(kLargest).subtract(kTiny).subtract(kLargest).sign() == -1);
  REQUIRE(ExactSum().add(kLargest).add(kLargest).subtract(kLargest).subtract(kLargest).sign() == 0);
  REQUIRE(ExactSum().add(1).subtract(0.75f).subtract(0.25f).sign() == 0);
  REQUIRE(ExactSum().add(-1e-30f).add(1e-31f).sign() == -1);
}

TEST_CASE("one axis of a box encloses any interval about any origin") {
  std::mt19937 random(6);
  std::uniform_int_distribution<int> exponent(-149, 125), sign(0, 1), shape(0, 3);
  std::uniform_real_distribution<float> mantissa(1, 2);
  const auto any = [&] { return (sign(random) ? -1.0f : 1.0f) * std::ldexp(mantissa(random), exponent(random)); };
  std::size_t outside = 0, infinite = 0;
  const auto check = [&](float lo, float hi, float origin) {
    float c = 0, e = 0;
    encloseAxis(lo, hi, origin, c, e);
    infinite += !std::isfinite(c) || !std::isfinite(e);
    outside += ExactSum().add(lo).subtract(origin).subtract(c).add(e).sign() < 0;
    outside += ExactSum().add(hi).subtract(origin).subtract(c).subtract(e).sign() > 0;
  };
  for (int i = 0; i < 200000; ++i) {
    const float a = any(), origin = any();
    const int kind = shape(random);
    const float b = kind == 0 ? a : kind == 1 ? std::nextafter(a, 0.0f) : any();  // flat, nearly flat, any
    check(std::min(a, b), std::max(a, b), origin);
  }
  // Flat, and center + origin rounds to exactly where the interval is.
  check(1e10f, 1e10f, 1e-30f);
  check(1e-30f, 1e-30f, 1e10f);
  check(-1, -1, -1e-20f);
  REQUIRE(outside == 0);
  REQUIRE(infinite == 0);
  // Nothing to enclose costs nothing: a flat box on a coarse grid stays flat.
  float c = 1, e = 1;
  encloseAxis(2.5f, 2.5f, 1.0f, c, e);
  REQUIRE(c == 1.5f);
  REQUIRE(e == 0.0f);
}

TEST_CASE("boxes of the binary tree contain the triangles below them") {
  for (const NamedMesh& sample : allMeshes()) {
    INFO(sample.name);
    for (const BuildStrategy strategy : {BuildStrategy::kMeanSplit, BuildStrategy::kSah}) {
      const BinaryTree tree = buildTree(*sample.mesh, strategy);
      std::size_t outside = 0;
      forEachAncestor(tree, [&](std::uint32_t node, std::uint32_t triangle) {
        outside += !contains(*sample.mesh, tree.nodes[node].center, tree.nodes[node].extent, triangle);
      });
      REQUIRE(outside == 0);
      REQUIRE(std::all_of(tree.nodes.begin(), tree.nodes.end(), [](const BvhNode& node) {
        return std::isfinite(node.extent.x) && std::isfinite(node.extent.y) && std::isfinite(node.extent.z);
      }));
    }
  }
}

TEST_CASE("boxes of the binary tree are tight") {
  // Brute force in double: the half-width below each node, with what rounding a centre and an extent may cost.
  for (const NamedMesh& sample : ordinaryMeshes()) {
    INFO(sample.name);
    const BinaryTree tree = buildTree(*sample.mesh, BuildStrategy::kSah);
    constexpr double kInfinity = std::numeric_limits<double>::infinity();
    std::vector<double> lo(3 * tree.nodes.size(), kInfinity), hi(3 * tree.nodes.size(), -kInfinity);
    forEachAncestor(tree, [&](std::uint32_t node, std::uint32_t triangle) {
      for (const std::uint32_t v : sample.mesh->triangles()[triangle].v) {
        for (std::size_t k = 0; k < 3; ++k) {
          const double x = double{at(sample.mesh->vertices()[v])[k]} - at(sample.mesh->center())[k];
          lo[3 * node + k] = std::min(lo[3 * node + k], x);
          hi[3 * node + k] = std::max(hi[3 * node + k], x);
        }
      }
    });
    std::size_t loose = 0;
    for (std::size_t i = 0; i < tree.nodes.size(); ++i) {
      for (std::size_t k = 0; k < 3; ++k) {
        const double half = 0.5 * (hi[3 * i + k] - lo[3 * i + k]);
        const double c = at(tree.nodes[i].center)[k], e = at(tree.nodes[i].extent)[k];
        loose += e > half * (1 + 0x1p-22) + std::fabs(c) * 0x1p-23;
      }
    }
    REQUIRE(loose == 0);
  }
}

TEST_CASE("decoded boxes of the quantised tree contain the triangles below them and decode exactly") {
  for (const NamedMesh& sample : allMeshes()) {
    INFO(sample.name);
    const BinaryTree tree = buildTree(*sample.mesh, BuildStrategy::kSah);
    const QuantizedTree quantized = quantizeTree(tree);
    REQUIRE(quantized.nodes.size() == tree.nodes.size());
    std::size_t outside = 0, renumbered = 0, inexact = 0, loose = 0;
    forEachAncestor(tree, [&](std::uint32_t node, std::uint32_t triangle) {
      const QuantizedNode& q = quantized.nodes[node];
      outside += !contains(*sample.mesh, decode(q.center, quantized.centerStep), decode(q.extent, quantized.extentStep),
                           triangle);
    });
    for (std::size_t i = 0; i < tree.nodes.size(); ++i) {
      const QuantizedNode& q = quantized.nodes[i];
      renumbered += q.child != tree.nodes[i].child;
      const Vec3f c = decode(q.center, quantized.centerStep), e = decode(q.extent, quantized.extentStep);
      for (int k = 0; k < 3; ++k) {
        const double centerStep = at(quantized.centerStep)[k], extentStep = at(quantized.extentStep)[k];
        inexact += double{at(c)[k]} != q.center[k] * centerStep;
        // Beyond 1e38 a decoded extent may be infinite: sound, but not equal.
        inexact += std::isfinite(at(e)[k]) && double{at(e)[k]} != q.extent[k] * extentStep;
        loose += at(e)[k] > double{at(tree.nodes[i].extent)[k]} + 0.5 * centerStep + 2 * extentStep &&
                 std::isfinite(at(e)[k]);
      }
    }
    REQUIRE(outside == 0);
    REQUIRE(renumbered == 0);
    REQUIRE(inexact == 0);
    REQUIRE(loose == 0);
  }
}

TEST_CASE("a quantised extent reaches over what the sum of its parts rounds away") {
  // Steps 2^-15 and 2^-19; the last centre is off its grid by four extent steps, which with an extent far below the
  // rounding of double must make five.
  BinaryTree tree;
  tree.nodes = std::vector<BvhNode>(3);
  tree.nodes[0] = {{0, 0, 0}, {0.1f, 0.1f, 0.1f}, 1, kNone};
  tree.nodes[1] = {{0.75f, 0.75f, 0.75f}, {0, 0, 0}, ~0, 0};
  const float off = 0.75f - 0x1p-17f;
  tree.nodes[2] = {{off, off, off}, {1e-30f, 1e-30f, 0}, ~1, 0};
  const QuantizedTree quantized = quantizeTree(tree);
  REQUIRE(quantized.centerStep == Vec3f{0x1p-15f, 0x1p-15f, 0x1p-15f});
  REQUIRE(quantized.extentStep == Vec3f{0x1p-19f, 0x1p-19f, 0x1p-19f});
  REQUIRE(quantized.nodes[2].extent[0] == 5);
  REQUIRE(quantized.nodes[2].extent[1] == 5);
  REQUIRE(quantized.nodes[2].extent[2] == 4);
  REQUIRE(quantized.nodes[1].extent[0] == 0);
}

TEST_CASE("quantised boxes use the range of their integers") {
  const MeshPtr mesh = scenes::build(scenes::makeSphere(1.0, 3));
  const QuantizedTree quantized = quantizeTree(buildTree(*mesh, BuildStrategy::kSah));
  int center = 0, extent = 0;
  for (const QuantizedNode& node : quantized.nodes) {
    center = std::max(center, std::abs(int{node.center[0]}));
    extent = std::max(extent, int{node.extent[0]});
  }
  REQUIRE(center > 16000);
  REQUIRE(extent > 32000);
  // Finite up to 1e38, the range in which collisions are decided at all.
  Soup large;
  large.add({-1e38f, 0, 1e38f}, {1e38f, 1e38f, 0}, {0, -1e38f, -1e38f});
  const QuantizedTree wide = quantizeTree(buildTree(*large.build(), BuildStrategy::kSah));
  for (int k = 0; k < 3; ++k) REQUIRE(std::isfinite(at(decode(wide.nodes[0].extent, wide.extentStep))[k]));
}

TEST_CASE("boxes of the no-leaf tree contain the triangles below them") {
  for (const NamedMesh& sample : allMeshes()) {
    INFO(sample.name);
    const BinaryTree tree = buildTree(*sample.mesh, BuildStrategy::kMeanSplit);
    const NoLeafTree noLeaf = makeNoLeafTree(tree);
    const std::size_t n = sample.mesh->triangleCount();
    REQUIRE(noLeaf.triangleCount == n);
    REQUIRE(noLeaf.nodes.size() == (n > 1 ? n - 1 : 0));
    // Down from the root with the boxes on the way.
    std::vector<std::pair<std::int32_t, std::vector<std::int32_t>>> stack;
    if (n > 1) stack.push_back({0, {}});
    std::vector<int> seen(n, 0);
    std::size_t outside = 0;
    while (!stack.empty()) {
      auto [reference, way] = stack.back();
      stack.pop_back();
      if (reference < 0) {
        const auto triangle = static_cast<std::uint32_t>(~reference);
        ++seen.at(triangle);
        for (const std::int32_t above : way) {
          outside += !contains(*sample.mesh, noLeaf.nodes[above].center, noLeaf.nodes[above].extent, triangle);
        }
        continue;
      }
      way.push_back(reference);
      stack.push_back({noLeaf.nodes.at(reference).left, way});
      stack.push_back({noLeaf.nodes.at(reference).right, way});
    }
    REQUIRE(outside == 0);
    if (n > 1) REQUIRE(seen == std::vector<int>(n, 1));
  }
}
