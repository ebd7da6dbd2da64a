// SPDX-License-Identifier: BSD-3-Clause
#include "bvh/layouts.h"

#include <algorithm>
#include <cmath>

namespace otg {
namespace {

/// Smallest power of two with largest / step <= limit (and never subnormal, so that products stay exact).
float stepFor(double largest, double limit) {
  if (!(largest > 0)) return 0x1p-100f;
  int exponent = 0;
  std::frexp(largest / limit, &exponent);
  return std::ldexp(1.0f, std::max(exponent, -120));
}

}  // namespace

QuantizedTree quantizeTree(const BinaryTree& tree) {
  QuantizedTree out;
  out.nodes.resize(tree.nodes.size());
  if (tree.nodes.empty()) return out;
  double center[3] = {0, 0, 0}, extent[3] = {0, 0, 0};
  for (const BvhNode& n : tree.nodes) {
    const float c[3] = {n.center.x, n.center.y, n.center.z}, e[3] = {n.extent.x, n.extent.y, n.extent.z};
    for (int k = 0; k < 3; ++k) {
      center[k] = std::max(center[k], std::fabs(double{c[k]}));
      extent[k] = std::max(extent[k], double{e[k]});
    }
  }
  float centerStep[3], extentStep[3];
  for (int k = 0; k < 3; ++k) {
    centerStep[k] = stepFor(center[k], 32766.0);
    // An extent must also reach over what rounding the centre loses, half a centre step.
    extentStep[k] = stepFor(extent[k] + centerStep[k], 65534.0);
  }
  out.centerStep = {centerStep[0], centerStep[1], centerStep[2]};
  out.extentStep = {extentStep[0], extentStep[1], extentStep[2]};
  for (std::size_t i = 0; i < tree.nodes.size(); ++i) {
    const BvhNode& n = tree.nodes[i];
    const double c[3] = {n.center.x, n.center.y, n.center.z}, e[3] = {n.extent.x, n.extent.y, n.extent.z};
    out.nodes[i].child = n.child;
    for (int k = 0; k < 3; ++k) {
      const auto q = static_cast<std::int16_t>(std::lround(c[k] / centerStep[k]));
      const double decoded = static_cast<double>(q) * centerStep[k];
      // |decoded - c| + e is exact in double (floats on nearby grids) up to one rounding, for which one step is added
      // where rounding up to the grid left no slack.
      const double reach = std::fabs(decoded - c[k]) + e[k];
      double steps = std::ceil(reach / extentStep[k]);
      if (steps * extentStep[k] < reach * (1 + 0x1p-50)) steps += 1;
      out.nodes[i].center[k] = q;
      out.nodes[i].extent[k] = static_cast<std::uint16_t>(std::min(steps, 65535.0));
    }
  }
  return out;
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
