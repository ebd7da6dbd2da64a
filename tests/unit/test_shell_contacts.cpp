// SPDX-License-Identifier: BSD-3-Clause
// Contacts of meshes that are no solids: who is the ground, what is cut out of a triangle, and where bodies are pushed.
#include <algorithm>
#include <limits>
#include <optional>

#include "base/vectors.h"
#include "collide/shell/clip_triangle.h"
#include "collide/shell/ground_sides.h"
#include "collide/shell/shell_roles.h"
#include "support/catch.h"
#include "support/contact_samples.h"
#include "support/hostile_meshes.h"
#include "support/shell_scenes.h"
#include "truth/shortest_translation.h"

using namespace otg;
using namespace otg::test;

namespace {

/// A ground and bodies on it, both ways round in `pose`.
struct Member {
  MeshPtr ground, body;
  Transformd pose;  ///< of the body in the ground's frame
};

std::vector<Member> family(std::uint32_t seed, int each) {
  Draw draw(seed);
  std::vector<MeshPtr> grounds;
  for (const auto& ground : {scenes::makeGround(10, 1, 1), terrain(10, 1, 0), terrain(10, 20, 0.5),
                             twoSided(terrain(10, 20, 0.5)), doubled(scenes::makeGround(3, 1, 2))}) {
    grounds.push_back(collisionMesh(ground));
  }
  std::vector<Member> members;
  for (const MeshPtr& ground : grounds) {
    for (const ShellBody kind : kShellBodies) {
      for (int i = 0; i < each; ++i) {
        const MeshPtr body = collisionMesh(makeBody(kind, {draw.uniform(0.4, 1.2), draw.uniform(0.4, 1.2), 0.5}));
        const double angle = draw.uniform(0, 6);  // first: compilers differ in which argument they make first
        Transformd pose = makePose(draw.direction(), angle, {0, 0, 0});
        pose.t = {draw.uniform(-1, 1), draw.uniform(-1, 1), 0};
        members.push_back({ground, body, loweredOn(*ground, *body, pose, draw.uniform(0.001, 0.05), 1)});
      }
    }
  }
  return members;
}

bool areNear(const Vec3d& x, const Vec3d& y, double tolerance) {
  const Vec3d d = otgSub(x, y);
  return std::sqrt(otgDot(d, d)) <= tolerance;
}

}  // namespace

TEST_CASE("the larger mesh is the ground, and of equal ones the solid") {
  const MeshPtr large = collisionMesh(terrain(4, 4, 0)), quad = collisionMesh(flatSheet(1, 1, 1));
  const MeshPtr box = collisionMesh(scenes::makeBox({1, 1, 1})),
                open = collisionMesh(makeBody(ShellBody::kOpenBox, {1, 1, 1}));
  CHECK(isGround(large->mesh(), quad->mesh()));
  CHECK_FALSE(isGround(quad->mesh(), large->mesh()));
  CHECK(isGround(box->mesh(), open->mesh()));
  CHECK_FALSE(isGround(open->mesh(), box->mesh()));
  CHECK(isGround(box->mesh(), box->mesh()));
  // Two solids never have contacts of shells, a solid on a larger sheet has them at rims alone, all others always.
  CHECK_FALSE(areShells(box->mesh(), box->mesh()));
  CHECK_FALSE(areShells(large->mesh(), box->mesh()));
  CHECK(areShells(box->mesh(), quad->mesh()));
  CHECK(areShells(large->mesh(), quad->mesh()));
  const MeshPtr twice = collisionMesh(doubled(terrain(4, 4, 0)));
  CHECK(areShells(twice->mesh(), box->mesh()));
}

