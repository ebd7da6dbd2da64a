// SPDX-License-Identifier: BSD-3-Clause
// Solids with faults: which way their triangles face is found all the same. Faults are made, so the truth is known.
#include "mesh/outward_sides.h"

#include "bvh/collision_mesh.h"
#include "scenes/generated_meshes.h"
#include "scenes/mesh_arrays.h"
#include "support/catch.h"
#include "support/faulty_mesh.h"
#include "truth/wild_bodies.h"

using namespace otg;
using scenes::MeshArrays;
using test::Faulty;

namespace {

std::vector<std::int8_t> sidesOf(const MeshArrays& mesh, bool weld = false) {
  return outwardSides(*buildTriMesh(mesh.input(), RepairOptions{.weldVertices = weld}).mesh).each;
}

struct Body {
  MeshArrays mesh;
  bool isFlush = false;
};

std::vector<Body> bodies() {
  truth::Random draw(7);
  return {{scenes::makeBox({1, 2, 3}, 2)},         {scenes::makeBox({1, 1, 1}, 3)},
          {scenes::makeTorus(1, 0.3, 16, 10)},     {scenes::makeLump(1, 3, 0.4, 5)},
          {scenes::makeGear(9, 1, 0.2, 0.4, 0.3)}, {scenes::makeBowl(1, 0.2, 16, 6)},
          {truth::flushBlocks(draw), true},        {truth::flushBlocks(draw), true}};
}

MeshArrays turned(const MeshArrays& mesh, double angle) {
  const double c = std::cos(angle), s = std::sin(angle);
  return scenes::transformed(mesh, {{c, -s, 0, s, c, 0, 0, 0, 1}, {0.3, -0.1, 0.7}});
}

}  // namespace

TEST_CASE("the sides of a solid with a fault are those that it had without") {
  std::mt19937 random(1);
  int found = 0;
  for (int i = 0; i < 60; ++i) {
    for (const auto& [body, isFlush] : bodies()) {
      for (int fault = 0; fault < 6; ++fault) {
        INFO("round " << i << ", fault " << fault << ", " << body.triangles.size() << " triangles");
        Faulty faulty(turned(body, 0.1 * i));
        if (fault == 0) faulty.loseTriangle(random);
        if (fault == 1) faulty.pierce(random);
        if (fault == 2) faulty.crack(random);
        // Turned round, the face of a flush block is a copy of its neighbour's.
        if (fault == 3 && isFlush) continue;
        if (fault == 3) faulty.turnOne(random);
        if (fault == 4) faulty.doubleAll();
        if (fault == 5) faulty.crackTwice(random);
        const std::vector<std::int8_t> sides = sidesOf(faulty.mesh);
        // Of few triangles a missing one is much of the surface.
        if (fault == 0 && isFlush && sides.empty()) continue;
        CHECK(sides == faulty.sides);
        ++found;
      }
    }
  }
  CHECK(found > 2600);
}

TEST_CASE("the sides of a solid with several faults are found, by positions alone, too") {
  std::mt19937 random(2);
  int found = 0;
  const int rounds = 100;
  for (int i = 0; i < rounds; ++i) {
    INFO("round " << i);
    Faulty faulty(turned(scenes::makeLump(1, 3, 0.4, static_cast<std::uint32_t>(i)), 0.1 * i));
    for (int k = 0; k < 3; ++k) {
      faulty.crack(random);
      faulty.pierce(random);
      faulty.turnOne(random);
    }
    faulty.loseTriangle(random);
    if (i % 2 == 0) faulty.doubleAll();
    MeshArrays soup = faulty.mesh;
    soup.vertices.clear();
    for (Triangle& t : soup.triangles) {
      for (std::uint32_t& v : t.v) {
        soup.vertices.push_back(faulty.mesh.vertices[v]);
        v = static_cast<std::uint32_t>(soup.vertices.size() - 1);
      }
    }
    const std::vector<std::int8_t> sides = sidesOf(faulty.mesh);
    CHECK(sidesOf(soup) == sides);
    // Faults next to each other make larger holes.
    if (sides.empty()) continue;
    CHECK(sides == faulty.sides);
    ++found;
  }
  CHECK(found > rounds * 3 / 4);
}

TEST_CASE("cracks and holes may meet in a vertex") {
  std::mt19937 random(3);
  for (int i = 0; i < 300; ++i) {
    // Of twelve triangles few are apart from each other.
    Faulty faulty(turned(scenes::makeBox({1, 2, 3}), 0.1 * i));
    for (int k = 0; k < 6; ++k) faulty.crack(random);
    INFO("round " << i);
    CHECK(sidesOf(faulty.mesh) == faulty.sides);
  }
  // Of welded flush blocks two may have a crack at one edge, at the same place.
  truth::Random draw(9);
  for (int i = 0; i < 300; ++i) {
    Faulty faulty(truth::flushBlocks(draw));
    for (int k = 0; k < 6; ++k) faulty.crack(random);
    INFO("flush blocks, round " << i);
    CHECK(sidesOf(faulty.mesh, true) == faulty.sides);
  }
  // Two triangles at one vertex are lost.
  Faulty torn(scenes::makeLump(1, 3, 0.4, 1));
  const std::uint32_t corner = torn.mesh.triangles[0].v[0];
  const auto isAtCorner = [&](const Triangle& t) { return std::ranges::find(t.v, corner) != std::end(t.v); };
  std::vector<std::size_t> around;
  for (std::size_t t = 0; t < torn.mesh.triangles.size(); ++t) {
    if (isAtCorner(torn.mesh.triangles[t])) around.push_back(t);
  }
  const auto shared = [&](std::size_t t, std::size_t u) {
    const Triangle &a = torn.mesh.triangles[t], &b = torn.mesh.triangles[u];
    return std::ranges::count_if(a.v, [&](std::uint32_t v) { return std::ranges::find(b.v, v) != std::end(b.v); });
  };
  int opposite = 0;
  for (const std::size_t t : around) {
    for (const std::size_t u : around) {
      if (t >= u || shared(t, u) != 1) continue;
      MeshArrays mesh = torn.mesh;
      mesh.triangles.erase(mesh.triangles.begin() + static_cast<std::ptrdiff_t>(u));
      mesh.triangles.erase(mesh.triangles.begin() + static_cast<std::ptrdiff_t>(t));
      CHECK(sidesOf(mesh) == std::vector<std::int8_t>(mesh.triangles.size(), 1));
      ++opposite;
    }
  }
  CHECK(opposite > 2);
}

