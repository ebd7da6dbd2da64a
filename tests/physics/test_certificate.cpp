// SPDX-License-Identifier: BSD-3-Clause
// Contacts judged by what they ask for, in families of random pairs in shallow overlap; and the judge itself.
// `otg bench contacts --certificate` has larger families, and each member with its contacts.
#include "truth/certificate.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <set>
#include <span>
#include <string>

#include "scenes/simulation.h"
#include "support/catch.h"
#include "truth/certificate_families.h"
#include "truth/certificate_verdict.h"
#include "truth/pair_in_ode.h"
#include "truth/separation.h"
#include "truth/separation_search.h"
#include "truth/shortest_translation.h"

using namespace otg;
using namespace otg::truth;

namespace {

constexpr Transformd kUnmoved{{1, 0, 0, 0, 1, 0, 0, 0, 1}, {0, 0, 0}};

double norm(const Vec3d& v) {
  return std::sqrt(otgDot(v, v));
}

bool inAll(const Vec3d& t, const std::vector<HalfSpace>& halfSpaces) {
  return std::all_of(halfSpaces.begin(), halfSpaces.end(),
                     [&](const HalfSpace& h) { return otgDot(h.normal, t) >= h.depth - 1e-9; });
}

/// By trying all sets of one to three boundaries: t is a sum of their normals.
std::optional<Vec3d> byEnumeration(const std::vector<HalfSpace>& all) {
  std::optional<Vec3d> best;
  const auto offer = [&](const Vec3d& t) {
    if (inAll(t, all) && (!best || norm(t) < norm(*best))) best = t;
  };
  offer({0, 0, 0});
  for (std::size_t i = 0; i < all.size(); ++i) {
    offer(otgScale(all[i].normal, all[i].depth));
    for (std::size_t k = i + 1; k < all.size(); ++k) {
      const double c = otgDot(all[i].normal, all[k].normal), d = 1 - c * c;
      if (d < 1e-12) continue;
      const double p = (all[i].depth - c * all[k].depth) / d, q = (all[k].depth - c * all[i].depth) / d;
      offer(otgAdd(otgScale(all[i].normal, p), otgScale(all[k].normal, q)));
      for (std::size_t m = k + 1; m < all.size(); ++m) {
        const Vec3d a = otgCross(all[k].normal, all[m].normal), b = otgCross(all[m].normal, all[i].normal),
                    e = otgCross(all[i].normal, all[k].normal);
        const double volume = otgDot(all[i].normal, a);
        if (std::fabs(volume) < 1e-9) continue;
        const Vec3d sum =
            otgAdd(otgAdd(otgScale(a, all[i].depth), otgScale(b, all[k].depth)), otgScale(e, all[m].depth));
        offer(otgScale(sum, 1 / volume));
      }
    }
  }
  return best;
}

PairBody boxAt(const Vec3d& half, const Transformd& pose) {
  PairBody body;
  body.mesh = scenes::makeBox(otgScale(half, 2.0));
  body.pose = pose;
  return body;
}

/// A unit cube 0.01 in the top of a slab.
struct CubeOnSlab {
  PairBody cube = boxAt({0.5, 0.5, 0.5}, {{1, 0, 0, 0, 1, 0, 0, 0, 1}, {0.1, 0.2, 0.49}});
  PairBody slab = boxAt({2, 2, 0.5}, {{1, 0, 0, 0, 1, 0, 0, 0, 1}, {0, 0, -0.5}});
  std::unique_ptr<PairOracle> oracle = makeOracle(cube, slab, 1e-5);
  Certificate of(const std::vector<JudgedContact>& contacts) { return certify(*oracle, 0.01, contacts); }
};

constexpr int kMembers = 30;

}  // namespace

