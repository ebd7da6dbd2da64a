// SPDX-License-Identifier: BSD-3-Clause
// The filters never contradict exact arithmetic, whatever the triangles; the exact test agrees with constructions.
#include <algorithm>
#include <array>
#include <cmath>
#include <random>

#include "shared/contacts/contact_of_any.h"
#include "shared/tests/triangle_exact.h"
#include "shared/tests/triangle_test.h"
#include "support/catch.h"

using namespace otg;

namespace {

using Corners = std::array<Vec3d, 3>;

/// Random triangles with everything that makes predicates hard: shared corners, corners on the other's plane, edges and
/// corners, tiny offsets, needles, coplanar pairs on a coarse grid.
class HardPairs {
 public:
  explicit HardPairs(unsigned seed) : random_(seed) {}
  void next(Corners& a, Corners& b) {
    const int kind = pick(8);
    for (Vec3d& p : a) p = point(kind);
    for (Vec3d& p : b) p = point(kind);
    switch (pick(7)) {
      case 0:
        b[pick(3)] = a[pick(3)];
        break;
      case 1:  // a corner of b on the plane of a (to within rounding)
        b[pick(3)] = combine(a, uniform(), uniform());
        break;
      case 2:  // a corner of b on an edge of a
        b[pick(3)] = combine(a, uniform(), 0);
        break;
      case 3:  // nearly coplanar
        for (Vec3d& p : b) {
          p = combine(a, 3 * uniform() - 1, 3 * uniform() - 1);
          p.z += 1e-7 * (uniform() - 0.5);
        }
        break;
      case 4:  // a shared edge
        b[0] = a[1];
        b[1] = a[0];
        break;
      case 5:  // needle
        b[2] = {b[1].x + 1e-6 * uniform(), b[1].y, b[1].z};
        break;
      default:
        break;
    }
    round(a);
    round(b);
  }
  double uniform() { return std::uniform_real_distribution<double>(0, 1)(random_); }
  int pick(int n) { return std::uniform_int_distribution<int>(0, n - 1)(random_); }

 private:
  Vec3d point(int kind) {
    if (kind == 0) return {double(pick(3)), double(pick(3)), double(pick(3))};  // coarse grid: many exact zeros
    if (kind == 1) return {double(pick(4)), double(pick(4)), 0.0};              // coplanar on a grid
    if (kind == 2) return {uniform() + 1000, uniform() - 1000, uniform()};      // far from the origin
    return {uniform(), uniform(), uniform()};
  }
  static Vec3d combine(const Corners& a, double u, double v) {
    return otgAdd(a[0], otgAdd(otgScale(otgSub(a[1], a[0]), u), otgScale(otgSub(a[2], a[0]), v)));
  }
  static void round(Corners& t) {
    for (Vec3d& p : t) p = {float(p.x), float(p.y), float(p.z)};
  }
  std::mt19937 random_;
};

bool degenerate(const Corners& t) {
  int zeros = 0;
  for (int k = 0; k < 3; ++k) {
    const int i = k, j = (k + 1) % 3;
    zeros += otgOrient2(&t[0].x, &t[1].x, &t[2].x, i, j) == 0;
  }
  return zeros == 3;
}

template <class Real>
void toReal(const Corners& t, Vec3<Real> out[3]) {
  for (int k = 0; k < 3; ++k) out[k] = {Real(t[k].x), Real(t[k].y), Real(t[k].z)};
}

}  // namespace

