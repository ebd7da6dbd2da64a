// SPDX-License-Identifier: BSD-3-Clause
// Solids of components that overlap: which are apart, and contacts that are those of the components.
#include <algorithm>
#include <cmath>
#include <set>
#include <tuple>
#include <vector>

#include "bvh/collision_mesh.h"
#include "collide/contact_id.h"
#include "collide/solid/solid_contacts.h"
#include "collide/stages.h"
#include "scenes/generated_meshes.h"
#include "support/catch.h"
#include "support/draw.h"
#include "support/flush_pairs.h"
#include "support/make_query.h"

using namespace otg;
using namespace otg::test;
using scenes::makeBox;
using scenes::merge;
using scenes::MeshArrays;

namespace {

std::shared_ptr<const CollisionMesh> meshOf(const MeshArrays& arrays) {
  return std::make_shared<const CollisionMesh>(scenes::build(arrays), BuildStrategy::kSah);
}

/// 0: no parts.
std::size_t countParts(const MeshArrays& arrays) {
  const auto mesh = meshOf(arrays);
  CHECK(mesh->mesh().meshClass() == MeshClass::kSolid);
  return mesh->parts() == nullptr ? 0 : mesh->parts()->parts.size();
}

MeshArrays turnedInside(MeshArrays mesh) {
  for (Triangle& t : mesh.triangles) std::swap(t.v[1], t.v[2]);
  return mesh;
}

MeshArrays tiles(int n, double overlap) {
  std::vector<MeshArrays> all;
  for (int i = 0; i < n; ++i) {
    for (int j = 0; j < n; ++j) all.push_back(moved(makeBox({1 + overlap, 1 + overlap, 1}), {1.0 * i, 1.0 * j, -0.5}));
  }
  return merge(all);
}

Transformd anyPose(Draw& draw) {
  const Vec3d axis = draw.direction(), move = draw.inBox(5);
  return makePose(axis, draw.uniform(0, 3), move);
}

/// What does not depend on how meshes number their triangles and vertices.
auto placeOf(const Contact& c) {
  return std::make_tuple(c.position.x, c.position.y, c.position.z, c.normal.x, c.normal.y, c.normal.z, c.depth,
                         static_cast<int>(c.feature));
}
using Places = std::multiset<decltype(placeOf(Contact{}))>;

void add(const CollisionMesh& a, const CollisionMesh& b, const Transformd& bInA, Places& places,
         std::vector<Contact>* contacts = nullptr) {
  Query query = makeQuery(a, b, bInA);
  query.options.contacts = ContactModel::kSolid;
  Workspace workspace;
  findIntersectingPairs(query, workspace);
  REQUIRE(solidContacts(query, workspace));
  for (const Contact& c : workspace.contacts) places.insert(placeOf(c));
  if (contacts != nullptr) *contacts = workspace.contacts;
}

}  // namespace

TEST_CASE("Components that overlap are parts, and those that touch are not") {
  const MeshArrays box = makeBox({1, 1, 1}), torus = scenes::makeTorus(0.7, 0.25, 24, 12), leg = makeBox({0.1, 0.1, 1});
  struct Pair {
    const char* what;
    MeshArrays mesh;
    std::size_t parts;
  };
  const std::vector<Pair> pairs{
      {"one box", box, 0},
      {"apart", merge({box, moved(box, {3, 0, 0})}), 0},
      {"side by side", merge({box, moved(box, {1, 0, 0})}), 0},
      {"side by side, and not flush", merge({box, moved(box, {1, 0.25, 0.5})}), 0},
      {"on each other", merge({makeBox({4, 4, 1}), moved(makeBox({1, 1, 1}), {0.25, 0.5, 1})}), 0},
      {"at an edge", merge({box, moved(box, {1, 1, 0})}), 0},
      {"beside a step", merge({makeBox({1, 1, 1}), moved(makeBox({1, 1, 2}), {1, 0, 0.5})}), 0},
      {"crossing", merge({box, moved(box, {0.5, 0.25, 0.125})}), 2},
      {"one after the other, aligned", merge({box, moved(box, {0.5, 0, 0})}), 2},
      {"a cross with one top", merge({makeBox({3, 1, 1}), makeBox({1, 3, 1})}), 2},
      {"a corner with one top", merge({makeBox({3, 1, 1}), moved(makeBox({1, 3, 1}), {1, 1, 0})}), 2},
      {"steps with one floor", merge({makeBox({2, 2, 1}), moved(makeBox({1, 2, 2}), {0.5, 0, 0.5})}), 2},
      {"sunk into a floor", merge({makeBox({4, 4, 1}, 3), moved(makeBox({1, 1, 1}), {0.1, 0.2, 0.9})}), 2},
      {"three through each other", merge({makeBox({3, 1, 1}), makeBox({1, 3, 1.25}), makeBox({1.25, 0.5, 3})}), 3},
      {"a chain", merge({box, moved(box, {0.75, 0.1, 0}), moved(box, {1.5, 0.2, 0}), moved(box, {2.25, 0.3, 0})}), 4},
      {"a chain of tori",
       merge({torus, moved(torus, {1.5, 0.1, 0}), moved(torus, {3, 0.2, 0}), moved(torus, {4.5, 0.1, 0})}), 2},
      {"a table",
       merge({makeBox({2, 1, 0.1}), moved(leg, {0.8, 0.4, -0.5}), moved(leg, {-0.8, 0.4, -0.5}),
              moved(leg, {-0.8, -0.4, -0.5})}),
       4},
      {"a table with a tray on it",
       merge({makeBox({2, 1, 0.1}), moved(leg, {0.8, 0.4, -0.5}), moved(leg, {-0.8, 0.4, -0.5}),
              moved(makeBox({1, 0.5, 0.1}), {0, 0, 0.1})}),
       2},
      {"spheres", merge({scenes::makeSphere(1, 2), moved(scenes::makeSphere(1, 2), {1.5, 0.1, 0})}), 2}};
  Draw draw(2);
  for (const Pair& pair : pairs) {
    INFO(pair.what);
    CHECK(countParts(pair.mesh) == pair.parts);
    // The same where vertices are rounded.
    for (int i = 0; i < 20; ++i) CHECK(countParts(scenes::transformed(pair.mesh, anyPose(draw))) == pair.parts);
  }
}

