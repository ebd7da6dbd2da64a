// SPDX-License-Identifier: BSD-3-Clause
// What a body meets on the way that its contacts ask for.
#include "collide/solid/look_ahead.h"

#include <cmath>

#include "base/vectors.h"
#include "bvh/collision_mesh.h"
#include "collide/shortest_translation.h"
#include "collide/solid/solid_contacts.h"
#include "scenes/concave_meshes.h"
#include "scenes/generated_meshes.h"
#include "support/catch.h"
#include "truth/certificate_families.h"

using namespace otg;

namespace {

CollisionMesh meshOf(const scenes::MeshArrays& arrays) {
  return CollisionMesh(scenes::build(arrays), BuildStrategy::kSah);
}

Query solidQuery(const CollisionMesh& a, const CollisionMesh& b, const Transformd& bInA) {
  Query query;
  query.a = &a;
  query.b = &b;
  query.bInA = bInA;
  query.options.contacts = ContactModel::kSolid;
  return query;
}

/// The contacts of what is touched.
void touch(const Query& query, Workspace& workspace) {
  findIntersectingPairs(query, workspace);
  REQUIRE(solidContacts(query, workspace));
}

bool areSame(const std::vector<Contact>& x, const std::vector<Contact>& y) {
  return std::equal(x.begin(), x.end(), y.begin(), y.end(), [](const Contact& a, const Contact& b) {
    return a.position == b.position && a.normal == b.normal && a.depth == b.depth && a.region == b.region &&
           a.flags == b.flags && a.element == b.element;
  });
}

bool meetAfter(const Query& query, const Vec3d& way) {
  Query moved = query;
  moved.bInA.t = otgSub(query.bInA.t, way);
  Workspace workspace;
  findIntersectingPairs(moved, workspace);
  return !workspace.intersecting.empty();
}

Vec3d askedBy(const std::vector<Contact>& contacts) {
  ShortestTranslation t;
  for (const Contact& c : contacts) CHECK(t.add(c.normal, c.depth));
  return t.value();
}

Transformd between(const Transformd& a, const Transformd& b) {
  Transformd out{{}, otgRotateBack(a, otgSub(b.t, a.t))};
  for (int k = 0; k < 3; ++k) {
    const Vec3d column = otgRotateBack(a, Vec3d{b.r[k], b.r[3 + k], b.r[6 + k]});
    out.r[k] = column.x;
    out.r[3 + k] = column.y;
    out.r[6 + k] = column.z;
  }
  return out;
}

}  // namespace

TEST_CASE("a tip that is behind both walls and has come through one of them gets contacts with both") {
  // Floor and wall meet along y at (1, 1). The tip is 2e-3 below the floor and 1e-3 behind the wall, which the spike
  // meets nowhere above the floor.
  const CollisionMesh corner = meshOf(scenes::makeCorner(2, 1, 2));
  const Vec3d tip{1 - 1e-3, 0, 1 - 2e-3}, up{2, 0, 2};
  const Vec3d side{0, 0.05, 0}, lean = otgAdd(tip, Vec3d{0.9, 0, 0.05});
  const CollisionMesh spike = meshOf(scenes::makeTetrahedron(tip, otgAdd(lean, side), up, otgSub(lean, side)));
  const Query query = solidQuery(spike, corner, {{1, 0, 0, 0, 1, 0, 0, 0, 1}, {0, 0, 0}});
  Workspace workspace;
  touch(query, workspace);
  REQUIRE(!workspace.contacts.empty());
  lookAhead(query, workspace);
  const Vec3d asked = askedBy(workspace.contacts);
  CHECK_FALSE(meetAfter(query, otgScale(asked, 1.02)));
  CHECK(norm(asked) < 1.5 * std::hypot(1e-3, 2e-3));
}

TEST_CASE("the triangles that are near and the trees agree on whether more is met") {
  int begun = 0;
  Workspace workspace, other;
  for (const truth::CertificateFamily& family : truth::certificateFamilies()) {
    for (int i = 0; i < 12; ++i) {
      const auto member = truth::certificateMember(family, 5, i);
      if (!member || member->a.shape || member->b.shape) continue;
      const CollisionMesh a = meshOf(member->a.mesh), b = meshOf(member->b.mesh);
      const Query query = solidQuery(a, b, between(member->a.pose, member->b.pose));
      touch(query, workspace);
      const std::vector<Contact> touched = workspace.contacts;
      std::vector<Contact> turned(touched.rbegin(), touched.rend());
      lookAhead(query, workspace);
      const std::vector<Contact> all = workspace.contacts;
      CHECK(workspace.stats.contactsBeforeReduction == all.size());
      CHECK(workspace.stats.contactsAhead == all.size() - touched.size());
      workspace.contacts = touched;
      workspace.candidates.clear();
      lookAhead(query, workspace);
      CAPTURE(family.name, i);
      CHECK(areSame(workspace.contacts, all));
      Query ahead = query;
      const std::optional<Transformd> pose = poseAhead(query, turned, other);
      if (pose) {
        ahead.bInA = *pose;
        findIntersectingPairs(ahead, other);
      }
      const bool begins = pose && !other.intersecting.empty();
      CHECK((begins || areSame(touched, all)));
      begun += begins;
    }
  }
  CHECK(begun > 3);
}

TEST_CASE("the time of contacts has what looking ahead takes") {
  const CollisionMesh a = meshOf(scenes::makeCorner(2, 1, 2)), b = meshOf(scenes::makeCorner(1, 0.3, 0.8));
  Query query = solidQuery(a, b, {{1, 0, 0, 0, 1, 0, 0, 0, 1}, {0.4, 0.05, 0.5}});
  query.options.timings = true;
  Workspace workspace;
  touch(query, workspace);
  REQUIRE(!workspace.contacts.empty());
  const double before = workspace.stats.contactsMs;
  REQUIRE(before > 0);
  lookAhead(query, workspace);
  CHECK(workspace.stats.contactsMs > before);
}

TEST_CASE("bodies without hollows and large ones are not looked at") {
  const CollisionMesh box = meshOf(scenes::makeBox({1, 1, 1}, 2)), torus = meshOf(scenes::makeTorus(1, 0.3, 24, 24)),
                      corner = meshOf(scenes::makeCorner(1, 0.3, 0.8)),
                      two = meshOf(scenes::merge(
                          {scenes::makeBox({1, 1, 1}),
                           scenes::transformed(scenes::makeBox({1, 1, 1}), {{1, 0, 0, 0, 1, 0, 0, 0, 1}, {3, 0, 0}})})),
                      fine = meshOf(scenes::subdivided(scenes::makeCorner(1, 0.3, 0.8), 5));
  const Transformd pose{{1, 0, 0, 0, 1, 0, 0, 0, 1}, {0, 0, 0}};
  CHECK_FALSE(mayMeetAhead(solidQuery(box, torus, pose)));
  CHECK(mayMeetAhead(solidQuery(box, corner, pose)));
  CHECK(mayMeetAhead(solidQuery(two, box, pose)));
  CHECK_FALSE(mayMeetAhead(solidQuery(fine, box, pose)));
}

TEST_CASE("a translation that would be too long is not taken") {
  ShortestTranslation t;
  CHECK(t.add({1, 0, 0}, 1, 1.1));
  CHECK_FALSE(t.add({0, 1, 0}, 1, 1.1));
  CHECK(t.value().y == 0);
  CHECK(t.add({0, 1, 0}, 1, 1.5));
  CHECK(t.value().y == 1);
  CHECK(t.value().x == 1);
}
