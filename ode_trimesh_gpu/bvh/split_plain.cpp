// SPDX-License-Identifier: BSD-3-Clause
// The two simple ways to part a set of triangles: at the mean of their centres, and in halves.
#include "bvh/split_rules.h"

namespace otg {

std::uint32_t splitAtMean(TriangleSet set) {
  // In double, so that squares of floats neither overflow nor vanish. Relative to the first centre, so that the
  // difference below does not cancel far from the origin.
  const Float4 first = set.boxes[0].middle();
  double sum[3] = {0, 0, 0}, squares[3] = {0, 0, 0};
  for (std::uint32_t i = 0; i < set.size; ++i) {
    const Float4 middle = set.boxes[i].middle();
    for (int k = 0; k < 3; ++k) {
      const double d = double{middle[k]} - first[k];
      sum[k] += d;
      squares[k] += d * d;
    }
  }
  int axis = 0;
  double greatest = -1;
  for (int k = 0; k < 3; ++k) {
    const double variance = squares[k] - sum[k] * (sum[k] / set.size);
    if (variance > greatest) {
      greatest = variance;
      axis = k;
    }
  }
  const double mean = first[axis] + sum[axis] / set.size;
  const std::uint32_t left =
      set.partition([&](const MeshBox& box, std::uint32_t) { return box.middle()[axis] < mean; });
  return left == set.size ? 0 : left;
}

std::uint32_t splitInHalves(TriangleSet set, const MeshBox& centers) {
  int axis = 0;
  for (int k = 1; k < 3; ++k) {
    if (double{centers.hi[k]} - centers.lo[k] > double{centers.hi[axis]} - centers.lo[axis]) axis = k;
  }
  struct Item {
    float key;
    std::uint32_t triangle;
    bool operator<(const Item& o) const { return key != o.key ? key < o.key : triangle < o.triangle; }
  };
  std::vector<Item> items(set.size);
  for (std::uint32_t i = 0; i < set.size; ++i) items[i] = {set.boxes[i].middle()[axis], set.triangles[i]};
  const std::uint32_t left = set.size / 2;
  std::nth_element(items.begin(), items.begin() + left, items.end());
  const Item pivot = items[left];
  // The order is total, so exactly `left` items lie below the pivot.
  return set.partition([&](const MeshBox& box, std::uint32_t triangle) {
    return Item{box.middle()[axis], triangle} < pivot;
  });
}

}  // namespace otg