TEST_CASE("filters never contradict the exact decision") {
  HardPairs pairs(1);
  const FilterError<float> floatError{10 * 0x1p-24f, 0.0f, 1e-30f};
  const FilterError<double> doubleError{10 * 0x1p-53, 0.0, OTG_TINY_DETERMINANT};
  int decided[2][2] = {}, undecided[2] = {}, meet = 0, total = 0;
  for (int i = 0; i < 200000; ++i) {
    Corners a, b;
    pairs.next(a, b);
    if (degenerate(a) || degenerate(b)) continue;
    ++total;
    const int exact = otgTrianglesMeetExact(&a[0].x, &b[0].x);
    REQUIRE(exact == otgTrianglesMeetExact(&b[0].x, &a[0].x));
    meet += exact;
    Vec3f fa[3], fb[3];
    toReal(a, fa);
    toReal(b, fb);
    const int f = otgTrianglesFilter(floatError, fa, fb);
    const int d = otgTrianglesFilter(doubleError, a.data(), b.data());
    for (const auto& [which, answer] : {std::pair{0, f}, std::pair{1, d}}) {
      if (answer == OTG_UNDECIDED) {
        ++undecided[which];
      } else {
        REQUIRE((answer == OTG_INTERSECTING) == (exact == 1));
        ++decided[which][exact];
      }
    }
  }
  // The cases must really reach every branch.
  CHECK(total > 100000);
  CHECK(meet > total / 10);
  CHECK(meet < total * 9 / 10);
  for (const int which : {0, 1}) {
    CHECK(decided[which][0] > 1000);
    CHECK(decided[which][1] > 1000);
    CHECK(undecided[which] > 1000);
  }
}

TEST_CASE("contacts of any pair of triangles tell who meets, and are those of pairs that do") {
  HardPairs pairs(5);
  int decided[2] = {}, undecided = 0, plain = 0, plainUndecided = 0, kinds[3] = {};
  for (int i = 0; i < 300000; ++i) {
    Corners a, b;
    pairs.next(a, b);
    const bool isPlain = i % 3 == 0;
    if (isPlain) {
      for (Vec3d& p : a) p = {pairs.uniform(), pairs.uniform(), pairs.uniform()};
      for (Vec3d& p : b) p = {pairs.uniform(), pairs.uniform(), pairs.uniform()};
    }
    const double scale = std::ldexp(1.0, i % 4 == 3 ? pairs.pick(200) - 100 : 0);
    for (Corners* t : {&a, &b}) {
      for (Vec3d& p : *t) p = otgScale(p, scale);
    }
    if (degenerate(a) || degenerate(b)) continue;
    const AnyContact<double> any = otgContactOfAny(a.data(), b.data(), 32 * 0x1p-53, 1e-280);
    plain += isPlain;
    if (any.answer == OTG_UNDECIDED) {
      ++undecided;
      plainUndecided += isPlain;
      continue;
    }
    const int exact = otgTrianglesMeetExact(&a[0].x, &b[0].x);
    REQUIRE((any.answer == OTG_INTERSECTING) == (exact == 1));
    ++decided[exact];
    if (!exact) continue;
    const PairContact<double> expected = otgPairwiseContact(a.data(), b.data());
    REQUIRE(any.contact.kind == expected.kind);
    REQUIRE(expected.kind != OTG_CONTACT_COPLANAR);
    ++kinds[expected.kind];
    if (expected.kind == OTG_CONTACT_NONE) continue;
    REQUIRE(any.contact.position == expected.position);
    REQUIRE(any.contact.normal == expected.normal);
    REQUIRE(any.contact.depth == expected.depth);
  }
  CHECK(decided[0] > 50000);
  CHECK(decided[1] > 20000);
  CHECK(undecided > 10000);
  CHECK(plain > 90000);
  CHECK(plainUndecided < plain / 1000);
  for (const int count : kinds) CHECK(count > 1000);
}

TEST_CASE("the float filter's bound covers errors of the corners") {
  HardPairs pairs(2);
  const float delta = 1e-4f;
  const FilterError<float> error{10 * 0x1p-24f, 2.1f * delta, 1e-30f};
  int decided = 0;
  for (int i = 0; i < 100000; ++i) {
    Corners a, b;
    pairs.next(a, b);
    if (degenerate(a) || degenerate(b)) continue;
    Vec3f fa[3], fb[3];
    toReal(a, fa);
    toReal(b, fb);
    for (Vec3f* t : {fa, fb}) {
      for (int k = 0; k < 3; ++k) {
        // 0.9: leave room for the rounding of the moved coordinate itself, which is part of the error.
        t[k] = {t[k].x + 0.9f * delta * float(2 * pairs.uniform() - 1),
                t[k].y + 0.9f * delta * float(2 * pairs.uniform() - 1),
                t[k].z + 0.9f * delta * float(2 * pairs.uniform() - 1)};
      }
    }
    const int answer = otgTrianglesFilter(error, fa, fb);
    if (answer == OTG_UNDECIDED) continue;
    ++decided;
    REQUIRE((answer == OTG_INTERSECTING) == (otgTrianglesMeetExact(&a[0].x, &b[0].x) == 1));
  }
  CHECK(decided > 10000);
}

