// SPDX-License-Identifier: BSD-3-Clause
// Filling a caller's smaller array.
#include <map>
#include <set>

#include "base/vectors.h"
#include "collide/contact_order.h"
#include "collide/pairwise/reduction.h"
#include "support/catch.h"
#include "support/contact_samples.h"

using namespace otg;
using namespace otg::test;

namespace {

/// In the grid of 1,023 steps along the diagonal of the positions' bounds, and from one normal to its opposite.
long squaredDistance(const Contact& x, const Contact& y, const Vec3d& low, double diagonal) {
  const auto step = [](double u) { return std::lround(std::floor(std::clamp(1023 * u, 0.0, 1023.0) + 0.5)); };
  const auto squared = [&](double u, double v) { return (step(u) - step(v)) * (step(u) - step(v)); };
  const Vec3d p = otgScale(otgSub(x.position, low), 1 / diagonal), q = otgScale(otgSub(y.position, low), 1 / diagonal);
  const Vec3d n = otgScale(x.normal, 0.5), m = otgScale(y.normal, 0.5);
  return squared(p.x, q.x) + squared(p.y, q.y) + squared(p.z, q.z) + squared(0.5 + n.x, 0.5 + m.x) +
         squared(0.5 + n.y, 0.5 + m.y) + squared(0.5 + n.z, 0.5 + m.z);
}

Vec3d rounded(const Vec3d& p) {
  return {static_cast<float>(p.x), static_cast<float>(p.y), static_cast<float>(p.z)};
}

/// The definition by brute force: representatives, then always the farthest from all chosen.
std::vector<Contact> naive(std::vector<Contact> all, std::size_t count) {
  std::sort(all.begin(), all.end(), contactDeeper);
  Vec3d low = rounded(all[0].position), high = low;
  for (const Contact& c : all) {
    const Vec3d p = rounded(c.position);
    low = {std::min(low.x, p.x), std::min(low.y, p.y), std::min(low.z, p.z)};
    high = {std::max(high.x, p.x), std::max(high.y, p.y), std::max(high.z, p.z)};
  }
  const Vec3d size = otgSub(high, low);
  const double diagonal = norm(size);
  std::vector<Contact> chosen;
  std::set<std::uint32_t> regions;
  for (const Contact& c : all) {
    if (chosen.size() < count && regions.insert(c.region).second) chosen.push_back(c);
  }
  while (chosen.size() < count) {
    const Contact* best = nullptr;
    long bestDistance = -1;
    for (const Contact& c : all) {
      if (contains(chosen, c)) continue;
      long d = 1L << 40;
      for (const Contact& k : chosen) d = std::min(d, squaredDistance(c, k, low, diagonal));
      if (d > bestDistance) {
        bestDistance = d;
        best = &c;
      }
    }
    chosen.push_back(*best);
  }
  std::sort(chosen.begin(), chosen.end(), contactDeeper);
  return chosen;
}

}  // namespace

TEST_CASE("limiting follows its definition") {
  const std::vector<Contact> contacts = randomContacts(31, 150, 0.9, 6);
  for (const int count : {1, 3, 6, 7, 20, 64, 149}) {
    CHECK(same(limitContacts(contacts, count), naive(contacts, static_cast<std::size_t>(count))));
  }
}

TEST_CASE("the deepest of every region is kept, the deepest regions when there are more than places") {
  const std::vector<Contact> contacts = randomContacts(32, 2000, 1, 40);
  std::map<std::uint32_t, double> deepest;
  for (const Contact& c : contacts) deepest[c.region] = std::max(deepest[c.region], c.depth);
  REQUIRE(deepest.size() == 40);
  for (const int count : {40, 41, 64, 500}) {
    const std::vector<Contact> kept = limitContacts(contacts, count);
    REQUIRE(kept.size() == static_cast<std::size_t>(count));
    std::map<std::uint32_t, double> found;
    for (const Contact& c : kept) found[c.region] = std::max(found[c.region], c.depth);
    CHECK(found == deepest);
  }
  std::vector<double> depths;
  for (const auto& [region, depth] : deepest) depths.push_back(depth);
  std::sort(depths.rbegin(), depths.rend());
  const std::vector<Contact> kept = limitContacts(contacts, 10);
  REQUIRE(kept.size() == 10);
  std::set<std::uint32_t> regions;
  for (std::size_t i = 0; i < kept.size(); ++i) {
    CHECK(regions.insert(kept[i].region).second);
    CHECK(kept[i].depth == depths[i]);
  }
}