TEST_CASE("what is cut out of a triangle lies behind the other one and within its prism, and nothing is left out") {
  Draw draw(3);
  for (int i = 0; i < 2000; ++i) {
    Vec3d triangle[3], of[3];
    for (int k = 0; k < 3; ++k) {
      triangle[k] = draw.inBox(1);
      of[k] = draw.inBox(1);
    }
    const Vec3d cross = otgCross(otgSub(of[1], of[0]), otgSub(of[2], of[0]));
    const double area2 = std::sqrt(otgDot(cross, cross));
    if (area2 < 0.05) continue;
    const double side = i % 2 == 0 ? 1 : -1;
    const Vec3d front = otgScale(cross, side / area2);
    const ClippedTriangle clipped = clipBehind(triangle, of, front);
    const auto isKept = [&](const Vec3d& p, double slack) {
      if (otgDot(front, otgSub(p, of[0])) > slack) return false;
      for (int k = 0; k < 3; ++k) {
        const Vec3d inward = otgCross(otgScale(cross, 1 / area2), otgSub(of[(k + 1) % 3], of[k]));
        if (otgDot(inward, otgSub(p, of[k])) < -slack) return false;
      }
      return true;
    };
    for (int k = 0; k < clipped.count; ++k) CHECK(isKept(clipped.corners[std::size_t(k)].point, 1e-12));
    // Points of the triangle: kept ones are in the polygon, as the sum of the triangles to its corners tells.
    const auto areaOf = [](const Vec3d& a, const Vec3d& b, const Vec3d& c) {
      const Vec3d n = otgCross(otgSub(b, a), otgSub(c, a));
      return 0.5 * std::sqrt(otgDot(n, n));
    };
    double whole = 0;
    for (int k = 2; k < clipped.count; ++k) {
      whole += areaOf(clipped.corners[0].point, clipped.corners[std::size_t(k - 1)].point,
                      clipped.corners[std::size_t(k)].point);
    }
    for (int n = 0; n < 8; ++n) {
      double u = draw.uniform(0, 1), v = draw.uniform(0, 1);
      if (u + v > 1) {
        u = 1 - u;
        v = 1 - v;
      }
      const Vec3d p = otgAdd(triangle[0], otgAdd(otgScale(otgSub(triangle[1], triangle[0]), u),
                                                 otgScale(otgSub(triangle[2], triangle[0]), v)));
      double around = 0;
      for (int k = 0; k < clipped.count; ++k) {
        around += areaOf(p, clipped.corners[std::size_t(k)].point,
                         clipped.corners[std::size_t((k + 1) % clipped.count)].point);
      }
      if (isKept(p, -1e-9)) CHECK(around <= whole + 1e-9);
      if (!isKept(p, 1e-9) && clipped.count > 2) CHECK(around > whole);
    }
  }
}

TEST_CASE("a segment crosses coincident triangles once, and an edge of two as well") {
  const MeshPtr twice = collisionMesh(doubled(terrain(4, 4, 0)));
  std::vector<double> scratch;
  CHECK(crossesOddly(*twice, {0.3, 0.1, 1}, {0.3, 0.1, -1}, 0, scratch));
  CHECK(crossesOddly(*twice, {0, 0, 1}, {0, 0, -1}, 0, scratch));
  CHECK_FALSE(crossesOddly(*twice, {0.3, 0.1, 1}, {0.6, 0.1, 0.5}, 0, scratch));
  CHECK_FALSE(crossesOddly(*twice, {3, 0.1, 1}, {3, 0.1, -1}, 0, scratch));
  const MeshPtr box = collisionMesh(doubled(scenes::makeBox({1, 1, 1})));
  CHECK_FALSE(crossesOddly(*box, {0.3, 0.1, 2}, {0.3, 0.1, -2}, 0, scratch));
  CHECK(crossesOddly(*box, {0.3, 0.1, 2}, {0.3, 0.1, 0}, 0, scratch));
}

