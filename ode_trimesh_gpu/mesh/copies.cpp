// SPDX-License-Identifier: BSD-3-Clause
#include "mesh/copies.h"

#include <algorithm>
#include <array>
#include <bit>

#include "base/hash.h"

namespace otg {

std::vector<std::uint32_t> findFirstCopies(std::span<const Triangle> triangles, std::span<const std::uint32_t> weld) {
  const auto pointsOf = [&](std::uint32_t t) {
    const std::uint32_t(&v)[3] = triangles[t].v;
    std::array<std::uint32_t, 3> p = {weld[v[0]], weld[v[1]], weld[v[2]]};
    std::rotate(p.begin(), std::min_element(p.begin(), p.end()), p.end());
    return p;
  };
  // Open addressing at most half full. Triangles enter in ascending order, so a slot holds the first one.
  const std::size_t capacity = std::bit_ceil(std::max<std::size_t>(16, 2 * triangles.size()));
  std::vector<std::uint32_t> table(capacity, kNone), first(triangles.size());
  bool any = false;
  for (std::uint32_t t = 0; t < triangles.size(); ++t) {
    const auto p = pointsOf(t);
    std::size_t slot = spreadBits(spreadBits(p[0] | (std::uint64_t{p[1]} << 32)) ^ p[2]) & (capacity - 1);
    while (table[slot] != kNone && pointsOf(table[slot]) != p) slot = (slot + 1) & (capacity - 1);
    if (table[slot] == kNone) table[slot] = t;
    first[t] = table[slot];
    any = any || first[t] != t;
  }
  if (!any) first.clear();
  return first;
}

}  // namespace otg