TEST_CASE("places enough: everything comes back, deepest first") {
  const std::vector<Contact> contacts = randomContacts(33, 300, 1, 3);
  for (const int count : {300, 301, 65535}) {
    const std::vector<Contact> kept = limitContacts(contacts, count);
    REQUIRE(kept.size() == 300);
    CHECK(std::is_sorted(kept.begin(), kept.end(), contactDeeper));
    for (const Contact& c : contacts) CHECK(contains(kept, c));
  }
}

TEST_CASE("one place goes to the deepest, ties to the smallest ids; the order of the input does not matter") {
  std::vector<Contact> contacts = randomContacts(34, 100, 1, 5);
  for (Contact& c : contacts) c.depth = c.triangleA % 4 == 1 ? 0.5 : 0.25;
  const std::vector<Contact> one = limitContacts(contacts, 1);
  REQUIRE(one.size() == 1);
  CHECK(same(one[0], *std::min_element(contacts.begin(), contacts.end(), contactDeeper)));
  CHECK(one[0].triangleA == 1);
  for (const int count : {1, 4, 33}) {
    const std::vector<Contact> kept = limitContacts(contacts, count);
    for (std::uint32_t seed = 0; seed < 6; ++seed) CHECK(same(limitContacts(shuffled(contacts, seed), count), kept));
  }
}

TEST_CASE("equally far contacts are taken by their ids") {
  std::vector<Contact> corners;  // of a cube
  for (std::uint32_t i = 0; i < 8; ++i) {
    corners.push_back(makeContact({i & 1 ? 1.0 : 0, i & 2 ? 1.0 : 0, i & 4 ? 1.0 : 0}, {0, 0, 1}, 0.01, i, i));
  }
  // The first, the one opposite, and then all six others are one edge from the nearest chosen one, whichever is taken.
  for (std::uint32_t seed = 0; seed < 6; ++seed) {
    const std::vector<Contact> kept = limitContacts(shuffled(corners, seed), 5);
    REQUIRE(kept.size() == 5);
    for (const std::uint32_t i : {0u, 1u, 2u, 3u, 7u}) CHECK(contains(kept, corners[i]));
  }
}

TEST_CASE("a flat square keeps its corners") {
  std::vector<Contact> contacts;
  for (std::uint32_t i = 0; i < 11 * 11; ++i) {
    contacts.push_back(makeContact({0.1 * (i / 11), 0.1 * (i % 11), 0}, {0, 0, 1}, 0.01, i, i));
  }
  const std::vector<Contact> kept = limitContacts(contacts, 4);
  for (const std::uint32_t corner : {0u, 10u, 110u, 120u}) CHECK(contains(kept, contacts[corner]));
}

TEST_CASE("limits of nothing, of duplicates, of no places") {
  CHECK(limitContacts({}, 5).empty());
  const Contact one = makeContact({1, 2, 3}, {1, 0, 0}, 0.5, 1, 2);
  CHECK(limitContacts(std::vector<Contact>{one}, 0).empty());
  CHECK(limitContacts(std::vector<Contact>{one}, 1).size() == 1);
  const std::vector<Contact> kept = limitContacts(std::vector<Contact>(20, one), 7);
  REQUIRE(kept.size() == 7);
  for (const Contact& c : kept) CHECK(same(c, one));
  // Distinct contacts come before second copies.
  std::vector<Contact> mixed(20, one);
  mixed.push_back(makeContact({1, 2, 4}, {1, 0, 0}, 0.1, 7, 7));
  CHECK(contains(limitContacts(mixed, 2), mixed.back()));
}

TEST_CASE("very many contacts and places: sizes, regions, no repetition") {
  const std::vector<Contact> contacts = randomContacts(35, 20000, 1, 3000);
  std::set<std::uint32_t> regions;
  for (const Contact& c : contacts) regions.insert(c.region);
  const std::vector<Contact> kept = limitContacts(contacts, 12000);
  REQUIRE(kept.size() == 12000);
  std::set<std::uint32_t> keptRegions;
  for (const Contact& c : kept) keptRegions.insert(c.region);
  CHECK(keptRegions == regions);
  for (std::size_t i = 1; i < kept.size(); ++i) REQUIRE(contactDeeper(kept[i - 1], kept[i]));
}
