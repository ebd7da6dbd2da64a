// SPDX-License-Identifier: BSD-3-Clause
#include "collide/solid/merge_regions.h"

#include <algorithm>
#include <numeric>

#include "base/union_find.h"
#include "base/vectors.h"
#include "collide/pairwise/reduction.h"

namespace otg {
namespace {

constexpr double kCosine = 0.951;  // 18 degrees, as where candidates of one region are merged

}  // namespace

void mergeRegions(double distance, int most, std::vector<Contact>& contacts) {
  std::uint32_t regions = 0;
  for (const Contact& c : contacts) regions = std::max(regions, c.region + 1);
  std::vector<std::uint32_t> order(contacts.size());
  std::iota(order.begin(), order.end(), 0u);
  std::sort(order.begin(), order.end(), [&](std::uint32_t i, std::uint32_t j) {
    const double x = contacts[i].position.x, y = contacts[j].position.x;
    return x != y ? x < y : i < j;
  });
  UnionFind sets(regions);
  for (std::size_t i = 0; i < order.size(); ++i) {
    const Contact& c = contacts[order[i]];
    for (std::size_t j = i + 1; j < order.size(); ++j) {
      const Contact& d = contacts[order[j]];
      if (d.position.x - c.position.x > distance) break;
      if (sets.find(c.region) == sets.find(d.region)) continue;
      const Vec3d apart = d.position - c.position;
      if (otgDot(apart, apart) > distance * distance || otgDot(c.normal, d.normal) < kCosine) continue;
      sets.unite(c.region, d.region);
    }
  }

  std::vector<std::vector<Contact>> merged;
  std::vector<std::uint32_t> number(regions, kNone);
  for (const Contact& contact : contacts) {
    const std::uint32_t root = sets.find(contact.region);
    if (number[root] == kNone) {
      number[root] = static_cast<std::uint32_t>(merged.size());
      merged.emplace_back();
    }
    merged[number[root]].push_back(contact);
    merged[number[root]].back().region = number[root];
  }
  contacts.clear();
  for (const std::vector<Contact>& region : merged) {
    if (region.size() <= static_cast<std::size_t>(std::max(most, 0))) {
      contacts.insert(contacts.end(), region.begin(), region.end());
      continue;
    }
    const std::vector<Contact> chosen = limitContacts(region, most);
    contacts.insert(contacts.end(), chosen.begin(), chosen.end());
  }
}

}  // namespace otg
