// SPDX-License-Identifier: BSD-3-Clause
// The families of certificates as worlds: nobody is thrown. `otg bench contacts --certificate --falls` has larger ones,
// beside stock dTriMesh.
#include <string>
#include <vector>

#include "scenes/simulation.h"
#include "support/catch.h"
#include "truth/family_fall.h"

using namespace otg::truth;

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
    for (int number = 0; number < 40; ++number) checkFall(family, 911, number);
  }
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
      {"dConvex", 901, {34}}};
  for (const CertificateFamily& family : certificateFamilies()) {
    for (const Thrown& known : thrown) {
      if (family.name != known.family) continue;
      for (const int number : known.numbers) checkFall(family, known.seed, number);
    }
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