TEST_CASE("exact orientation agrees with integers") {
  std::mt19937_64 random(3);
  const auto coordinate = [&] { return double(std::int64_t(random() % 200001) - 100000); };
  for (int i = 0; i < 50000; ++i) {
    double p[4][3];
    for (auto& q : p) {
      for (double& x : q) x = coordinate();
    }
    if (i % 2 == 0) {  // exactly coplanar: an integer combination
      const std::int64_t u = std::int64_t(random() % 5) - 2, v = std::int64_t(random() % 5) - 2;
      for (int k = 0; k < 3; ++k) {
        p[3][k] = p[0][k] + double(u) * (p[1][k] - p[0][k]) + double(v) * (p[2][k] - p[0][k]);
      }
      if (i % 4 == 0) p[3][2] += 1;
    }
    std::int64_t r[3][3];
    for (int j = 0; j < 3; ++j) {
      for (int k = 0; k < 3; ++k) r[j][k] = std::int64_t(p[j + 1][k]) - std::int64_t(p[0][k]);
    }
    const std::int64_t det = r[0][0] * (r[1][1] * r[2][2] - r[1][2] * r[2][1]) -
                             r[0][1] * (r[1][0] * r[2][2] - r[1][2] * r[2][0]) +
                             r[0][2] * (r[1][0] * r[2][1] - r[1][1] * r[2][0]);
    const int sign = (det > 0) - (det < 0);
    REQUIRE(otgOrient3(p[0], p[1], p[2], p[3]) == sign);
    REQUIRE(otgExactOrient3(p[3], p[1], p[2], p[0]) == sign);
    // Scaling by powers of two changes nothing; coordinates of very different size stress the expansions.
    for (auto& q : p) {
      for (double& x : q) x = std::ldexp(x, -40) + 1.0;
    }
    REQUIRE(otgExactOrient3(p[3], p[1], p[2], p[0]) == otgOrient3(p[0], p[1], p[2], p[3]));
  }
}

TEST_CASE("sums of products have the signs of expansions of fixed lengths") {
  std::mt19937_64 random(5);
  const auto below = [&](int n) { return static_cast<int>(random() % static_cast<std::uint64_t>(n)); };
  for (int i = 0; i < 60000; ++i) {
    // Coordinates of one size, of few bits, or of sizes as different as may be; many determinants vanish or nearly do.
    const int kind = i % 4, spread = i % 5 == 0 ? 200 : 40;
    double p[4][3];
    for (auto& q : p) {
      for (double& x : q) {
        const double mantissa =
            kind == 0 ? below(5) - 2 : double(std::int64_t(random() >> 11) - (std::int64_t(1) << 52));
        x = std::ldexp(mantissa, kind == 0 ? 0 : kind == 3 ? below(2 * spread) - spread - 52 : -52);
      }
    }
    if (kind == 1) {  // coplanar but for rounding
      const double u = double(below(7) - 3) / 2, v = double(below(5) - 2) / 3;
      for (int k = 0; k < 3; ++k) p[3][k] = p[0][k] + u * (p[1][k] - p[0][k]) + v * (p[2][k] - p[0][k]);
    } else if (kind == 3 && i % 8 == 3) {  // exactly so
      for (int k = 0; k < 3; ++k) p[3][k] = i % 16 == 3 ? p[1][k] : 2 * p[0][k];
      if (i % 16 != 3) p[2][0] = p[2][1] = p[2][2] = 0;
    }
    bool fits = true;
    for (const auto& q : p) {
      for (const double x : q) fits = fits && otgIsExactCoordinate(x);
    }
    REQUIRE(fits);
    REQUIRE(otgSumOrient3(p[0], p[1], p[2], p[3]) == otgExactOrient3(p[0], p[1], p[2], p[3]));
    REQUIRE(otgSumMinor(p[0][0], p[1][0], p[2][1], p[3][1], p[0][1], p[1][1], p[2][0], p[3][0]) ==
            otgExactMinor(p[0][0], p[1][0], p[2][1], p[3][1], p[0][1], p[1][1], p[2][0], p[3][0]));
  }
  CHECK_FALSE(otgIsExactCoordinate(1e-91));
  CHECK_FALSE(otgIsExactCoordinate(-1e91));
}

