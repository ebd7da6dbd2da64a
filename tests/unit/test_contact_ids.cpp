// SPDX-License-Identifier: BSD-3-Clause
// What a contact says of the features that it was made from: true of the meshes, unique in a query, and the same while
// nothing changes but the pose.
#include <algorithm>
#include <cmath>
#include <set>

#include "base/vectors.h"
#include "collide/contact_id.h"
#include "scenes/generated_meshes.h"
#include "support/catch.h"
#include "support/draw.h"

using namespace otg;
using namespace otg::test;

namespace {

CollisionMesh meshOf(const scenes::MeshArrays& arrays) {
  return CollisionMesh(scenes::build(arrays), BuildStrategy::kSah);
}

std::vector<Contact> contactsOf(const CollisionMesh& a, const CollisionMesh& b, const Transformd& pose,
                                ContactModel model = ContactModel::kSolid) {
  Query query;
  query.a = &a;
  query.b = &b;
  query.bInA = pose;
  query.options.contacts = model;
  query.options.reduction.method = Reduction::kNone;
  query.options.maxContacts = 65535;
  Workspace workspace;
  collide(query, workspace);
  return workspace.reduced;
}

bool isVertex(const Contact& c) {
  return c.feature == ContactFeature::kVertexA || c.feature == ContactFeature::kVertexB;
}
bool isOfA(const Contact& c) {
  return c.feature == ContactFeature::kVertexA || c.feature == ContactFeature::kCrossingA ||
         c.feature == ContactFeature::kMiddleA;
}

struct Placed {
  const CollisionMesh& a;
  const CollisionMesh& b;
  Transformd pose;
  const TriMesh& mesh(bool ofA) const { return ofA ? a.mesh() : b.mesh(); }
  Vec3d vertex(bool ofA, std::uint32_t v) const {
    const Vec3f& p = mesh(ofA).vertices()[v];
    const Vec3d x{p.x, p.y, p.z};
    return ofA ? x : otgTransform(pose, x);
  }
  Vec3d inOther(bool ofA, const Vec3d& p) const { return ofA ? otgRotateBack(pose, otgSub(p, pose.t)) : p; }
};

/// On which side of the plane of a triangle, by its volume with the point.
double side(const Placed& placed, bool ofA, std::uint32_t triangle, const Vec3d& p) {
  const Triangle& t = placed.mesh(ofA).triangles()[triangle];
  const Vec3d o = placed.vertex(ofA, t.v[0]);
  return otgDot(otgCross(otgSub(placed.vertex(ofA, t.v[1]), o), otgSub(placed.vertex(ofA, t.v[2]), o)), otgSub(p, o));
}

}  // namespace

TEST_CASE("features are where they are said to be, vertices inside are inside the analytic shape") {
  const CollisionMesh box = meshOf(scenes::makeBox({2, 1.5, 1}, 3)), sphere = meshOf(scenes::makeSphere(0.8, 3)),
                      torus = meshOf(scenes::makeTorus(1, 0.4, 40, 20));
  const auto inBox = [](const Vec3d& p) {
    return std::max({std::fabs(p.x) - 1, std::fabs(p.y) - 0.75, std::fabs(p.z) - 0.5}) <= 1e-9;
  };
  const auto inSphere = [](const Vec3d& p) { return norm(p) <= 0.8 + 1e-6; };
  const auto inTorus = [](const Vec3d& p) { return std::hypot(std::hypot(p.x, p.y) - 1, p.z) <= 0.4 + 1e-6; };
  struct Shape {
    const CollisionMesh* mesh;
    bool (*inside)(const Vec3d&);
  };
  const Shape shapes[] = {{&box, inBox}, {&sphere, inSphere}, {&torus, inTorus}};
  Draw draw(17);
  int vertices = 0, crossings = 0, middles = 0;
  for (int i = 0; i < 240; ++i) {
    const Shape &sa = shapes[i % 3], &sb = shapes[i / 3 % 3];
    const Vec3d at = draw.inBox(1.3);  // one by one: compilers differ in which argument they make first
    const double angle = draw.uniform(0, 6);
    const Placed placed{*sa.mesh, *sb.mesh, makePose(draw.direction(), angle, at)};
    std::set<std::uint64_t> ids;
    for (const Contact& c : contactsOf(placed.a, placed.b, placed.pose)) {
      REQUIRE(contactId(c) != 0);
      REQUIRE(ids.insert(contactId(c)).second);
      REQUIRE(c.feature != ContactFeature::kNone);
      REQUIRE(c.coherence >= 0);
      REQUIRE(c.coherence <= 1);
      const bool ofA = isOfA(c);
      if (isVertex(c)) {
        ++vertices;
        REQUIRE((c.flags & kContactInside) != 0);
        REQUIRE((ofA ? sb : sa).inside(placed.inOther(ofA, placed.vertex(ofA, c.element))));
        // Its own triangle has it for a corner.
        const Triangle& own = placed.mesh(ofA).triangles()[ofA ? c.triangleA : c.triangleB];
        const auto& weld = placed.mesh(ofA).topology().weld;
        REQUIRE((weld[own.v[0]] == c.element || weld[own.v[1]] == c.element || weld[own.v[2]] == c.element));
        continue;
      }
      const Topology::Edge& edge = placed.mesh(ofA).topology().edges[c.element];
      const Vec3d p = placed.vertex(ofA, edge.a), q = placed.vertex(ofA, edge.b);
      if (c.feature == ContactFeature::kCrossingA || c.feature == ContactFeature::kCrossingB) {
        ++crossings;
        REQUIRE((c.flags & kContactInside) == 0);
        const std::uint32_t other = ofA ? c.triangleB : c.triangleA;
        const double sp = side(placed, !ofA, other, p), sq = side(placed, !ofA, other, q);
        REQUIRE(sp * sq <= 1e-12);
        // It enters through a plane that it comes to from outside, and leaves from inside; stretches alternate.
        REQUIRE((c.ordinal % 2 == 0) == (sp > sq));
      } else {
        ++middles;
        REQUIRE((c.flags & kContactInside) != 0);
      }
    }
  }
  CHECK(vertices > 500);
  CHECK(crossings > 300);
  CHECK(middles > 30);  // only those deeper than the ends of their stretch are contacts
}

