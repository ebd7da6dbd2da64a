// SPDX-License-Identifier: BSD-3-Clause
// Contacts that no motion satisfies together, against a solver of quadratic programs of another kind.
#include "collide/consistent_contacts.h"

#include <Eigen/Dense>

#include "support/catch.h"
#include "support/contact_samples.h"

using namespace otg;
using namespace otg::test;

namespace {

constexpr double kLongest = 10;  ///< in depths of the deepest contact
constexpr double kTurn = 3;      ///< times what it moves a contact is what a rotation counts

/// Rows (n, (p - c) x n / r / kTurn), with c the mean of all positions and r the largest distance from it.
Eigen::MatrixXd rowsOf(std::span<const Contact> contacts, std::span<const Contact> all) {
  const auto vector = [](const Vec3d& v) { return Eigen::Vector3d(v.x, v.y, v.z); };
  Eigen::Vector3d c = Eigen::Vector3d::Zero();
  for (const Contact& k : all) c += vector(k.position) / static_cast<double>(all.size());
  double r = 0;
  for (const Contact& k : all) r = std::max(r, (vector(k.position) - c).norm());
  Eigen::MatrixXd rows(static_cast<Eigen::Index>(contacts.size()), 6);
  for (Eigen::Index i = 0; i < rows.rows(); ++i) {
    const Contact& k = contacts[static_cast<std::size_t>(i)];
    const Eigen::Vector3d turn = r > 0 ? ((vector(k.position) - c) / r / kTurn).eval() : Eigen::Vector3d::Zero().eval();
    rows.row(i) << vector(k.normal).transpose(), turn.cross(vector(k.normal)).transpose();
  }
  return rows;
}

/// The length of the shortest motion, in units of the deepest of `all`, by Hildreth's method: one constraint after the
/// other, on and on. Without end where there is none, so a length beyond `enough` ends it.
double shortestMotion(std::span<const Contact> contacts, std::span<const Contact> all, double enough) {
  const Eigen::MatrixXd rows = rowsOf(contacts, all);
  double deepest = 0;
  for (const Contact& c : all) deepest = std::max(deepest, c.depth);
  Eigen::VectorXd force = Eigen::VectorXd::Zero(rows.rows());
  Eigen::VectorXd motion = Eigen::VectorXd::Zero(6);
  for (int round = 0; round < 200000; ++round) {
    double change = 0;
    for (Eigen::Index i = 0; i < rows.rows(); ++i) {
      const double missing = contacts[static_cast<std::size_t>(i)].depth / deepest - rows.row(i).dot(motion);
      const double more = std::max(-force[i], missing / rows.row(i).squaredNorm());
      force[i] += more;
      motion += more * rows.row(i).transpose();
      change = std::max(change, std::fabs(more));
    }
    // The dual's value is a bound of half the square from below.
    double bound = -0.5 * motion.squaredNorm();
    for (Eigen::Index i = 0; i < rows.rows(); ++i) {
      bound += force[i] * contacts[static_cast<std::size_t>(i)].depth / deepest;
    }
    if (2 * bound > enough * enough) return std::sqrt(2 * bound);
    if (change < 1e-13) break;
  }
  return motion.norm();
}

std::vector<Contact> consistent(std::vector<Contact> contacts) {
  makeConsistent(contacts, 0);
  return contacts;
}

std::vector<double> depths(std::span<const Contact> contacts) {
  std::vector<double> out;
  for (const Contact& c : contacts) out.push_back(c.depth);
  return out;
}

/// Contacts on some walls: few directions, some of them opposite, some without depth.
std::vector<Contact> wallContacts(Draw& draw) {
  std::vector<Vec3d> walls;
  for (std::uint32_t i = 0; i < 2 + draw.below(3); ++i) {
    const bool isOpposite = i > 0 && draw.below(2) == 0;
    walls.push_back(isOpposite ? otgAdd(otgScale(walls[0], -1.0), otgScale(draw.direction(), draw.below(2) * 0.1))
                               : draw.direction());
  }
  std::vector<Contact> contacts;
  const std::uint32_t count = 2 + draw.below(12);
  for (std::uint32_t i = 0; i < count; ++i) {
    const double depth = draw.below(4) == 0 ? 0 : draw.uniform(0, 0.01);
    contacts.push_back(
        makeContact(draw.inBox(1), walls[draw.below(static_cast<std::uint32_t>(walls.size()))], depth, i));
  }
  return contacts;
}

}  // namespace

TEST_CASE("a body that is jammed between two walls is asked to leave neither") {
  const std::vector<Contact> jammed{makeContact({0, 0, 0}, {1, 0, 0}, 0.01), makeContact({1, 0, 0}, {-1, 0, 0}, 0.004)};
  CHECK(contradict(jammed, 0));
  CHECK(depths(consistent(jammed)) == std::vector<double>{0, 0});
  CHECK((consistent(jammed)[0].flags & kContactClamped) != 0);
  std::vector<Contact> onFloor = jammed;
  onFloor.push_back(makeContact({0.5, 0, -1}, {0, 0, 1}, 0.003));
  CHECK(depths(consistent(onFloor)) == std::vector<double>{0, 0, 0.003});
}

