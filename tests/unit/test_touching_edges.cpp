// SPDX-License-Identifier: BSD-3-Clause
// Surfaces that touch along edges are taken apart, so that meshes of cubes, tiles and blocks are solids.
#include "mesh/touching_edges.h"

#include <numbers>
#include <set>

#include "base/union_find.h"
#include "bvh/collision_mesh.h"
#include "support/catch.h"
#include "support/mesh_samples.h"
#include "truth/wild_bodies.h"

using namespace otg;
using namespace otg::samples;
using scenes::MeshArrays;

namespace {

/// Which cubes of a grid are full, with one empty layer around.
struct Grid {
  int size;
  std::vector<std::uint8_t> full;
  int count() const { return (size + 2) * (size + 2) * (size + 2); }
  bool isFull(int x, int y, int z) const { return full[static_cast<std::size_t>(number(x + 1, y + 1, z + 1))] != 0; }
  int number(int x, int y, int z) const { return x + (size + 2) * (y + (size + 2) * z); }
};

Grid randomGrid(int size, double part, std::mt19937& random) {
  Grid grid{size, {}};
  grid.full.assign(static_cast<std::size_t>(grid.count()), 0);
  std::bernoulli_distribution full(part);
  for (int z = 1; z <= size; ++z) {
    for (int y = 1; y <= size; ++y) {
      for (int x = 1; x <= size; ++x) grid.full[static_cast<std::size_t>(grid.number(x, y, z))] = full(random) ? 1 : 0;
    }
  }
  return grid;
}

/// How many surfaces there are between the full and the empty, found without a mesh. Full cubes hang together by faces,
/// empty ones also along edges. Between one of each there is one surface at most.
std::size_t surfacesOf(const Grid& grid) {
  UnionFind regions(static_cast<std::size_t>(grid.count()));
  const int across = grid.size + 2;
  const auto forNeighbours = [&](const auto& visit) {
    for (int i = 0; i < grid.count(); ++i) {
      const int at[3] = {i % across, i / across % across, i / (across * across)};
      for (int step = 0; step < 27; ++step) {
        const int by[3] = {step % 3 - 1, step / 3 % 3 - 1, step / 9 - 1};
        const int to[3] = {at[0] + by[0], at[1] + by[1], at[2] + by[2]};
        if (std::any_of(to, to + 3, [&](int k) { return k < 0 || k >= across; })) continue;
        visit(static_cast<std::uint32_t>(i), static_cast<std::uint32_t>(grid.number(to[0], to[1], to[2])),
              by[0] * by[0] + by[1] * by[1] + by[2] * by[2]);
      }
    }
  };
  forNeighbours([&](std::uint32_t i, std::uint32_t j, int apart) {
    if (grid.full[i] == grid.full[j] && apart <= (grid.full[i] != 0 ? 1 : 2)) regions.unite(i, j);
  });
  std::set<std::pair<std::uint32_t, std::uint32_t>> surfaces;
  forNeighbours([&](std::uint32_t i, std::uint32_t j, int apart) {
    if (apart == 1 && grid.full[i] != 0 && grid.full[j] == 0) surfaces.insert({regions.find(i), regions.find(j)});
  });
  return surfaces.size();
}

MeshArrays meshOf(const Grid& grid) {
  return scenes::makeCubes(grid.size, [&](int x, int y, int z) { return grid.isFull(x, y, z); });
}

/// Each vertex is a corner of one surface: its triangles hang together through edges with this vertex.
bool hasOneFanEach(const TriMesh& mesh) {
  const std::span<const Triangle> triangles = mesh.triangles();
  UnionFind corners(3 * triangles.size());
  for (std::uint32_t h = 0; h < 3 * triangles.size(); ++h) {
    const std::uint32_t twin = mesh.topology().twin[h];
    corners.unite(h, twin % 3 == 2 ? twin - 2 : twin + 1);
  }
  std::vector<std::uint32_t> fanOf(mesh.vertices().size(), kNone);
  for (std::uint32_t h = 0; h < 3 * triangles.size(); ++h) {
    std::uint32_t& fan = fanOf[triangles[h / 3].v[h % 3]];
    if (fan != kNone && fan != corners.find(h)) return false;
    fan = corners.find(h);
  }
  return true;
}

MeshArrays turned(const MeshArrays& mesh, std::mt19937& random) {
  std::uniform_real_distribution<double> angle(-std::numbers::pi, std::numbers::pi);
  const double a = angle(random), b = angle(random), ca = std::cos(a), sa = std::sin(a), cb = std::cos(b),
               sb = std::sin(b);
  return scenes::transformed(mesh, {{ca, -sa * cb, sa * sb, sa, ca * cb, -ca * sb, 0, sb, cb}, {0.3, -0.1, 0.7}});
}

/// By the caller's numbers: for each half-edge its neighbour, and for each corner the first one at the same point.
std::vector<std::uint32_t> surfaceOf(const TriMesh& mesh) {
  const auto own = [&](std::uint32_t callers) { return 3 * mesh.triangleOfCaller(callers / 3) + callers % 3; };
  std::vector<std::uint32_t> out, first(mesh.vertices().size(), kNone);
  for (std::uint32_t c = 0; c < 3 * mesh.triangleCount(); ++c) {
    const std::uint32_t twin = mesh.topology().twin[own(c)];
    out.push_back(twin == kNone ? kNone : 3 * mesh.callerTriangle(twin / 3) + twin % 3);
    std::uint32_t& corner = first[mesh.topology().weld[mesh.triangles()[own(c) / 3].v[c % 3]]];
    if (corner == kNone) corner = c;
    out.push_back(corner);
  }
  return out;
}

}  // namespace