TEST_CASE("ids and features stay under motions that change no feature") {
  // A box turned about the vertical lies on a larger one, beside the diagonal of its face: four corners.
  const CollisionMesh ground = meshOf(scenes::makeBox({4, 4, 1}, 1)), box = meshOf(scenes::makeBox({1, 1, 1}, 1));
  const auto& face = ground.mesh().triangles();
  double side = -1;  // of the quadrants the one that the diagonal from (-2, -2) to (2, 2) does not cross, or else
  for (const Triangle& t : face) {
    int corners = 0;
    for (const std::uint32_t v : t.v) {
      const Vec3f& p = ground.mesh().vertices()[v];
      corners += p.z > 0 && p.x == -p.y;
    }
    if (corners == 2) side = 1;
  }
  std::set<std::uint64_t> first;
  for (int i = 0; i < 50; ++i) {
    const double x = 0.004 * i;
    const auto contacts =
        contactsOf(ground, box, makePose({0, 0, 1}, 0.3 + x, {1 + x, side * (1 - x), 0.99 + 1e-4 * i}));
    std::set<std::uint64_t> ids;
    for (const Contact& c : contacts) {
      REQUIRE(c.feature == ContactFeature::kVertexB);
      ids.insert(contactId(c));
    }
    if (i == 0) first = ids;
    REQUIRE(ids.size() == 4);
    REQUIRE(ids == first);
  }
}

TEST_CASE("a crossing keeps its id from triangle to triangle") {
  // A slim bar lies slantwise across the rim of a finely divided plate: its lower edges cross the plate's triangles.
  const CollisionMesh plate = meshOf(scenes::makeBox({2, 2, 0.5}, 16)), bar = meshOf(scenes::makeBox({3, 0.1, 0.1}, 1));
  std::set<std::uint64_t> all, triangles;
  int crossings = 0;
  for (int i = 0; i < 30; ++i) {
    const auto contacts = contactsOf(plate, bar, makePose({0, 1, 0}, 0.12, {0.01 * i, 0.02 * i, 0.38}));
    for (const Contact& c : contacts) {
      if (c.feature != ContactFeature::kCrossingB) continue;
      ++crossings;
      all.insert(contactId(c));
      triangles.insert(c.triangleA);
    }
  }
  INFO(crossings << " crossings, " << all.size() << " ids, " << triangles.size() << " triangles");
  CHECK(crossings > 50);   // of at most 2 in each of the 30 poses: the rest is carried by other features
  CHECK(all.size() <= 8);  // both ends of a stretch of each of the bar's four long edges
  CHECK(triangles.size() > 2 * all.size());
}

TEST_CASE("contacts of a contained body say so") {
  const CollisionMesh outer = meshOf(scenes::makeBox({4, 4, 4}, 1)), inner = meshOf(scenes::makeBox({1, 1, 1}, 1));
  const auto contacts = contactsOf(outer, inner, makeMove({1, 0.2, 0.1}));
  REQUIRE_FALSE(contacts.empty());
  for (const Contact& c : contacts) {
    CHECK(c.flags == (kContactInside | kContactContained));
    CHECK(c.feature == ContactFeature::kVertexB);
  }
  for (const Contact& c : contactsOf(outer, inner, makeMove({2.4, 0.2, 0.1}))) CHECK(c.coherence > 0.9);
}

TEST_CASE("pairwise contacts are named by their triangles") {
  const CollisionMesh sphere = meshOf(scenes::makeSphere(1, 3));
  std::set<std::uint64_t> ids;
  const auto contacts = contactsOf(sphere, sphere, makePose({0, 0.6, 0.8}, 0.3, {1.5, 0, 0}), ContactModel::kPairwise);
  REQUIRE(contacts.size() > 20);
  for (const Contact& c : contacts) {
    CHECK(c.element == kNone);
    CHECK(c.coherence == -1);
    CHECK(ids.insert(contactId(c)).second);
  }
}