TEST_CASE("corners of a quad in a slab are pushed out by the way they are in, whichever mesh comes first") {
  const MeshPtr slab = collisionMesh(scenes::makeGround(10, 1, 1)), quad = collisionMesh(flatSheet(1, 1, 1));
  // Tilted about y: the corners at x = 0.5 are the lower ones.
  Transformd pose = makePose({0, 1, 0}, 0.1, {0.2, 0.3, 0});
  pose.t.z = 0.5 * std::sin(0.1) - 0.003;
  for (const bool first : {true, false}) {
    const std::vector<Contact> contacts =
        contactsOf(first ? solidQuery(*slab, *quad, pose) : solidQuery(*quad, *slab, inverse(pose)));
    REQUIRE(contacts.size() >= 2);
    for (const Contact& c : contacts) {
      const Vec3d normal = first ? c.normal : otgRotate(pose, c.normal);
      CHECK(areNear(normal, {0, 0, first ? -1.0 : 1.0}, 1e-12));
      const Vec3d at = first ? c.position : otgTransform(pose, c.position);
      CHECK(std::fabs(c.depth + at.z) < 1e-9);
    }
    CHECK(std::fabs(contacts[0].depth - 0.003) < 1e-9);
    CHECK(std::fabs(contacts[1].depth - 0.003) < 1e-9);
  }
}

TEST_CASE("contacts of shells do not depend on which mesh is A, nor on what was asked before") {
  Workspace used;
  std::size_t found = 0;
  for (const Member& m : family(5, 6)) {
    Query one = solidQuery(*m.ground, *m.body, m.pose), other = solidQuery(*m.body, *m.ground, inverse(m.pose));
    one.options.maxContacts = other.options.maxContacts = 1000;
    if (!mayBeShells(one)) continue;
    std::vector<Contact> x = contactsOf(one), y = contactsOf(other);
    collide(one, used);
    CHECK(sameBytes(x, used.reduced));
    for (const Traversal traversal : {Traversal::kStandard, Traversal::kQuantized, Traversal::kNoLeaf}) {
      Query query = one;
      query.options.middle.traversal = traversal;
      CHECK(sameBytes(contactsOf(query), x));
    }
    CHECK(x.size() > 0);
    REQUIRE(x.size() == y.size());
    found += x.size();
    for (const Contact& c : y) {
      const bool isThere = std::any_of(x.begin(), x.end(), [&](const Contact& d) {
        return areNear(otgTransform(m.pose, c.position), d.position, 1e-9) &&
               areNear(otgRotate(m.pose, c.normal), otgScale(d.normal, -1.0), 1e-6) &&
               std::fabs(c.depth - d.depth) < 1e-9;
      });
      CHECK(isThere);
    }
  }
  CHECK(found > 300);
}

TEST_CASE("the visitor's winding changes nothing") {
  Draw draw(9);
  int tried = 0;
  const MeshPtr ground = collisionMesh(terrain(10, 20, 0.5));
  for (int i = 0; i < 40; ++i) {
    const scenes::MeshArrays sheet = flatSheet(draw.uniform(0.4, 1.2), 0.7, 6);
    const MeshPtr up = collisionMesh(sheet), down = collisionMesh(turned(sheet));
    Transformd pose = makePose(draw.direction(), draw.uniform(0, 6), {0, 0, 0});
    pose = loweredOn(*ground, *up, pose, 0.01, 1);
    Workspace workspace;
    findIntersectingPairs(solidQuery(*ground, *up, pose), workspace);
    if (workspace.intersecting.empty()) continue;  // fell through between two steps
    ++tried;
    const std::vector<Contact> x = contactsOf(solidQuery(*ground, *up, pose));
    const std::vector<Contact> y = contactsOf(solidQuery(*ground, *down, pose));
    REQUIRE(x.size() == y.size());
    CHECK(x.size() > 0);
    for (const Contact& c : x) CHECK(c.normal.z < 0);  // into the ground, which is A
  }
  CHECK(tried > 30);
}

TEST_CASE("a shell that is remembered in front of a sheet is found when it has passed through it") {
  const MeshPtr sheet = collisionMesh(terrain(4, 1, 0)), twice = collisionMesh(twoSided(terrain(4, 1, 0)));
  const MeshPtr quad = collisionMesh(flatSheet(1, 1, 1));
  for (const MeshPtr& ground : {sheet, twice}) {
    for (const double side : {1.0, -1.0}) {
      SolidHistory history;
      const auto at = [&](double height) {
        Query query = solidQuery(*ground, *quad, makeMove({0.1, 0.2, side * height}));
        query.history = &history;
        return contactsOf(query);
      };
      CHECK(at(0.02).empty());
      CHECK(history.current.side != 0);
      const std::vector<Contact> contacts = at(-0.01);
      REQUIRE(contacts.size() == 4);
      for (const Contact& c : contacts) {
        CHECK(std::fabs(c.depth - 0.01) < 1e-6);
        CHECK(areNear(c.normal, {0, 0, -side}, 1e-9));
      }
      // A query at the same pose changes nothing.
      CHECK(sameBytes(at(-0.01), contacts));
      CHECK(at(0.01).empty());
      // Somewhere else altogether: it did not pass through.
      CHECK(at(-0.9).empty());
      CHECK(at(-0.88).empty());
    }
  }
}

