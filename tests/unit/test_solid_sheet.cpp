// SPDX-License-Identifier: BSD-3-Clause
// A solid on an open mesh, a sheet, gets the contacts that it gets on a slab with the same upper side.
#include "collide/query.h"
#include "scenes/generated_meshes.h"
#include "support/catch.h"
#include "support/draw.h"

using namespace otg;
using namespace otg::scenes;
using namespace otg::test;

namespace {

/// The upper side of makeGround(..., n): its first triangles.
MeshArrays upperSide(MeshArrays ground, int n) {
  ground.triangles.resize(static_cast<std::size_t>(2 * n * n));
  return ground;
}

CollisionMesh treeOf(const MeshArrays& arrays) {
  return CollisionMesh(buildTriMesh(arrays.input()).mesh, BuildStrategy::kSah);
}

std::vector<Contact> contactsOf(const CollisionMesh& a, const CollisionMesh& b, const Transformd& pose) {
  Query query;
  query.a = &a;
  query.b = &b;
  query.bInA = pose;
  query.options.contacts = ContactModel::kSolid;
  Workspace workspace;
  collide(query, workspace);
  return workspace.reduced;
}

Transformd inverse(const Transformd& t) {
  const double* r = t.r;
  Transformd out{{r[0], r[3], r[6], r[1], r[4], r[7], r[2], r[5], r[8]}, {0, 0, 0}};
  out.t = otgScale(otgRotate(out, t.t), -1.0);
  return out;
}

void requireEqual(const std::vector<Contact>& found, const std::vector<Contact>& expected) {
  REQUIRE(found.size() == expected.size());
  for (std::size_t k = 0; k < found.size(); ++k) {
    const Vec3d gap = otgSub(found[k].position, expected[k].position);
    REQUIRE(otgDot(gap, gap) < 1e-18);
    REQUIRE(otgDot(found[k].normal, expected[k].normal) > 1 - 1e-12);
    REQUIRE(found[k].depth == Approx(expected[k].depth).margin(1e-9));
  }
}

}  // namespace

TEST_CASE("a sheet gives the contacts of a slab") {
  const int n = 12;
  const auto hills = [](double x, double y) { return 0.1 * std::sin(2 * x) * std::cos(1.5 * y); };
  for (const bool flat : {true, false}) {
    const MeshArrays ground = flat ? makeGround(6, 2, n) : makeGround(6, 2, n, hills);
    const CollisionMesh slab = treeOf(ground), sheet = treeOf(upperSide(ground, n));
    REQUIRE(slab.mesh().meshClass() == MeshClass::kSolid);
    REQUIRE(sheet.mesh().meshClass() == MeshClass::kShell);
    const CollisionMesh bodies[] = {treeOf(makeBox({1, 0.8, 0.6}, 1)), treeOf(makeSphere(0.5, 3)),
                                    treeOf(makeLump(0.6, 4, 0.2, 7))};
    Draw draw(23);
    int met = 0;
    for (int i = 0; i < 150; ++i) {
      const CollisionMesh& body = bodies[i % 3];
      Transformd pose = makePose(draw.direction(), draw.uniform(0, 6), {0, 0, 0});
      pose.t = {draw.uniform(-1, 1), draw.uniform(-1, 1), draw.uniform(0.2, 0.7)};
      const auto expected = contactsOf(slab, body, pose), found = contactsOf(sheet, body, pose);
      requireEqual(found, expected);
      requireEqual(contactsOf(body, sheet, inverse(pose)), contactsOf(body, slab, inverse(pose)));
      if (!found.empty()) ++met;
    }
    CHECK(met > 60);
  }
}

TEST_CASE("over the rim of a sheet, and between sheets, contacts come from pairs") {
  const CollisionMesh sheet = treeOf(upperSide(makeGround(2, 1, 4), 4)), box = treeOf(makeBox({1, 1, 1}, 2));
  const auto rim = contactsOf(sheet, box, {{1, 0, 0, 0, 1, 0, 0, 0, 1}, {1, 0.1, 0.45}});
  REQUIRE_FALSE(rim.empty());
  for (const Contact& c : rim) CHECK(c.coherence == -1);  // what pairwise contacts have
  const auto middle = contactsOf(sheet, box, {{1, 0, 0, 0, 1, 0, 0, 0, 1}, {0.1, 0.1, 0.45}});
  REQUIRE_FALSE(middle.empty());
  for (const Contact& c : middle) {
    CHECK(c.coherence > 0.9);
    CHECK(c.depth == Approx(0.05));
    CHECK(c.normal.z == Approx(-1));  // into A, the sheet
  }
  Transformd upright{{1, 0, 0, 0, 0, -1, 0, 1, 0}, {0.1, 0.1, 0.2}};
  for (const Contact& c : contactsOf(sheet, sheet, upright)) CHECK(c.coherence == -1);
}

TEST_CASE("a sheet whose triangles disagree is no sheet") {
  MeshArrays arrays = upperSide(makeGround(4, 1, 6), 6);
  std::swap(arrays.triangles[30].v[1], arrays.triangles[30].v[2]);
  const CollisionMesh torn = treeOf(arrays), box = treeOf(makeBox({1, 1, 1}, 1));
  const auto contacts = contactsOf(torn, box, {{1, 0, 0, 0, 1, 0, 0, 0, 1}, {0.1, 0.1, 0.45}});
  REQUIRE_FALSE(contacts.empty());
  for (const Contact& c : contacts) CHECK(c.coherence == -1);
}