TEST_CASE("surfaces of cubes are as many as regions of full and empty cubes say") {
  std::mt19937 random(1);
  int touching = 0;
  for (int i = 0; i < 300; ++i) {
    INFO("grid " << i);
    const Grid grid = randomGrid(2 + i % 5, 0.2 + 0.1 * (i % 7), random);
    const MeshArrays arrays = meshOf(grid);
    if (arrays.triangles.empty()) continue;
    const MeshResult built = buildTriMesh(arrays.input());
    REQUIRE(built.mesh != nullptr);
    const TriMesh& mesh = *built.mesh;
    const auto cubes = std::count(grid.full.begin(), grid.full.end(), 1);
    REQUIRE(mesh.report().solid);
    CHECK(mesh.topology().componentCount() == surfacesOf(grid));
    CHECK(mesh.massProperties().volume == Approx(static_cast<double>(cubes)).epsilon(1e-12));
    CHECK(std::ranges::count(mesh.topology().twin, kNone) == 0);
    if (mesh.report().nonManifoldEdges == 0) continue;
    ++touching;
    // The report tells of the mesh as it was given.
    CHECK_FALSE(mesh.report().closed);
    CHECK(mesh.report().vertices == arrays.vertices.size());
    CHECK(hasOneFanEach(mesh));
  }
  CHECK(touching > 200);
}

TEST_CASE("an update of surfaces that touch, meet and part makes the mesh that a build makes") {
  std::mt19937 random(2);
  std::uniform_real_distribution<float> unit(-0.2F, 0.2F);
  for (int i = 0; i < 100; ++i) {
    INFO("grid " << i);
    // Of the same triangles: cubes in a grid, bent ones, mirrored ones, which face inward, and one that lies flat.
    MeshArrays touching = meshOf(randomGrid(3 + i % 3, 0.5, random)), bent = touching, flat = touching;
    MeshArrays mirrored = touching;
    for (Vec3f& v : bent.vertices) v = {v.x + unit(random), v.y + unit(random), v.z + unit(random)};
    for (Vec3f& v : mirrored.vertices) v.z = -v.z;
    for (Vec3f& v : flat.vertices) v.z = 0;
    for (const MeshOrder order : {MeshOrder::kInput, MeshOrder::kLocal}) {
      const auto build = [&](const MeshArrays& arrays) { return buildTriMesh(arrays.input(), {}, order).mesh; };
      for (const auto& [from, to] : {std::pair(&touching, &bent), std::pair(&bent, &touching),
                                     std::pair(&flat, &touching), std::pair(&touching, &flat), std::pair(&flat, &bent),
                                     std::pair(&mirrored, &bent), std::pair(&bent, &mirrored)}) {
        const MeshPtr before = build(*from), moved = moveVertices(*before, to->input()).mesh, built = build(*to);
        REQUIRE(moved != nullptr);
        CHECK(moved->report().solid == built->report().solid);
        CHECK(moved->report().nonManifoldEdges == built->report().nonManifoldEdges);
        CHECK(moved->report().vertices == built->report().vertices);
        CHECK(moved->vertices().size() == built->vertices().size());
        CHECK(moved->isNumberedAs(*built));
        CHECK(surfaceOf(*moved) == surfaceOf(*built));
        CHECK(moved->contentHash() == built->contentHash());
      }
    }
  }
}