TEST_CASE("Tiles stay together where one thing is sunk into some of them, and overlapping tiles don't") {
  CHECK(countParts(tiles(4, 0)) == 0);
  const MeshArrays kerb = moved(makeBox({0.2, 3, 0.5}), {1.5, 1.5, 0.1});
  const auto mesh = meshOf(merge({tiles(4, 0), kerb}));
  REQUIRE(mesh->parts() != nullptr);
  REQUIRE(mesh->parts()->parts.size() == 2);
  CHECK(mesh->parts()->parts[0].triangleOf.size() == 16 * 12);
  CHECK(mesh->parts()->parts[1].triangleOf.size() == 12);
  CHECK(countParts(tiles(4, 0.02)) == 16);
}

TEST_CASE("A cavity stays with what is around it") {
  const MeshArrays room = merge({makeBox({4, 4, 4}), turnedInside(makeBox({3, 3, 3}))});
  const MeshArrays inside = moved(makeBox({0.5, 0.5, 0.5}), {1, 1, 1}), porch = moved(makeBox({1, 1, 1}), {2.2, 0, 0});
  CHECK(countParts(room) == 0);
  CHECK(countParts(merge({room, inside})) == 0);
  const auto mesh = meshOf(merge({porch, room, inside}));
  REQUIRE(mesh->parts() != nullptr);
  REQUIRE(mesh->parts()->parts.size() == 2);
  std::vector<std::size_t> triangles;
  for (const SolidParts::Part& part : mesh->parts()->parts) triangles.push_back(part.triangleOf.size());
  std::sort(triangles.begin(), triangles.end());
  CHECK(triangles == std::vector<std::size_t>{12, 36});
}

TEST_CASE("Triangles of parts are those of the whole") {
  Draw draw(4);
  std::vector<MeshArrays> boxes;
  for (int i = 0; i < 20; ++i) {  // bars, of which none fits into another one
    const Vec3d size{draw.uniform(1.5, 2), draw.uniform(0.2, 0.3), draw.uniform(0.2, 0.3)};
    const Vec3d axis = draw.direction(), at = draw.inBox(0.5);
    boxes.push_back(scenes::transformed(makeBox(size), makePose(axis, draw.uniform(0, 3), at)));
  }
  const auto mesh = meshOf(merge(boxes));
  REQUIRE(mesh->mesh().meshClass() == MeshClass::kSolid);
  const CollisionMesh::Parts* const parts = mesh->parts();
  REQUIRE(parts != nullptr);
  std::size_t triangles = 0;
  REQUIRE(parts->meshes.size() == parts->parts.size());
  for (const SolidParts::Part& part : parts->parts) {
    const TriMesh& own = *part.mesh;
    CHECK(own.meshClass() == MeshClass::kSolid);
    REQUIRE(own.triangleCount() == part.triangleOf.size());
    triangles += own.triangleCount();
    for (std::uint32_t t = 0; t < own.triangleCount(); ++t) {
      const Triangle &of = own.triangles()[t], &whole = mesh->mesh().triangles()[part.triangleOf[t]];
      for (int k = 0; k < 3; ++k) {
        CHECK(own.vertices()[of.v[k]] == mesh->mesh().vertices()[whole.v[k]]);
        CHECK(part.vertexOf[of.v[k]] == whole.v[k]);
      }
      CHECK(parts->numberOf[part.triangleOf[t]] == t);
    }
  }
  CHECK(triangles == mesh->mesh().triangleCount());
}

