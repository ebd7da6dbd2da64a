// SPDX-License-Identifier: BSD-3-Clause
// The families of certificates as worlds: nobody is thrown. `otg bench contacts --certificate --falls` has larger ones,
// beside stock dTriMesh.
#include <random>
#include <string>
#include <vector>

#include "scenes/simulation.h"
#include "support/catch.h"
#include "support/part_of.h"
#include "truth/family_fall.h"

using namespace otg::truth;
using otg::test::partOf;

namespace {

void checkFall(const CertificateFamily& family, std::uint32_t seed, int number) {
  const auto member = certificateMember(family, seed, number);
  if (!member) return;
  const Fall result = fall(*member, fallConditions(number));
  INFO(family.name << ' ' << number << " of seed " << seed << ": " << member->what << "; step " << result.step);
  CHECK(result.gain <= kThrown);
}

}  // namespace

TEST_CASE("bodies that gravity pushes into corners, grooves, threads and bowls are not thrown") {
  const otg::scenes::OdeSession session;
  for (const CertificateFamily& family : certificateFamilies()) {
    for (int number = 0; number < partOf(40); ++number) checkFall(family, 911, number);
  }
}

TEST_CASE("nor are they where they settle, are dropped or slide for 5 s, at any time step") {
  const otg::scenes::OdeSession session;
  const FallStart starts[] = {FallStart::kSettled, FallStart::kDropped, FallStart::kSlid};
  const double steps[] = {1.0 / 60, 1.0 / 240, 1.0 / 1000};
  int met = 0;
  for (const CertificateFamily& family : certificateFamilies()) {
    for (int number = 0; number < 9; ++number) {
      const auto member = certificateMember(family, 941, number);
      if (!member) continue;
      FallConditions conditions = fallConditions(number);
      conditions.start = starts[number % 3];
      conditions.timeStep = steps[number / 3];
      conditions.quick = number % 2 == 0;
      conditions.duration = 5;
      const Fall result = fall(*member, conditions);
      INFO(family.name << ' ' << number << ": " << member->what << "; step " << result.step);
      CHECK(result.gain <= thrownFrom(conditions.timeStep));
      ++met;
    }
  }
  CHECK(met > 300);
}

TEST_CASE("nor are those that were thrown before a body between two walls stayed there") {
  const otg::scenes::OdeSession session;
  struct Thrown {
    const char* family;
    std::uint32_t seed;
    std::vector<int> numbers;
  };
  const std::vector<Thrown> thrown{
      {"slot", 901, {29, 203, 215, 266}},
      {"bin", 901, {7, 50, 154}},
      {"bin", 921, {272, 281}},
      {"wedge", 901, {176}},
      {"screw", 901, {3, 25, 55, 82, 101, 111, 147, 165, 201, 210, 219, 228, 229, 247, 273, 281}},
      {"spikes", 901, {158}},
      {"dBox", 901, {24, 81, 125, 180, 236}},
      {"dCylinder", 901, {28}},
      {"dConvex", 901, {34}},
      {"shapes", 1, {52}}};
  for (const CertificateFamily& family : certificateFamilies()) {
    for (const Thrown& known : thrown) {
      if (family.name != known.family) continue;
      for (const int number : known.numbers) checkFall(family, known.seed, number);
    }
  }
}

TEST_CASE("of bodies in hosts that lost the faces around their inner walls one in a hundred is thrown") {
  // They jam between thin walls from both sides. Stock dTriMesh throws one in five.
  const otg::scenes::OdeSession session;
  int met = 0, thrown = 0;
  for (const CertificateFamily& family : certificateFamilies()) {
    // Walls inside flush blocks are two sheets in one place: thin walls are not the question there.
    if (family.name == "flush" || family.name == "on_flush") continue;
    for (int number = 0; number < 40; ++number) {
      auto member = certificateMember(family, 901, number);
      if (member) member = withOpenHost(*member);
      if (!member) continue;
      ++met;
      if (fall(*member, fallConditions(number)).gain > kThrown) ++thrown;
    }
  }
  CHECK(met > 600);
  CHECK(100 * thrown <= met);
}

TEST_CASE("bodies that are wider than the gap they are in are not thrown out of it") {
  // Walls on two sides request what no motion satisfies, and an exact solver has no bound for the forces of that: one
  // in five gained over 100 when all kept their depths. One that comes to an end of the gap may be squeezed out there.
  constexpr double kSqueezed = 0.5;
  const otg::scenes::OdeSession session;
  std::mt19937 random(3);
  const auto within = [&random](double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random);
  };
  using otg::scenes::makeBox;
  for (int number = 0; number < 60; ++number) {
    otg::scenes::MeshArrays left = makeBox({1, 2, 2}), right = left;
    for (otg::Vec3f& v : left.vertices) v.x -= 1;
    for (otg::Vec3f& v : right.vertices) v.x += 1;
    CertificateMember member;
    member.a.mesh = otg::scenes::merge({left, right});
    member.a.pose = {{1, 0, 0, 0, 1, 0, 0, 0, 1}, {0, 0, 0}};
    member.b.mesh = makeBox({static_cast<float>(within(1.002, 1.03)), 0.7F, 0.5F}, 1 + number % 3);
    dMatrix3 r;
    dRFromEulerAngles(r, 0, within(-0.01, 0.01), within(-0.01, 0.01));
    member.b.pose = {{r[0], r[1], r[2], r[4], r[5], r[6], r[8], r[9], r[10]},
                     {within(-0.002, 0.002), within(-1, 1), within(-1, 1.2)}};
    member.size = 0.5;
    member.shortest = {0, 0, -1};
    FallConditions conditions = fallConditions(number);
    conditions.timeStep = 1.0 / 60;
    const Fall result = fall(member, conditions);
    INFO(number << ", step " << result.step);
    CHECK(result.gain <= kSqueezed);
  }
}

TEST_CASE("a world in which a body is thrown is distinguished from one in which it is not") {
  // Stock dTriMesh throws about one in three of these.
  const otg::scenes::OdeSession session;
  int thrown = 0, calm = 0;
  for (const CertificateFamily& family : certificateFamilies()) {
    if (family.name != "slot" && family.name != "bowl") continue;
    for (int number = 0; number < 12; ++number) {
      const auto member = certificateMember(family, 911, number);
      if (!member) continue;
      FallConditions conditions = fallConditions(number);
      conditions.asTriMesh = true;
      ++(fall(*member, conditions).gain > kThrown ? thrown : calm);
    }
  }
  CHECK(thrown >= 3);
  CHECK(calm >= 12);
}

TEST_CASE("bodies whose one face touches at its corners, each in a place of its own, are not thrown") {
  const otg::scenes::OdeSession session;
  struct Thrown {
    const char* family;
    std::uint32_t seed;
    int number;
    FallStart start;
    double timeStep;
  };
  const Thrown thrown[] = {{"spikes", 5001, 3, FallStart::kSlid, 1.0 / 1000},
                           {"spikes", 5001, 0, FallStart::kSettled, 1.0 / 60},
                           {"bin", 6001, 29, FallStart::kSettled, 1.0 / 60}};
  for (const CertificateFamily& family : certificateFamilies()) {
    for (const Thrown& known : thrown) {
      if (family.name != known.family) continue;
      const auto member = certificateMember(family, known.seed, known.number);
      REQUIRE(member);
      FallConditions conditions = fallConditions(known.number);
      conditions.start = known.start;
      conditions.timeStep = known.timeStep;
      conditions.duration = 5;
      INFO(known.family << ' ' << known.number);
      CHECK(fall(*member, conditions).gain <= thrownFrom(known.timeStep));
    }
  }
}
