// SPDX-License-Identifier: BSD-3-Clause
// Six-dimensional binning against a brute-force reading of its definition.
#include <map>
#include <set>

#include "collide/contact_order.h"
#include "collide/pairwise/reduction.h"
#include "support/catch.h"
#include "support/contact_samples.h"

using namespace otg;
using namespace otg::test;

namespace {

using Bin = std::array<int, 6>;

struct Placed {
  Bin bin;
  double score;
};

/// The definition, one contact at a time.
Placed place(const Contact& c, const std::vector<Contact>& all, const std::array<int, 6>& bins) {
  const auto get = [](const Contact& contact, std::size_t k) {
    const double values[6] = {contact.position.x, contact.position.y, contact.position.z,
                              contact.normal.x,   contact.normal.y,   contact.normal.z};
    return values[k];
  };
  Placed placed{};
  for (std::size_t k = 0; k < 6; ++k) {
    double low = -1, high = 1;
    if (k < 3) {
      // Bounds are rounded to single precision.
      low = high = static_cast<float>(get(all[0], k));
      for (const Contact& other : all) {
        low = std::min<double>(low, static_cast<float>(get(other, k)));
        high = std::max<double>(high, static_cast<float>(get(other, k)));
      }
    }
    const double u = high > low ? (get(c, k) - low) / (high - low) : 0.5;
    placed.bin[k] = std::clamp(static_cast<int>(std::floor(u * bins[k])), 0, bins[k] - 1);
    placed.score += (u - 0.5) * (u - 0.5);
  }
  return placed;
}

}  // namespace

TEST_CASE("binning keeps exactly the extreme contact of every occupied bin") {
  for (const std::array<int, 6> bins :
       {std::array<int, 6>{3, 3, 3, 3, 3, 3}, std::array<int, 6>{1, 1, 1, 1, 1, 1},
        std::array<int, 6>{5, 2, 1, 1, 4, 7}, std::array<int, 6>{64, 64, 64, 2, 2, 2}}) {
    const std::vector<Contact> contacts = randomContacts(17, 1500, 0.8);
    std::map<Bin, double> best;
    for (const Contact& c : contacts) {
      const Placed p = place(c, contacts, bins);
      const auto [it, isNew] = best.emplace(p.bin, p.score);
      if (!isNew) it->second = std::max(it->second, p.score);
    }
    const std::vector<Contact> kept = reduceByBinning(contacts, bins);
    REQUIRE(kept.size() == best.size());
    std::set<Bin> seen;
    for (const Contact& c : kept) {
      CHECK(contains(contacts, c));
      const Placed p = place(c, contacts, bins);
      CHECK(seen.insert(p.bin).second);
      CHECK(p.score == Approx(best.at(p.bin)).epsilon(1e-12));
    }
    CHECK(std::is_sorted(kept.begin(), kept.end(), contactLess));
  }
}

TEST_CASE("binning does not depend on the order of the contacts, and reducing twice changes nothing for one bin") {
  const std::vector<Contact> contacts = randomContacts(5, 700, 3);
  const std::vector<Contact> kept = reduceByBinning(contacts, {3, 3, 3, 3, 3, 3});
  CHECK(kept.size() < contacts.size());
  for (std::uint32_t seed = 0; seed < 10; ++seed) {
    CHECK(same(reduceByBinning(shuffled(contacts, seed), {3, 3, 3, 3, 3, 3}), kept));
  }
  CHECK(reduceByBinning(contacts, {1, 1, 1, 1, 1, 1}).size() == 1);
}

TEST_CASE("ties in a bin go to the smaller triangles, then the smaller feature") {
  // Mirror images: the same distance from the centre of the cube in every coordinate.
  std::vector<Contact> contacts = {makeContact({1, 0, 0}, {0, 0, 1}, 0.1, 4, 2),
                                   makeContact({-1, 0, 0}, {0, 0, 1}, 0.2, 3, 9),
                                   makeContact({-1, 0, 0}, {0, 0, 1}, 0.2, 3, 8),
                                   makeContact({1, 0, 0}, {0, 0, 1}, 0.2, 3, 8, 0, ContactFeature::kVertexB)};
  for (std::uint32_t seed = 0; seed < 8; ++seed) {
    const std::vector<Contact> kept = reduceByBinning(shuffled(contacts, seed), {1, 1, 1, 1, 1, 1});
    REQUIRE(kept.size() == 1);
    CHECK(same(kept[0], contacts[2]));
  }
}

TEST_CASE("binning of nothing, of one contact, of duplicates, of contacts at one place") {
  CHECK(reduceByBinning({}, {3, 3, 3, 3, 3, 3}).empty());
  const Contact one = makeContact({1, 2, 3}, {1, 0, 0}, 0.5, 1, 2);
  REQUIRE(reduceByBinning(std::vector<Contact>{one}, {3, 3, 3, 3, 3, 3}).size() == 1);
  const std::vector<Contact> copies(50, one);
  REQUIRE(reduceByBinning(copies, {3, 3, 3, 3, 3, 3}).size() == 1);
  CHECK(same(reduceByBinning(copies, {3, 3, 3, 3, 3, 3})[0], one));
  // One place, opposite normals: different bins.
  const std::vector<Contact> opposite = {one, makeContact({1, 2, 3}, {-1, 0, 0}, 0.5, 1, 2)};
  CHECK(reduceByBinning(opposite, {3, 3, 3, 3, 3, 3}).size() == 2);
}

TEST_CASE("the bounds' far faces and normals longer than one by rounding stay in the last bin") {
  Contact longer = makeContact({1, 1, 1}, {0, 0, 1}, 0.1, 1, 1);
  longer.normal.z = 1 + 1e-15;
  const Contact corner = makeContact({0.99, 0.99, 0.99}, {0, 0, 1}, 0.1, 2, 2);
  const Contact opposite = makeContact({-1, -1, -1}, {0, 0, -1}, 0.1, 3, 3);
  const std::vector<Contact> kept = reduceByBinning(std::vector<Contact>{longer, corner, opposite}, {4, 4, 4, 4, 4, 4});
  REQUIRE(kept.size() == 2);
  CHECK(same(kept[0], longer));
  CHECK(same(kept[1], opposite));
}

TEST_CASE("the reduction step chains the chosen method and the limit") {
  Query query;
  Workspace workspace;
  workspace.contacts = randomContacts(8, 500, 1);
  query.options.maxContacts = 65535;
  query.options.reduction.method = Reduction::kNone;
  reduceContacts(query, workspace);
  CHECK(workspace.reduced.size() == 500);
  query.options.reduction.method = Reduction::kBinning;
  query.options.reduction.bins = {2, 2, 2, 1, 1, 1};
  reduceContacts(query, workspace);
  CHECK(workspace.reduced.size() == 8);
  query.options.reduction.method = Reduction::kCone;
  reduceContacts(query, workspace);
  CHECK(workspace.reduced.size() == reduceToCone(workspace.contacts).size());
  query.options.maxContacts = 3;
  for (const Reduction method : {Reduction::kNone, Reduction::kBinning, Reduction::kCone}) {
    query.options.reduction.method = method;
    reduceContacts(query, workspace);
    REQUIRE(workspace.reduced.size() == 3);
    CHECK(std::is_sorted(workspace.reduced.begin(), workspace.reduced.end(), contactDeeper));
  }
}