TEST_CASE("a shell beside the rim of a sheet is not drawn back over it") {
  const MeshPtr sheet = collisionMesh(terrain(2, 4, 0)), quad = collisionMesh(flatSheet(0.4, 0.4, 1));
  SolidHistory history;
  for (double z = 0.1; z > -0.3; z -= 0.01) {
    Query query = solidQuery(*sheet, *quad, makeMove({1.25, 0, z}));
    query.history = &history;
    CHECK(contactsOf(query).empty());
  }
}

TEST_CASE("no contact of shells is deeper than a share of the smaller body") {
  for (Member m : family(6, 4)) {
    m.pose.t.z -= 0.2;
    const Query query = solidQuery(*m.ground, *m.body, m.pose);
    if (!mayBeShells(query)) continue;
    for (const Contact& c : contactsOf(query)) {
      CHECK(c.depth >= 0);
      CHECK(c.depth <= 0.0600001 * double{m.body->mesh().radius()});
      CHECK(std::fabs(otgDot(c.normal, c.normal) - 1) < 1e-9);
    }
  }
}

TEST_CASE("the contacts of shells together ask for no longer a way than one of them may") {
  Draw draw(18);
  int overlapped = 0;
  for (const Hostile below :
       {Hostile::kFins, Hostile::kSoup, Hostile::kTornBall, Hostile::kNeedles, Hostile::kMoebius}) {
    for (int i = 0; i < 100; ++i) {
      const MeshPtr ground = collisionMesh(makeHostile(below, {2, 2, 1}, draw)),
                    body = collisionMesh(makeBody(kShellBodies[draw.below(6)], {0.6, 0.5, 0.3}));
      const Transformd pose = makePose(draw.direction(), draw.uniform(0, 6),
                                       {draw.uniform(-0.8, 0.8), draw.uniform(-0.8, 0.8), draw.uniform(-0.4, 0.4)});
      const Query query = solidQuery(*ground, *body, pose);
      std::vector<truth::HalfSpace> asked;  // of contacts that do more than stop
      for (const Contact& c : contactsOf(query)) {
        if (c.depth > 0) asked.push_back({c.normal, c.depth});
      }
      if (asked.empty()) continue;
      ++overlapped;
      const std::optional<Vec3d> way = truth::shortestTranslation(asked);
      REQUIRE(way);
      CHECK(norm(*way) <= 0.0600001 * double{body->mesh().radius()});
    }
  }
  CHECK(overlapped > 200);
}

TEST_CASE("every shell that lies in a solid has contacts, wholly inside, too") {
  Draw draw(12);
  const MeshPtr slab = collisionMesh(scenes::makeGround(10, 1, 3));
  for (int i = 0; i < 300; ++i) {
    const ShellBody kind = kShellBodies[draw.below(6)];
    const MeshPtr body = collisionMesh(makeBody(kind, {0.5, draw.uniform(0.2, 0.6), 0.3}));
    Transformd pose = makePose(draw.direction(), draw.uniform(0, 6), {0, 0, draw.uniform(-0.5, 0.05)});
    Query query = solidQuery(*slab, *body, pose);
    Workspace workspace;
    collide(query, workspace);
    double lowest = 1;
    for (const Vec3f& v : body->mesh().vertices()) {
      lowest = std::min(lowest, otgTransform(pose, Vec3d{v.x, v.y, v.z}).z);
    }
    CHECK(workspace.reduced.empty() == (lowest > 0));
  }
}