TEST_CASE("the shortest translation of contacts is that of the best set of boundaries") {
  Random random(31);
  int feasible = 0;
  for (int i = 0; i < 400; ++i) {
    std::vector<HalfSpace> all;
    const int count = 1 + random.below(8);
    for (int k = 0; k < count; ++k) {
      const Vec3d n = random.direction();
      all.push_back({n, random.uniform(0, 1)});
    }
    const std::optional<Vec3d> expected = byEnumeration(all), found = shortestTranslation(all);
    CAPTURE(i, count);
    REQUIRE(found.has_value() == expected.has_value());
    if (!found) continue;
    ++feasible;
    CHECK(inAll(*found, all));
    CHECK(norm(*found) == Approx(norm(*expected)).epsilon(1e-9));
  }
  CHECK(feasible > 100);
  CHECK(feasible < 400);
  // Walls that face each other leave no way; walls that are parallel to 1e-5 have a long one.
  CHECK_FALSE(shortestTranslation(std::vector<HalfSpace>{{{1, 0, 0}, 0.1}, {{-1, 0, 0}, 0.1}}));
  const double c = std::cos(1e-5), s = std::sin(1e-5);
  const auto far = shortestTranslation(std::vector<HalfSpace>{{{1, 0, 0}, 0.1}, {{-c, s, 0}, 0.1}});
  REQUIRE(far);
  CHECK(far->y == Approx(0.1 * (1 + c) / s));
}

TEST_CASE("the search finds the shortest separation of boxes that formulas know") {
  Random random(32);
  for (int i = 0; i < 60; ++i) {
    const Vec3d a{random.uniform(0.5, 1), random.uniform(0.5, 1), random.uniform(0.5, 1)};
    const Vec3d b{random.uniform(0.2, 0.5), random.uniform(0.2, 0.5), random.uniform(0.2, 0.5)};
    const double wanted = 0.2 * std::pow(10.0, random.uniform(-5, -2));
    Transformd pose = random.rotation();
    const Vec3d away = random.direction();
    double inside = 0, outside = 4;
    while (outside - inside > 1e-3 * wanted) {
      const double middle = 0.5 * (inside + outside);
      pose.t = otgScale(away, middle);
      (boxBox(a, b, pose).depth > wanted ? inside : outside) = middle;
    }
    pose.t = otgScale(away, inside);
    const double depth = boxBox(a, b, pose).depth;
    const PairBody bodyA = boxAt(a, kUnmoved), bodyB = boxAt(b, pose);
    PairBody shape = bodyB;
    shape.shape = ConvexBody{};
    shape.shape->kind = ConvexBody::Kind::kBox;
    shape.shape->half = b;
    shape.shape->pose = kUnmoved;
    for (const PairBody& other : {bodyB, shape}) {
      const auto oracle = makeOracle(bodyA, other, 1e-3 * depth);
      const std::optional<Vec3d> found = shortestSeparation(*oracle, 0.3 * depth, 10 * depth, {});
      CAPTURE(i, depth, other.shape.has_value());
      REQUIRE(found);
      CHECK(norm(*found) > 0.985 * depth);  // the grain, at a corner
      CHECK(norm(*found) < 1.02 * depth);
    }
  }
}

TEST_CASE("sets of contacts that are right have a certificate, and those that are not have none") {
  CubeOnSlab scene;
  const auto contact = [](double x, double y, const Vec3d& normal, double depth) {
    return JudgedContact{{x, y, -0.005}, normal, depth};
  };
  const Vec3d up{0, 0, 1}, leaning{std::sin(0.1), 0, std::cos(0.1)};
  const Certificate right = scene.of({contact(-0.4, -0.3, up, 0.01), contact(0.6, 0.7, up, 0.01)});
  CHECK(right.left == 0);
  CHECK(right.length == Approx(0.01));
  // One that is deep enough is enough; more that ask for less change nothing.
  CHECK(scene.of({contact(-0.4, -0.3, up, 0.01), contact(0.6, 0.7, up, 0.002)}).left == 0);
  CHECK(scene.of({}).none);
  const Certificate shallow = scene.of({contact(0, 0, up, 0.009)});
  CHECK(shallow.left == Approx(0.1).epsilon(1e-6));
  CHECK(shallow.leftWay == Approx(0.1).epsilon(0.02));
  CHECK(scene.of({contact(0, 0, leaning, 0.009)}).left > 0.02);
  CHECK(scene.of({contact(0, 0, {1, 0, 0}, 0.01)}).left == Approx(1));
  CHECK(scene.of({contact(0, 0, up, 0.01), contact(0, 0, otgScale(up, -1.0), 0.01)}).infeasible);
  const Certificate far = scene.of({contact(0, 0, up, 0.5)});
  CHECK(far.left == 0);
  CHECK(far.length == Approx(0.5));
}

