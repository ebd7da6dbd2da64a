// SPDX-License-Identifier: BSD-3-Clause
#include "bvh/collapse_tree.h"

#include <algorithm>

namespace otg {
namespace {

float areaOf(const BvhNode& n) {
  return n.extent.x * n.extent.y + n.extent.y * n.extent.z + n.extent.z * n.extent.x;
}

/// Of two subtrees in so many lanes, the left one in `ofLeft` of them.
template <class Costs>
float costOf(const Costs& left, const Costs& right, int lanes, int ofLeft) {
  return left[ofLeft - 1] + right[lanes - 1 - ofLeft];
}

/// How many lanes the left one gets, for the least cost.
template <class Costs>
int bestShare(const Costs& left, const Costs& right, int lanes) {
  int best = 1;
  for (int k = 2; k < lanes; ++k) {
    if (costOf(left, right, lanes, k) < costOf(left, right, lanes, best)) best = k;
  }
  return best;
}

}  // namespace

void TreeCollapse::count(std::size_t node) {
  Costs& cost = costs_[node];
  const Costs &left = costs_[tree_.nodes[node].child], &right = costs_[tree_.nodes[node].child + 1];
  const auto shared = [&](int lanes) { return costOf(left, right, lanes, bestShare(left, right, lanes)); };
  cost[0] = areaOf(tree_.nodes[node]) + shared(kWideArity);
  for (int most = 2; most < kWideArity; ++most) cost[most - 1] = std::min(cost[most - 2], shared(most));
}

void TreeCollapse::split(std::int32_t node, int lanes, std::int32_t* slots, int& count) const {
  // Of an end all costs are alike, and it takes one lane.
  const Costs& cost = costs_[node];
  while (lanes > 1 && cost[lanes - 1] == cost[lanes - 2]) --lanes;
  if (lanes > 1) {
    share(node, lanes, slots, count);
  } else {
    slots[count++] = node;
  }
}

void TreeCollapse::share(std::int32_t node, int lanes, std::int32_t* slots, int& count) const {
  const std::int32_t left = tree_.nodes[node].child, right = left + 1;
  const int ofLeft = bestShare(costs_[left], costs_[right], lanes);
  split(left, ofLeft, slots, count);
  split(right, lanes - ofLeft, slots, count);
}

}  // namespace otg