TEST_CASE("a move of some vertices in place leaves surfaces that touch to an update") {
  const MeshArrays cubes = scenes::makeCubes(2, [](int x, int y, int z) { return z == 0 && x == y; });
  CollisionMesh mesh(buildTriMesh(cubes.input()).mesh, BuildStrategy::kSah);
  CHECK_FALSE(mesh.moveSome(std::vector<MovedVertex>{{0, {-0.1F, 0, 0}}}));
}

TEST_CASE("blocks with flush faces are a solid, with shared vertices, turned and cut up") {
  std::mt19937 random(3);
  truth::Random draw(3);
  int touching = 0;
  for (int i = 0; i < 200; ++i) {
    INFO("blocks " << i);
    const MeshArrays blocks = turned(truth::flushBlocks(draw), random);
    const MeshPtr apart = buildTriMesh(blocks.input()).mesh;
    REQUIRE(apart->report().solid);
    const MeshPtr welded = buildTriMesh(blocks.input(), RepairOptions{.weldVertices = true}).mesh;
    if (welded->report().nonManifoldEdges > 0) ++touching;
    CHECK(welded->report().solid);
    CHECK(welded->massProperties().volume == Approx(apart->massProperties().volume).epsilon(1e-6));
  }
  CHECK(touching > 50);
}

TEST_CASE("a stack of flush boxes is a solid, turned, whichever way its faces are cut") {
  // Edges inside have four flush pairs of faces, whose triangles come in any order.
  std::mt19937 random(6);
  for (int i = 0; i < 300; ++i) {
    INFO("stack " << i);
    std::vector<MeshArrays> boxes;
    const int n = 2 + i % 4;
    for (int k = 0; k < n * n * n; ++k) {
      MeshArrays box = scenes::makeBox({1, 1, 1});
      // A box and its mirror image: then the diagonals of two faces in one place cross.
      if (k % 2 != 0) {
        for (Vec3f& v : box.vertices) v.x = -v.x;
        for (Triangle& t : box.triangles) std::swap(t.v[1], t.v[2]);
      }
      const Vec3d place{1.0 * (k % n), 1.0 * (k / n % n), 1.0 * (k / (n * n))};
      boxes.push_back(scenes::transformed(box, {{1, 0, 0, 0, 1, 0, 0, 0, 1}, place}));
    }
    const MeshArrays stack = turned(scenes::merge(boxes), random);
    const MeshPtr mesh = buildTriMesh(stack.input(), RepairOptions{.weldVertices = true}).mesh;
    CHECK(mesh->report().nonManifoldEdges > 0);
    CHECK(mesh->report().solid);
    CHECK(mesh->topology().componentCount() == boxes.size());
  }
}

TEST_CASE("what fills a cavity or a hole, and what is its own other side, is known in any order of triangles") {
  std::mt19937 random(7);
  const auto isHollow = [](int x, int y, int z) { return x != 1 || y != 1 || z != 1; };
  const auto isPierced = [](int x, int y, int) { return x != 1 || y != 1; };
  const auto isWithin = [](int x, int y, int z) { return x == 1 && y == 1 && z == 1; };
  const auto isPeg = [](int x, int y, int) { return x == 1 && y == 1; };
  MeshArrays filled = scenes::merge({scenes::makeCubes(3, isHollow), scenes::makeCubes(3, isWithin)});
  MeshArrays plugged = scenes::merge({scenes::makeCubes(3, isPierced), scenes::makeCubes(3, isPeg)});
  MeshArrays twoSided = scenes::makeBox({1, 1, 1}, 2);
  for (std::size_t t = 0, count = twoSided.triangles.size(); t < count; ++t) {
    const Triangle& front = twoSided.triangles[t];
    twoSided.triangles.push_back({{front.v[0], front.v[2], front.v[1]}});
  }
  for (int i = 0; i < 100; ++i) {
    INFO("order " << i);
    for (const auto& [from, isSolid] :
         {std::pair(&filled, true), std::pair(&plugged, true), std::pair(&twoSided, false)}) {
      MeshArrays mesh = i % 2 == 0 ? *from : turned(*from, random);
      std::shuffle(mesh.triangles.begin(), mesh.triangles.end(), random);
      CHECK(buildTriMesh(mesh.input()).report.solid == isSolid);
      CHECK(buildTriMesh(mesh.input(), RepairOptions{.weldVertices = true}).report.solid == isSolid);
    }
  }
}