TEST_CASE("a contact that leaves through a whole body is too deep, one at an edge of the overlap is not") {
  // A body against a wall and on a floor, as deep in either; the wall's contact with the floor's normal.
  PairBody corner;
  corner.mesh = scenes::makeBox({2, 2, 1});
  corner.pose = kUnmoved;
  PairBody cube = boxAt({0.5, 0.5, 0.5}, {{1, 0, 0, 0, 1, 0, 0, 0, 1}, {0.6, 0, 0.99}});
  const auto deep = [&](const Vec3d& at, double depth, bool exempt) {
    return tooDeep(cube, corner, {{at, {0, 0, 1}, depth, exempt}}, 1e-6).size();
  };
  CHECK(deep({0.5, 0, 0.495}, 0.01, false) == 0);
  // Over the edge of the block: its side is nearer than the depth, and is not what the cube leaves.
  CHECK(deep({0.9999, 0, 0.495}, 0.01, false) == 0);
  CHECK(deep({0.5, 0, 0.515}, 0.04, false) == 1);
  CHECK(deep({0.5, 0, 0.99}, 1, false) == 1);
  CHECK(deep({0.5, 0, 0.99}, 1, true) == 0);
}

TEST_CASE("contacts in another order are the same, and a moved one is not") {
  const JudgedContact one{{0, 0, 0}, {0, 0, 1}, 0.01}, two{{1, 0, 0}, {0, 0, 1}, 0.02};
  JudgedContact moved = two;
  moved.depth += 1e-6;
  CHECK(unmatched({one, two}, {two, one}, 1e-9, 1e-9) == 0);
  CHECK(unmatched({one, two}, {one, moved}, 1e-9, 1e-9) == 2);
  CHECK(unmatched({one, two}, {one, moved}, 1e-5, 1e-9) == 0);
  CHECK(unmatched({one, two}, {one}, 1e-9, 1e-9) == 1);
  CHECK(unmatched({one, one}, {one, two}, 1e-9, 1e-9) == 2);
}

namespace {

/// All but how deep single contacts are.
void checkTranslations(const FamilyVerdict& found) {
  CHECK(found.members == kMembers);
  CHECK(found.uncertified() == 0);
  CHECK(found.tooLong == 0);
  CHECK(found.longer <= kMembers / 20);
  CHECK(found.order == 0);
  CHECK(found.call == 0);
  CHECK(found.update == 0);
}

}  // namespace

TEST_CASE("what contacts ask for separates random pairs in shallow overlap") {
  const scenes::OdeSession session;
  for (const CertificateFamily& family : certificateFamilies()) {
    const FamilyVerdict found = judgeAll(family, {1, 0, kMembers}, {});
    INFO(family.name << ": the worst is member " << found.worst.number);
    checkTranslations(found);
    CHECK(found.tooDeep == 0);
  }
}

TEST_CASE("what contacts ask for separates bodies that are deep in inner corners") {
  const scenes::OdeSession session;
  // Bodies as deep as this may pierce the walls of a tray, which are thin.
  const std::set<std::string> corners = {"L",        "U",    "T",         "room",     "slot",    "step",   "vblock",
                                         "cylinder", "dBox", "dCylinder", "dCapsule", "dSphere", "dConvex"};
  std::size_t judged = 0;
  for (const CertificateFamily& family : certificateFamilies()) {
    if (!corners.contains(family.name)) continue;
    const FamilyVerdict found = judgeAll(family, {12, 0, kMembers, kDeepOverlaps}, {});
    INFO(family.name << ": the worst is member " << found.worst.number);
    checkTranslations(found);
    ++judged;
  }
  CHECK(judged == corners.size());
}

