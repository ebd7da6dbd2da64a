// SPDX-License-Identifier: BSD-3-Clause
#include "bvh/image_boxes.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/block_sum.h"

namespace otg {
namespace {

constexpr double kUnit = 0x1p-24;
/// Beyond this, sums of a few coordinates might leave single precision.
constexpr double kLargest = 1e36;
/// Boxes may reach this part of the radius beyond the bounds: otgPairBounds has room for a little more.
constexpr double kLargestPad = 1.0 / 64;
/// What the five products and sums of a box, and the product of a vertex, lose at most where they underflow.
constexpr double kUnderflow = 0x1p-123;

float roundedUp(double x) {
  const auto f = static_cast<float>(x);
  return double{f} < x ? std::nextafter(f, std::numeric_limits<float>::infinity()) : f;
}

struct Axis {
  float factor, shift, growth, pad;
};

/// False where the boxes' numbers would be too large.
bool makeAxis(float factor, float origin, float imageOrigin, float low, float high, Axis& axis) {
  const double s = factor, moved = s * origin, exact = moved - imageOrigin;  // the product of two floats is exact
  const double reach = std::max(std::fabs(double{low} - origin), std::fabs(double{high} - origin));
  const double size = std::fabs(s);
  if (!(reach < kLargest && size * reach + std::fabs(exact) < kLargest)) return false;
  axis.factor = factor;
  axis.shift = static_cast<float>(exact);
  axis.growth = roundedUp(size * (1 + 8 * kUnit));
  const double lost = std::fabs(exact - axis.shift) + 0x1p-50 * (std::fabs(moved) + std::fabs(double{imageOrigin}));
  axis.pad = roundedUp((1 + 8 * kUnit) *
                       (lost + kUnit * (std::fabs(moved) + 2.01 * std::fabs(double{axis.shift})) + kUnderflow));
  return true;
}

}  // namespace

std::optional<BoxScale<float>> makeBoxScale(const TriMesh& mesh, const TriMesh& image, const Vec3f& factors) {
  if (mesh.triangleCount() == 0) return kSameBoxes;
  if (!image.isNumberedAs(mesh)) return std::nullopt;
  const Vec3f &o = mesh.origin(), &moved = image.origin(), &low = mesh.boundsMin(), &high = mesh.boundsMax();
  Axis x, y, z;
  if (!makeAxis(factors.x, o.x, moved.x, low.x, high.x, x) || !makeAxis(factors.y, o.y, moved.y, low.y, high.y, y) ||
      !makeAxis(factors.z, o.z, moved.z, low.z, high.z, z)) {
    return std::nullopt;
  }
  if (!(std::max({x.pad, y.pad, z.pad}) <= kLargestPad * double{image.radius()})) return std::nullopt;
  return BoxScale<float>{{x.factor, y.factor, z.factor},
                         {x.shift, y.shift, z.shift},
                         {x.growth, y.growth, z.growth},
                         {x.pad, y.pad, z.pad},
                         static_cast<float>(8 * kUnit)};
}

bool stretchesTooMuch(const Vec3f& factors) {
  const double x = std::fabs(double{factors.x}), y = std::fabs(double{factors.y}), z = std::fabs(double{factors.z});
  return std::max({x, y, z}) > kMostStretch * std::min({x, y, z});
}

double sahCost(const BinaryTree& tree, const BoxScale<float>& scale) {
  if (tree.nodes.empty()) return 0;
  const auto area = [&](const BvhNode& node) {
    const Vec3f e = scaledBox(scale, node.center, node.extent).extent;
    return double{e.x} * e.y + double{e.y} * e.z + double{e.z} * e.x;
  };
  BlockSum sum;
  for (const BvhNode& node : tree.nodes) sum.add(area(node));
  const double root = area(tree.nodes[0]);
  return root > 0 ? sum.total() / root : static_cast<double>(tree.nodes.size());
}

}  // namespace otg