TEST_CASE("sheets with two sides and fins have no inside, however many triangles their edges have") {
  std::mt19937 random(4);
  const MeshArrays ground =
      turned(scenes::makeGround(10, 1, 8, [](double x, double y) { return std::sin(x) * std::cos(0.7 * y); }), random);
  MeshArrays open = ground;
  std::erase_if(open.triangles, [&](const Triangle& t) { return t.v[0] % 3 == 0; });
  MeshArrays twoSided = open;
  for (const Triangle& t : open.triangles) twoSided.triangles.push_back({{t.v[0], t.v[2], t.v[1]}});
  const MeshPtr sheet = buildTriMesh(twoSided.input()).mesh;
  CHECK(sheet->report().nonManifoldEdges > 0);
  CHECK(sheet->report().boundaryEdges == 0);
  CHECK_FALSE(sheet->report().solid);

  // Two triangles that lie on each other and face the same way: there is no telling what is inside.
  MeshArrays twice = scenes::makeBox({1, 1, 1});
  const std::size_t count = twice.triangles.size();
  for (std::size_t t = 0; t < count; ++t) twice.triangles.push_back(twice.triangles[t]);
  const MeshPtr doubled = buildTriMesh(twice.input()).mesh;
  CHECK(doubled->report().nonManifoldEdges == doubled->report().edges);
  CHECK_FALSE(doubled->report().solid);
}

TEST_CASE("whatever triangles meet at an edge, a solid's surfaces are closed and a shell is as it was given") {
  // Tetrahedra and triangles on 27 places: they share edges, lie on each other, and go through each other.
  std::mt19937 random(5);
  std::uniform_int_distribution<std::uint32_t> place(0, 26);
  int solids = 0, touching = 0;
  for (int i = 0; i < 3000; ++i) {
    INFO("mesh " << i);
    MeshArrays mesh;
    for (int k = 0; k < 27; ++k) {
      mesh.vertices.push_back({static_cast<float>(k % 3), static_cast<float>(k / 3 % 3), static_cast<float>(k / 9)});
    }
    const int bodies = 1 + i % 7;
    for (int k = 0; k < bodies; ++k) {
      std::uint32_t v[4];
      for (std::uint32_t& corner : v) corner = place(random);
      const Vec3f &p = mesh.vertices[v[0]], &q = mesh.vertices[v[1]], &r = mesh.vertices[v[2]];
      const float up = otgDot(otgCross(otgSub(q, p), otgSub(r, p)), otgSub(mesh.vertices[v[3]], p));
      if (up == 0) continue;
      if (up < 0) std::swap(v[0], v[1]);
      for (const Triangle& t : {Triangle{{0, 2, 1}}, Triangle{{0, 1, 3}}, Triangle{{1, 2, 3}}, Triangle{{2, 0, 3}}}) {
        mesh.triangles.push_back({{v[t.v[0]], v[t.v[1]], v[t.v[2]]}});
      }
    }
    if (i % 5 == 0) mesh.triangles.push_back({{i % 9u, 9 + place(random) % 9, 18 + place(random) % 9}});
    const MeshPtr built = buildTriMesh(mesh.input()).mesh;
    REQUIRE(built != nullptr);
    CHECK(built->triangleCount() == mesh.triangles.size());
    if (built->report().nonManifoldEdges > 0) ++touching;
    if (!built->report().solid) {
      CHECK(built->vertices().size() == mesh.vertices.size());
      continue;
    }
    ++solids;
    CHECK(std::ranges::count(built->topology().twin, kNone) == 0);
    double volume = 0;
    for (const double of : built->topology().componentVolume) volume += of;
    CHECK(volume == Approx(built->massProperties().volume).margin(1e-9));
  }
  CHECK(solids > 1000);
  CHECK(touching > 600);
}