namespace {

struct KnownMember {
  const char* family;
  std::uint32_t seed;
  int number;
};

/// Calls visit(member, number) for each of these.
template <class Visit>
void forEachMember(std::span<const KnownMember> members, const Visit& visit) {
  const std::vector<CertificateFamily> families = certificateFamilies();
  for (const KnownMember& known : members) {
    INFO(known.family << ' ' << known.number << ", seed " << known.seed);
    const auto family =
        std::find_if(families.begin(), families.end(), [&](const auto& f) { return f.name == known.family; });
    REQUIRE(family != families.end());
    const std::optional<CertificateMember> member = certificateMember(*family, known.seed, known.number);
    REQUIRE(member);
    INFO(member->what);
    visit(*member, known.number);
  }
}

}  // namespace

TEST_CASE("pairs of other random numbers that had no certificate once have one") {
  const KnownMember failures[] = {
      // What was left lay in a region of less area than those that counted.
      {"cells", 2, 13},
      {"U", 4, 69},
      {"bin", 4, 86},
      {"screw", 5, 90},
      // Edges cross at the rim of a face, and the ray that measured the depth left through the side.
      {"cells", 4, 186},
      {"gears", 6, 18},
      // Out of the wall that is touched is a quarter of the way out of the groove.
      {"wedge", 6, 70},
      // The box of a large triangle holds the deepest point, and the triangle does not.
      {"dented", 31, 619},
      // A vertex of the mesh is held by the way in which the shape leaves it first.
      {"dConvex", 1, 6691},
      // The deepest contacts of a region that is not convex seemed to leave nothing, and went.
      {"shapes", 18, 397},
      // The middle of what facets cut out of an edge was outside of the cylinder, which the edge is in elsewhere.
      {"shapes", 12, 88},
      {"shapes", 17, 648},
      // A sharp ridge of the mesh lies across a cylinder's side. One of the ridge's own sides is left sooner.
      {"shapes", 31, 445},
      // Few facets are deepest where two of their edges pass each other, and none of these crosses the contour.
      {"bumpy", 3, 94},
      {"bumpy", 4, 58},
      {"bumpy", 4, 118},
  };
  const scenes::OdeSession session;
  forEachMember(failures, [](const CertificateMember& member, int number) {
    const Verdict verdict = judge(member, number, {});
    CHECK(verdict.certified());
    CHECK(verdict.length < 1.1);
  });
}

TEST_CASE("shapes on faces of many triangles have the same contacts after an update of the mesh") {
  const scenes::OdeSession session;
  // The planes of the triangles of a face differ by a rounding, and the largest are as large as each other.
  const KnownMember members[] = {
      {"dBox", 11, 52}, {"dBox", 11, 570}, {"dCylinder", 14, 109}, {"shapes", 13, 678}, {"dConvex", 11, 699}};
  forEachMember(members, [](const CertificateMember& member, int number) {
    CHECK_FALSE(judge(member, number, {}).updateMatters);
  });
}

TEST_CASE("walls of two regions and corners of two parts have one contact at a place") {
  const scenes::OdeSession session;
  const KnownMember members[] = {{"dCylinder", 11, 35}, {"on_blocks", 11, 43}, {"on_flush", 11, 21}};
  forEachMember(members, [](const CertificateMember& member, int) {
    const std::vector<JudgedContact> contacts = contactsInOde(member.a, member.b, {});
    CHECK(contacts.size() > 1);
    for (std::size_t i = 0; i < contacts.size(); ++i) {
      for (std::size_t k = 0; k < i; ++k) {
        const bool isSame = norm(otgSub(contacts[i].position, contacts[k].position)) < 1e-9 * member.size &&
                            otgDot(contacts[i].normal, contacts[k].normal) > 1 - 1e-9;
        CHECK_FALSE(isSame);
      }
    }
  });
}