TEST_CASE("sides after vertices have moved in place are those of a new mesh") {
  std::mt19937 random(4);
  int changes = 0;
  for (int i = 0; i < 60; ++i) {
    // A crack with vertices on both sides, some of which leave the edge, and come back. In the box nothing else is
    // open.
    Faulty faulty(turned(scenes::makeBox({1, 2, 3}, 3), 0.1 * i));
    faulty.crackTwice(random);
    if (i % 3 == 1) faulty.pierce(random);
    if (i % 3 == 2) faulty.mesh.triangles.resize(faulty.mesh.triangles.size() / 2);
    CollisionMesh mesh(buildTriMesh(faulty.mesh.input()).mesh, BuildStrategy::kSah);
    const std::vector<Vec3f> at = faulty.mesh.vertices;
    bool hadSides = !mesh.outwardSides().empty();
    for (int move = 0; move < 30; ++move) {
      const auto v = static_cast<std::uint32_t>(move % 2 == 0 ? at.size() - 1 - random() % 3 : random() % at.size());
      const Vec3f to = move % 4 < 2 ? otgAdd(at[v], Vec3f{0.03F, 0.01F, -0.02F}) : at[v];
      if (!mesh.moveSome(std::array{MovedVertex{v, to}})) continue;
      faulty.mesh.vertices[v] = to;
      INFO("round " << i << ", move " << move);
      CHECK(mesh.outwardSides() == sidesOf(faulty.mesh));
      changes += hadSides != !mesh.outwardSides().empty() ? 1 : 0;
      hadSides = !mesh.outwardSides().empty();
    }
  }
  CHECK(changes > 50);

  // A hole grows until it is too much of the surface. Then the far end of the body does.
  MeshArrays holed = scenes::makeBox({1, 1, 1}, 2);
  const Triangle hole = holed.triangles.back();
  holed.triangles.pop_back();
  while (!sidesOf(holed).empty()) {
    for (const std::uint32_t v : hole.v) holed.vertices[v] = otgScale(holed.vertices[v], 1.01F);
  }
  CollisionMesh mesh(buildTriMesh(holed.input()).mesh, BuildStrategy::kSah);
  CHECK(mesh.outwardSides().empty());
  const auto far = std::ranges::min_element(holed.vertices, {},
                                            [&](const Vec3f& v) { return otgDot(v, holed.vertices[hole.v[0]]); });
  *far = otgScale(*far, 1.3F);
  REQUIRE(mesh.moveSome(std::array{MovedVertex{static_cast<std::uint32_t>(far - holed.vertices.begin()), *far}}));
  CHECK(mesh.outwardSides().size() == holed.triangles.size());
}

TEST_CASE("meshes that have no inside, or whose inside is out, have no sides") {
  const MeshArrays box = scenes::makeBox({1, 1, 1}, 3);
  CHECK(sidesOf(box).empty());  // a solid needs none
  MeshArrays vessel = box, sheet = box, twoSided, inward = box, needles, stolen = box;
  std::erase_if(vessel.triangles, [&](const Triangle& t) {
    return box.vertices[t.v[0]].z > 0 && box.vertices[t.v[1]].z > 0 && box.vertices[t.v[2]].z > 0;
  });
  REQUIRE(vessel.triangles.size() < box.triangles.size());
  CHECK(sidesOf(vessel).empty());
  std::erase_if(sheet.triangles, [&](const Triangle& t) {
    return !(box.vertices[t.v[0]].z > 0 && box.vertices[t.v[1]].z > 0 && box.vertices[t.v[2]].z > 0);
  });
  CHECK(sidesOf(sheet).empty());
  twoSided = sheet;
  for (const Triangle& t : sheet.triangles) twoSided.triangles.push_back({{t.v[0], t.v[2], t.v[1]}});
  CHECK(sidesOf(twoSided).empty());
  for (Triangle& t : inward.triangles) std::swap(t.v[1], t.v[2]);
  CHECK(sidesOf(inward).empty());
  inward.triangles.pop_back();
  CHECK(sidesOf(inward).empty());
  for (std::uint32_t i = 0; i < 10; ++i) {
    const auto x = static_cast<float>(i);
    for (const Vec3f& v : {Vec3f{x, 0, 0}, Vec3f{x + 0.1F, 0, 0}, Vec3f{x, 0, 2}}) needles.vertices.push_back(v);
    needles.triangles.push_back({{3 * i, 3 * i + 1, 3 * i + 2}});
  }
  CHECK(sidesOf(needles).empty());
  stolen.triangles.erase(stolen.triangles.begin(), stolen.triangles.begin() + 2);  // a square hole
  CHECK(sidesOf(stolen).empty());

  // The mouths of vessels may have three edges, too.
  MeshArrays cup = scenes::makeTetrahedron({0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}),
             room = scenes::makeBox({1, 1, 1});
  cup.triangles.pop_back();
  CHECK(sidesOf(cup).empty());
  room.triangles.pop_back();
  CHECK(sidesOf(room).empty());
}