TEST_CASE("what a short motion satisfies stays as it is") {
  // Corners of two and three walls, a peg that is tilted in its hole, and grooves of 60 and 15 degrees.
  const std::vector<std::vector<Contact>> all{
      {makeContact({0, 0, 0}, {1, 0, 0}, 0.01), makeContact({1, 0, 0}, {0, 1, 0}, 0.004)},
      {makeContact({0, 0, 0}, {1, 0, 0}, 0.01), makeContact({1, 0, 0}, {0, 1, 0}, 0.01),
       makeContact({1, 1, 0}, {0, 0, 1}, 0.01)},
      {makeContact({0, 0, 0}, {1, 0, 0}, 0.01), makeContact({0.2, 0, 1}, {-1, 0, 0}, 0.01)},
      {makeContact({0, 0, 0}, {0.866, 0, 0.5}, 0.01), makeContact({1, 0, 0}, {-0.866, 0, 0.5}, 0.01)},
      {makeContact({0, 0, 0}, {0.9914, 0, 0.1305}, 0.01), makeContact({1, 0, 0}, {-0.9914, 0, 0.1305}, 0.01)}};
  for (const std::vector<Contact>& contacts : all) {
    CHECK_FALSE(contradict(contacts, 0));
    CHECK(depths(consistent(contacts)) == depths(contacts));
  }
  CHECK(consistent({}).empty());
}

TEST_CASE("contacts from two sides near each other agree by a turn of a small body, not of a large one") {
  // A tooth between two flanks: to make room for one, a turn about it moves the other end of the body.
  std::vector<Contact> tooth{makeContact({0, 0, 0}, {0, 0, 1}, 0.001), makeContact({0.01, 0, 0}, {0, 0, -1}, 0)};
  CHECK_FALSE(contradict(tooth, 0.01));
  CHECK(contradict(tooth, 1));
  makeConsistent(tooth, 1);
  REQUIRE(tooth.size() == 1);
  CHECK(tooth[0].depth == 0.001);
  // One place has no lever.
  const std::vector<Contact> point{makeContact({1, 1, 1}, {0, 0, 1}, 0.001), makeContact({1, 1, 1}, {0, 1, 0}, 0.001)};
  CHECK_FALSE(contradict(point, 1));
}

TEST_CASE("a contact without depth that contradicts deeper ones is left out") {
  std::vector<Contact> contacts{makeContact({0, 0, 0}, {0, 0, 1}, 0.01), makeContact({0, 0, 1}, {0, 0, -1}, 0),
                                makeContact({1, 0, 0}, {1, 0, 0}, 0)};
  makeConsistent(contacts, 0);
  REQUIRE(contacts.size() == 2);
  CHECK(contacts[0].depth == 0.01);
  CHECK(contacts[1].normal.x == 1);
}

TEST_CASE("of random contacts a motion satisfies what is left, and no more could be left") {
  Draw draw(5);
  int contradicting = 0;
  for (int round = 0; round < 400; ++round) {
    const std::vector<Contact> before = wallContacts(draw);
    double deepest = 0;
    for (const Contact& c : before) deepest = std::max(deepest, c.depth);
    if (!(deepest > 0)) continue;
    const std::vector<Contact> after = consistent(before);
    const double length = shortestMotion(before, before, 2 * kLongest);
    if (std::fabs(length - kLongest) < 1e-3) continue;  // on the limit
    INFO("round " << round << ", length " << length);
    CHECK(contradict(before, 0) == (length > kLongest));
    if (length <= kLongest) {
      CHECK(depths(after) == depths(before));
      continue;
    }
    ++contradicting;
    CHECK(shortestMotion(after, before, 2 * kLongest) < kLongest * 1.001);
    // The deepest that lost its depth contradicts those that are deeper and kept theirs.
    const auto leftOf = [&](const Contact& c) {
      return std::find_if(after.begin(), after.end(), [&](const Contact& a) { return a.triangleA == c.triangleA; });
    };
    const Contact* lost = nullptr;
    for (const Contact& c : before) {
      if (c.depth > 0 && leftOf(c)->depth < c.depth && (lost == nullptr || c.depth > lost->depth)) lost = &c;
    }
    if (lost == nullptr) continue;  // all that were left out had none
    std::vector<Contact> deeper;
    for (const Contact& c : before) {
      if (!(c.depth > 0)) continue;
      deeper.push_back(c);
      if (c.depth < lost->depth) deeper.back().depth = 0;
    }
    CHECK(shortestMotion(deeper, before, 2 * kLongest) > kLongest * 0.999);
  }
  CHECK(contradicting > 60);
}

TEST_CASE("what is left depends neither on the order, nor on the place, nor on the unit of length") {
  Draw draw(6);
  for (int round = 0; round < 200; ++round) {
    const std::vector<Contact> contacts = wallContacts(draw);
    const auto byTriangle = [](std::vector<Contact> c) {
      std::sort(c.begin(), c.end(), [](const Contact& x, const Contact& y) { return x.triangleA < y.triangleA; });
      return c;
    };
    const std::vector<Contact> one = byTriangle(consistent(contacts));
    const std::vector<Contact> other = byTriangle(consistent(shuffled(contacts, static_cast<std::uint32_t>(round))));
    CHECK(depths(one) == depths(other));
    std::vector<Contact> placed = contacts;
    for (Contact& c : placed) {  // elsewhere, a thousand times as large
      c.position = otgAdd(otgScale(c.position, 1000.0), Vec3d{5000, 0, -700});
      c.depth *= 1000;
    }
    placed = byTriangle(consistent(placed));
    REQUIRE(placed.size() == one.size());
    for (std::size_t i = 0; i < one.size(); ++i) CHECK(placed[i].depth == 1000 * one[i].depth);
  }
}