TEST_CASE("sums of products have the signs of expansions, and are exact where those underflow") {
  std::mt19937_64 random(6);
  const auto below = [&](int n) { return static_cast<int>(random() % static_cast<std::uint64_t>(n)); };
  int zeros = 0, lost = 0;
  for (int i = 0; i < 40000; ++i) {
    // Whole numbers times powers of two: their determinants are known, however small or large the powers are.
    double p[4][3], moved[4][3];
    for (auto& q : p) {
      for (double& x : q) x = i % 3 == 0 ? below(5) - 2 : below(1 << 15) - (1 << 14);
    }
    if (i % 4 == 0) {
      for (int k = 0; k < 3; ++k) p[3][k] = 2 * p[1][k] + 3 * p[2][k] - 4 * p[0][k];  // coplanar
    }
    const int exponent[3] = {below(1900) - 1000, below(1900) - 1000, below(1900) - 1000};
    for (int j = 0; j < 4; ++j) {
      for (int k = 0; k < 3; ++k) moved[j][k] = std::ldexp(p[j][k], exponent[k]);
    }
    const int sign = otgExactOrient3(p[0], p[1], p[2], p[3]);
    zeros += sign == 0;
    REQUIRE(otgOrient3OfAnySize(p[0], p[1], p[2], p[3]) == sign);
    REQUIRE(otgOrient3OfAnySize(moved[0], moved[1], moved[2], moved[3]) == sign);
    REQUIRE(otgHostOrient3(moved[0], moved[1], moved[2], moved[3]) == sign);
    if (*std::max_element(exponent, exponent + 3) <= 112) {  // as large as floats, for which the filter is made
      REQUIRE(otgOrient3(moved[3], moved[1], moved[2], moved[0]) == sign);
    }
    const int minor = otgExactMinor(p[0][0], p[1][0], p[2][1], p[3][1], p[0][1], p[1][1], p[2][0], p[3][0]);
    REQUIRE(otgMinorOfAnySize(p[0][0], p[1][0], p[2][1], p[3][1], p[0][1], p[1][1], p[2][0], p[3][0]) == minor);
    REQUIRE(otgMinorOfAnySize(moved[0][0], moved[1][0], moved[2][1], moved[3][1], moved[0][1], moved[1][1], moved[2][0],
                              moved[3][0]) == minor);
    lost += std::isfinite(moved[0][0]) && otgExactOrient3(moved[0], moved[1], moved[2], moved[3]) != sign;
  }
  CHECK(zeros > 8000);
  CHECK(lost > 1000);  // what expansions alone make of it
  // What is as small as can be decides.
  const double least = 0x1p-1074;
  const double a[3] = {1, 0, 0}, b[3] = {0, 1, 0}, c[3] = {0, 0, 0}, d[3] = {5, 7, least}, e[3] = {5, 7, -least};
  const double far[3] = {0x1p100, 0, 0}, wide[3] = {0, 0x1p100, 0};
  CHECK(otgOrient3(c, a, b, d) == 1);
  CHECK(otgOrient3(c, a, b, e) == -1);
  CHECK(otgOrient3(c, far, wide, e) == -1);
}
