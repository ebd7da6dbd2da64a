// SPDX-License-Identifier: BSD-3-Clause
// The cone reduction against projections computed in another way.
#include <Eigen/Dense>

#include "collide/contact_order.h"
#include "collide/contact_wrench.h"
#include "collide/convex_cone.h"
#include "collide/pairwise/reduction.h"
#include "support/catch.h"
#include "support/contact_samples.h"

using namespace otg;
using namespace otg::test;

namespace {

/// Wrenches written out from the definition in reduction.h.
Eigen::MatrixXd wrenches(std::span<const Contact> contacts, std::span<const Contact> all) {
  Eigen::Vector3d c = Eigen::Vector3d::Zero();
  for (const Contact& k : all) c += Eigen::Vector3d(k.position.x, k.position.y, k.position.z);
  c /= static_cast<double>(all.size());
  double r = 0;
  for (const Contact& k : all) {
    r = std::max(r, (Eigen::Vector3d(k.position.x, k.position.y, k.position.z) - c).norm());
  }
  Eigen::MatrixXd w(6, static_cast<Eigen::Index>(contacts.size()));
  for (Eigen::Index i = 0; i < w.cols(); ++i) {
    const Contact& k = contacts[static_cast<std::size_t>(i)];
    const Eigen::Vector3d n(k.normal.x, k.normal.y, k.normal.z);
    const Eigen::Vector3d p(k.position.x, k.position.y, k.position.z);
    w.col(i) << n, ((p - c) / r).cross(n);
  }
  return w;
}

/// An upper bound of the distance over the length, by projected gradient with momentum and restarts: no active sets,
/// nothing shared with the library. Every step is feasible, so the bound holds whenever the iteration ends: at `enough`
/// or at the last step.
double gradientBound(const Eigen::MatrixXd& rays, const Eigen::VectorXd& w, double enough) {
  const double lipschitz = Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(rays * rays.transpose()).eigenvalues()[5];
  Eigen::VectorXd x = Eigen::VectorXd::Zero(rays.cols()), y = x, next = x;
  double t = 1, best = 1;
  for (int i = 0; i < 400000 && best > enough; ++i) {
    next = (y - rays.transpose() * (rays * y - w) / lipschitz).cwiseMax(0.0);
    if ((y - next).dot(next - x) > 0) t = 1;  // overshooting: forget the momentum
    const double nextT = 0.5 * (1 + std::sqrt(1 + 4 * t * t));
    y = next + (t - 1) / nextT * (next - x);
    t = nextT;
    x = next;
    if (i % 16 == 0) best = std::min(best, (rays * x - w).norm() / w.norm());
  }
  return best;
}

/// The distance over the length by trying every face: the nearest point lies inside the cone of at most six rays, and
/// there it is the plain least-squares solution.
double facesDistance(const Eigen::MatrixXd& rays, const Eigen::VectorXd& w) {
  double best = w.norm();
  for (std::uint32_t subset = 1; subset < (1u << rays.cols()); ++subset) {
    std::vector<Eigen::Index> chosen;
    for (Eigen::Index k = 0; k < rays.cols(); ++k) {
      if (subset >> k & 1) chosen.push_back(k);
    }
    if (chosen.size() > 6) continue;
    Eigen::MatrixXd face(6, static_cast<Eigen::Index>(chosen.size()));
    for (std::size_t k = 0; k < chosen.size(); ++k) face.col(static_cast<Eigen::Index>(k)) = rays.col(chosen[k]);
    const Eigen::VectorXd x = face.colPivHouseholderQr().solve(w);
    if (x.minCoeff() >= 0) best = std::min(best, (face * x - w).norm());
  }
  return best / w.norm();
}

void checkSpans(const std::vector<Contact>& contacts, const std::vector<Contact>& kept, double tolerance) {
  const Eigen::MatrixXd rays = wrenches(kept, contacts);
  const Eigen::MatrixXd all = wrenches(contacts, contacts);
  double worst = 0, worstByGradient = 0;
  for (Eigen::Index i = 0; i < all.cols(); ++i) {
    worst = std::max(worst, distanceToCone(contacts[static_cast<std::size_t>(i)], kept, contacts));
    if (i % 5 == 0) worstByGradient = std::max(worstByGradient, gradientBound(rays, all.col(i), 1.02 * tolerance));
  }
  CHECK(worst <= tolerance * (1 + 1e-9));
  CHECK(worstByGradient <= 1.02 * tolerance);
}

}  // namespace

