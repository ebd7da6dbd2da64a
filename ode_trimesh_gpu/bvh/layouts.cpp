// SPDX-License-Identifier: BSD-3-Clause
// The quantised and the no-leaf layout, made from the binary tree.
#include "bvh/layouts.h"

#include <algorithm>
#include <cmath>

#include "shared/math/expansion.h"

namespace otg {
namespace {

/// Smallest power of two with largest / step <= limit, but never so small that a product with it would be subnormal:
/// some devices flush those to zero.
float stepFor(double largest, double limit) {
  int exponent = 0;
  const double mantissa = std::frexp(largest / limit, &exponent);
  if (mantissa == 0.5) --exponent;
  return largest > 0 ? std::ldexp(1.0f, std::max(exponent, -126)) : 0x1p-126f;
}

/// Steps up from `decoded` and down from it until a box of the given centre and extent is covered in exact arithmetic.
std::uint16_t stepsToCover(double decoded, double center, double extent, double step) {
  double distance, lostDistance, reach, lostReach;
  otgTwoSum(decoded, -center, &distance, &lostDistance);
  otgTwoSum(std::fabs(distance), extent, &reach, &lostReach);
  const double lost = std::fabs(lostDistance) + std::fabs(lostReach);
  double steps = std::ceil(reach / step);  // exact: step is a power of two
  if (steps * step - reach < 2 * lost) ++steps;
  return static_cast<std::uint16_t>(steps);
}

void quantizeNode(const BvhNode& n, const float (&centerStep)[3], const float (&extentStep)[3], QuantizedNode& q) {
  const double c[3] = {n.center.x, n.center.y, n.center.z}, e[3] = {n.extent.x, n.extent.y, n.extent.z};
  q.child = n.child;
  for (int k = 0; k < 3; ++k) {
    q.center[k] = static_cast<std::int16_t>(std::lround(c[k] / centerStep[k]));
    q.extent[k] = stepsToCover(q.center[k] * double{centerStep[k]}, c[k], e[k], extentStep[k]);
  }
}

}  // namespace

QuantizedTree quantizeTree(const BinaryTree& tree) {
  QuantizedTree out;
  out.nodes.resize(tree.nodes.size());
  if (tree.nodes.empty()) return out;
  float center[3] = {0, 0, 0}, extent[3] = {0, 0, 0};
  for (const BvhNode& n : tree.nodes) {
    const float c[3] = {n.center.x, n.center.y, n.center.z}, e[3] = {n.extent.x, n.extent.y, n.extent.z};
    for (int k = 0; k < 3; ++k) {
      center[k] = std::max(center[k], std::fabs(c[k]));
      extent[k] = std::max(extent[k], e[k]);
    }
  }
  float centerStep[3], extentStep[3];
  for (int k = 0; k < 3; ++k) {
    centerStep[k] = stepFor(center[k], 32767.0);
    // An extent must also reach over what rounding the centre loses, half a centre step; the last of the 65,535 steps
    // is kept for rounding up.
    extentStep[k] = stepFor(double{extent[k]} + 0.5 * centerStep[k], 65534.0);
  }
  out.centerStep = {centerStep[0], centerStep[1], centerStep[2]};
  out.extentStep = {extentStep[0], extentStep[1], extentStep[2]};
  for (std::size_t i = 0; i < tree.nodes.size(); ++i) {
    quantizeNode(tree.nodes[i], centerStep, extentStep, out.nodes[i]);
  }
  return out;
}

bool refitLayout(QuantizedTree& quantized, const BinaryTree& tree, std::span<const std::uint32_t> nodes) {
  const float centerStep[3] = {quantized.centerStep.x, quantized.centerStep.y, quantized.centerStep.z};
  const float extentStep[3] = {quantized.extentStep.x, quantized.extentStep.y, quantized.extentStep.z};
  for (const std::uint32_t i : nodes) {
    const BvhNode& n = tree.nodes[i];
    const float c[3] = {n.center.x, n.center.y, n.center.z}, e[3] = {n.extent.x, n.extent.y, n.extent.z};
    for (int k = 0; k < 3; ++k) {
      // As many steps as quantizeTree() leaves room for.
      if (!(std::fabs(c[k]) <= 32767.0 * centerStep[k]) ||
          !(double{e[k]} + 0.5 * centerStep[k] <= 65534.0 * extentStep[k])) {
        return false;
      }
    }
  }
  for (const std::uint32_t i : nodes) quantizeNode(tree.nodes[i], centerStep, extentStep, quantized.nodes[i]);
  return true;
}

NoLeafTree makeNoLeafTree(const BinaryTree& tree) {
  NoLeafTree out;
  out.triangleCount = static_cast<std::uint32_t>((tree.nodes.size() + 1) / 2);
  if (tree.nodes.size() < 3) return out;
  // Inner nodes keep their order.
  std::vector<std::int32_t> index(tree.nodes.size(), -1);
  std::int32_t count = 0;
  for (std::size_t i = 0; i < tree.nodes.size(); ++i) {
    if (!tree.nodes[i].isLeaf()) index[i] = count++;
  }
  out.nodes.reserve(static_cast<std::size_t>(count));
  const auto reference = [&](std::int32_t node) {
    return tree.nodes[node].isLeaf() ? tree.nodes[node].child : index[node];
  };
  for (const BvhNode& n : tree.nodes) {
    if (!n.isLeaf()) out.nodes.push_back({n.center, n.extent, reference(n.child), reference(n.child + 1)});
  }
  return out;
}

}  // namespace otg