TEST_CASE("A body in overlapping components has the contacts that it has with each of them") {
  Draw draw(6);
  int several = 0, compared = 0, equal = 0;
  for (int i = 0; i < 200; ++i) {
    // A stair of boxes with one floor, or blocks in any poses.
    std::vector<MeshArrays> blocks;
    for (int k = 0; k < 3; ++k) {
      const double high = 0.3 * (k + 1);
      const Vec3d turn = draw.direction(), place = draw.inBox(0.7);
      blocks.push_back(i % 2 == 0 ? moved(makeBox({3.0 - k, 2, high}), {0.5 * k, 0, high / 2})
                                  : scenes::transformed(makeBox({1.5, 1, 1}), makePose(turn, 2, place)));
    }
    const auto whole = meshOf(merge(blocks));
    const auto body = meshOf(scenes::makeLump(0.4, 1, 0.2, static_cast<std::uint32_t>(i)));
    const Vec3d axis = draw.direction(), at = draw.inBox(1.2);
    const Transformd pose = makePose(axis, draw.uniform(0, 3), at);
    INFO(i);
    if (whole->parts() == nullptr) continue;
    Places ofWhole, ofEach;
    std::vector<Contact> contacts;
    add(*whole, *body, pose, ofWhole, &contacts);
    std::size_t touched = 0;
    for (const MeshArrays& block : blocks) {
      const std::size_t before = ofEach.size();
      add(*meshOf(block), *body, pose, ofEach);
      touched += ofEach.size() > before;
    }
    several += touched > 1;
    // Where surfaces contradict each other in one of them, all depths are cut.
    const auto isCut = [](const Contact& c) { return (c.flags & kContactClamped) != 0; };
    if (!std::any_of(contacts.begin(), contacts.end(), isCut)) {
      // Walls inside are left out.
      CHECK(std::includes(ofEach.begin(), ofEach.end(), ofWhole.begin(), ofWhole.end()));
      ++compared;
      equal += ofWhole == ofEach;
    }
    std::set<std::uint64_t> ids;
    for (const Contact& c : contacts) {
      ids.insert(contactId(c));
      CHECK((c.triangleA == kNone || c.triangleA < whole->mesh().triangleCount()));
    }
    CHECK(ids.size() == contacts.size());
  }
  CHECK(several > 60);
  CHECK(compared > 150);
  CHECK(equal > 140);
}

TEST_CASE("Walls inside are left out region by region") {
  // The floor is in two pieces that overlap, and the block is in the part of one of them.
  const auto ground = meshOf(merge({moved(makeBox({6, 10, 1}), {-2, 0, -0.5}), moved(makeBox({6, 10, 1}), {3, 0, -0.5}),
                                    moved(makeBox({1, 2, 2}), {5.3, 0, -1})}));
  REQUIRE(ground->parts() != nullptr);
  const auto body = meshOf(makeBox({5, 0.5, 0.5}));
  Draw draw(10);
  for (int i = 0; i < 100; ++i) {
    const double low = std::pow(10, draw.uniform(-5, -3)), over = std::pow(10, draw.uniform(-5, -2));
    const Transformd pose = makeMove({4.8 + over - 2.5, draw.uniform(-0.5, 0.5), 0.25 - low});
    Query query = makeQuery(*ground, *body, pose);
    query.options.contacts = ContactModel::kSolid;
    Workspace workspace;
    for (const bool convexPath : {false, true}) {
      query.options.solid.convexPath = convexPath;
      collide(query, workspace);
      INFO(i << ", convex path " << convexPath);
      CHECK(workspace.reduced.size() >= 3);
      for (const Contact& c : workspace.reduced) {
        CHECK(std::fabs(c.normal.z) > 0.999);
        CHECK(c.depth < 1.01 * low + 1e-6);
      }
    }
  }
}

TEST_CASE("Parts follow vertices that move") {
  const MeshArrays box = makeBox({1, 1, 1});
  const MeshArrays boxes = merge({moved(box, {-4, 0, 0}), box, moved(box, {1.125, 0, 0}), moved(box, {4, 0, 0})});
  CollisionMesh mesh(scenes::build(boxes), BuildStrategy::kSah);
  CHECK(mesh.parts() == nullptr);
  for (const float by : {-0.25F, 0.25F, 0.125F}) {
    std::vector<MovedVertex> moves;
    for (std::uint32_t v = 0; v < boxes.vertices.size(); ++v) {
      const Vec3f& p = mesh.mesh().vertices()[v];
      if (p.x > 0.3F && p.x < 2 && boxes.vertices[v].x > 0.55F) moves.push_back({v, {p.x + by, p.y, p.z}});
    }
    REQUIRE(moves.size() == 8);
    REQUIRE(mesh.moveSome(moves));
    CHECK((mesh.parts() != nullptr) == (by == -0.25F));
  }
}