TEST_CASE("every dropped wrench lies in the cone of the kept ones to within the tolerance") {
  const double tolerance = GENERATE(1e-2, 1e-3);
  SECTION("narrow cone of normals") {
    const std::vector<Contact> contacts = randomContacts(1, 120, 0.3);
    checkSpans(contacts, reduceToCone(contacts, tolerance), tolerance);
  }
  SECTION("half space of normals") {
    const std::vector<Contact> contacts = randomContacts(2, 120, 0.99);
    checkSpans(contacts, reduceToCone(contacts, tolerance), tolerance);
  }
  SECTION("all directions: the cone is the whole space and a few contacts span it") {
    const std::vector<Contact> contacts = randomContacts(3, 150, 3);
    const std::vector<Contact> kept = reduceToCone(contacts, tolerance);
    checkSpans(contacts, kept, tolerance);
    CHECK(kept.size() <= 13);  // 2 x 6 span a space positively; the deepest is kept in any case
  }
  SECTION("contour") {
    const std::vector<Contact> contacts = ringContacts(500);
    const std::vector<Contact> kept = reduceToCone(contacts, tolerance);
    checkSpans(contacts, kept, tolerance);
    CHECK(kept.size() < contacts.size() / 2);
  }
}

TEST_CASE("distanceToCone agrees with an independent projection, above and below the tolerance") {
  const std::vector<Contact> contacts = randomContacts(4, 40, 0.7);
  const std::vector<Contact> kept(contacts.begin(), contacts.begin() + 12);
  const Eigen::MatrixXd rays = wrenches(kept, contacts);
  const Eigen::MatrixXd all = wrenches(contacts, contacts);
  int outside = 0;
  for (Eigen::Index i = 0; i < all.cols(); ++i) {
    const double d = distanceToCone(contacts[static_cast<std::size_t>(i)], kept, contacts);
    CHECK(d == Approx(facesDistance(rays, all.col(i))).margin(1e-9));
    if (d > 0.01) ++outside;
  }
  CHECK(outside > 10);
  CHECK(outside < 28);
}

TEST_CASE("a projection satisfies the conditions of optimality") {
  Draw draw(9);
  for (int round = 0; round < 200; ++round) {
    ConvexCone<6> cone;
    const std::uint32_t n = 1 + draw.below(40);
    for (std::uint32_t i = 0; i < n; ++i) {
      Wrench w;
      for (int k = 0; k < 6; ++k) w[k] = draw.uniform(-1, 1);
      // Nearly equal, equal and opposite rays are what coplanar faces give.
      if (i > 0 && draw.below(3) == 0)
        w = cone.ray(draw.below(i)) * (draw.below(2) ? 1.0 : -1.0) + 1e-7 * draw.below(2) * w;
      cone.add(w);
    }
    Wrench w;
    for (int k = 0; k < 6; ++k) w[k] = draw.uniform(-1, 1);
    const ConeProjection<6> p = cone.project(w);
    Wrench sum = p.residual;
    double largest = 1;
    for (int k = 0; k < p.count; ++k) {
      const auto index = static_cast<std::size_t>(k);
      CHECK(p.coefficients[index] >= 0);
      largest = std::max(largest, p.coefficients[index]);
      sum += p.coefficients[index] * cone.ray(p.rays[index]);
    }
    CHECK((sum - w).norm() < 1e-14 * largest);
    for (std::uint32_t i = 0; i < cone.size(); ++i) CHECK(cone.ray(i).dot(p.residual) < 1e-6);
    CHECK(std::abs(p.residual.dot(w - p.residual)) < 1e-6);
  }
}

TEST_CASE("the wrenches of a flat rectangle reduce to its corners and the deepest") {
  std::vector<Contact> contacts;
  for (int x = 0; x <= 10; ++x) {
    for (int y = 0; y <= 6; ++y) {
      const auto id = static_cast<std::uint32_t>(7 * x + y);
      contacts.push_back(makeContact({x * 0.1, y * 0.1, 0}, {0, 0, 1}, x == 4 && y == 3 ? 0.02 : 0.01, id, id));
    }
  }
  const std::vector<Contact> kept = reduceToCone(contacts);
  REQUIRE(kept.size() == 5);
  CHECK(contains(kept, contacts[0]));
  CHECK(contains(kept, contacts[6]));
  CHECK(contains(kept, contacts[70]));
  CHECK(contains(kept, contacts[76]));
  CHECK(contains(kept, contacts[4 * 7 + 3]));
}

TEST_CASE("the cone reduction does not depend on the order of the contacts or on where and how large they are") {
  const std::vector<Contact> contacts = ringContacts(300);
  const std::vector<Contact> kept = reduceToCone(contacts);
  for (std::uint32_t seed = 0; seed < 5; ++seed) CHECK(same(reduceToCone(shuffled(contacts, seed)), kept));
  // Powers of two and a shift that rounds nothing away that matters at the tolerance.
  std::vector<Contact> far = contacts;
  for (Contact& c : far) c.position = otgAdd(otgScale(c.position, 0.0625), otgVec(4096.0, -8192.0, 1024.0));
  const std::vector<Contact> keptFar = reduceToCone(far);
  for (const Contact& c : far) CHECK(distanceToCone(c, keptFar, far) <= 1e-3 * (1 + 1e-9));
  CHECK(std::abs(static_cast<int>(keptFar.size()) - static_cast<int>(kept.size())) <= 2);
}

TEST_CASE("cones of nothing, one, duplicates, one place") {
  CHECK(reduceToCone({}).empty());
  const Contact one = makeContact({1, 2, 3}, {1, 0, 0}, 0.5, 1, 2);
  CHECK(reduceToCone(std::vector<Contact>{one}).size() == 1);
  CHECK(reduceToCone(std::vector<Contact>(40, one)).size() == 1);
  // At one place only the normals count: the middle one of three in a plane is spanned by the others.
  std::vector<Contact> fan = {makeContact({1, 2, 3}, {1, 0, 1}, 0.5, 1, 1),
                              makeContact({1, 2, 3}, {0, 0, 1}, 0.1, 2, 2),
                              makeContact({1, 2, 3}, {-1, 0, 1}, 0.4, 3, 3)};
  CHECK(reduceToCone(fan).size() == 2);
  CHECK(distanceToCone(fan[1], std::vector<Contact>{fan[0], fan[2]}, fan) < 1e-12);
  CHECK(distanceToCone(fan[0], std::vector<Contact>{fan[1]}, fan) == Approx(std::sqrt(0.5)));
  CHECK(distanceToCone(fan[0], {}, fan) == Approx(1));
}

TEST_CASE("the deepest contact is always kept") {
  for (std::uint32_t seed = 10; seed < 20; ++seed) {
    const std::vector<Contact> contacts = randomContacts(seed, 200, 0.9);
    CHECK(contains(reduceToCone(contacts), *std::min_element(contacts.begin(), contacts.end(), contactDeeper)));
  }
}

TEST_CASE("no kept contact but the deepest is spanned by the other kept ones") {
  for (std::uint32_t seed = 20; seed < 40; ++seed) {
    // Wide cones, where the farthest wrench is often not an extreme one.
    const std::vector<Contact> contacts = randomContacts(seed, 60, seed % 2 ? 3 : 1.5);
    const std::vector<Contact> kept = reduceToCone(contacts);
    const Contact deepest = *std::min_element(contacts.begin(), contacts.end(), contactDeeper);
    for (const Contact& c : kept) {
      if (same(c, deepest)) continue;
      std::vector<Contact> others;
      for (const Contact& other : kept) {
        if (!same(other, c)) others.push_back(other);
      }
      CHECK(distanceToCone(c, others, contacts) > 1e-9);
    }
  }
}

TEST_CASE("distances are the same bits whatever the order of the contacts that set the scale") {
  const std::vector<Contact> contacts = randomContacts(41, 200, 0.7);
  const std::vector<Contact> kept(contacts.begin(), contacts.begin() + 8);
  for (std::uint32_t seed = 0; seed < 8; ++seed) {
    CHECK(distanceToCone(contacts[9], kept, shuffled(contacts, seed)) == distanceToCone(contacts[9], kept, contacts));
  }
}

TEST_CASE("ten thousand contacts keep the tolerance") {
  const std::vector<Contact> contacts = ringContacts(10000);
  const std::vector<Contact> kept = reduceToCone(contacts);
  CHECK(kept.size() < 500);
  for (std::size_t i = 0; i < contacts.size(); i += 101) {
    CHECK(distanceToCone(contacts[i], kept, contacts) <= 1e-3 * (1 + 1e-9));
  }
}
