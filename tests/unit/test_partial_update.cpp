// SPDX-License-Identifier: BSD-3-Clause
// Moving some vertices in place: the mesh, its tree and what is derived from it are those of moving all, to the last
// bit.
#include <array>
#include <cmath>
#include <cstring>
#include <random>

#include "bvh/cooked_mesh.h"
#include "ode/geom/geom_class.h"
#include "support/catch.h"
#include "support/mesh_samples.h"
#include "support/ode_world.h"

using namespace otg;
using namespace otg::test;

namespace {

template <class Elements>
bool sameBytes(const Elements& a, const Elements& b) {
  using T = typename Elements::value_type;
  return a.size() == b.size() && (a.empty() || std::memcmp(a.data(), b.data(), a.size() * sizeof(T)) == 0);
}

bool sameAdjacency(const Adjacency& a, const Adjacency& b) {
  if (a.clusters.size() != b.clusters.size()) return false;
  for (std::size_t i = 0; i + 1 < a.clusters.size(); ++i) {  // member by member: there are bytes between them
    const Adjacency::Cluster &x = a.clusters[i], &y = b.clusters[i];
    if (!(x.lo == y.lo) || !(x.hi == y.hi) || x.sum.area != y.sum.area || x.sum.vector.x != y.sum.vector.x ||
        x.sum.vector.y != y.sum.vector.y || x.sum.vector.z != y.sum.vector.z || x.moment != y.moment ||
        x.anyFlat != y.anyFlat || x.anyCorner != y.anyCorner) {
      return false;
    }
  }
  return sameBytes(a.normal, b.normal) && sameBytes(a.area, b.area) && sameBytes(a.star, b.star) &&
         sameBytes(a.edgeKind, b.edgeKind) && a.hollowEdges == b.hollowEdges && a.flatEdges == b.flatEdges &&
         sameBytes(a.flatVertex, b.flatVertex) && sameBytes(a.halfEdges, b.halfEdges) &&
         sameBytes(a.clusterVertices, b.clusterVertices);
}

/// A mesh of the same kind as the library's own: triangles sorted for locality, vertices merged.
std::shared_ptr<CollisionMesh> makeMesh(const scenes::MeshArrays& arrays, const RepairOptions& repair = {}) {
  return std::make_shared<CollisionMesh>(buildTriMesh(arrays.input(), repair, MeshOrder::kLocal).mesh,
                                         BuildStrategy::kSah);
}

std::shared_ptr<CollisionMesh> movedWhole(const CollisionMesh& mesh, const std::vector<MovedVertex>& moved) {
  std::vector<Vec3f> vertices(mesh.mesh().inputVertexCount());
  for (std::uint32_t v = 0; v < mesh.mesh().vertices().size(); ++v) {
    vertices[mesh.mesh().callerVertex(v)] = mesh.mesh().vertices()[v];
  }
  for (const MovedVertex& m : moved) vertices[mesh.mesh().callerVertex(m.vertex)] = m.to;
  MeshInput input;
  input.vertices = vertices.data();
  input.vertexCount = vertices.size();
  const MeshResult result = moveVertices(mesh.mesh(), input);
  REQUIRE(result.mesh != nullptr);
  return std::make_shared<CollisionMesh>(result.mesh, mesh);
}

void touchAll(const CollisionMesh& mesh) {
  mesh.wide();
  mesh.noLeaf();
  mesh.quantized();
  mesh.adjacency();
  mesh.mesh().contentHash();
}

void checkSame(const CollisionMesh& some, const CollisionMesh& all) {
  REQUIRE((cookMesh(some) == cookMesh(all)));  // in brackets: nobody wants to see the bytes
  REQUIRE(sameAdjacency(some.adjacency(), all.adjacency()));
  REQUIRE(some.mesh().contentHash() == all.mesh().contentHash());
  REQUIRE(validateTree(some.tree(), some.mesh()) == "");
  REQUIRE(validateLayout(some.wide(), some.mesh()) == "");
  REQUIRE(validateLayout(some.noLeaf(), some.mesh()) == "");
  REQUIRE(validateLayout(some.quantized(), some.mesh()) == "");
}

/// Moves that tear no points apart: all vertices of a point go to the same place.
std::vector<MovedVertex> drawMoves(const TriMesh& mesh, double part, float reach, std::mt19937& random) {
  std::uniform_real_distribution<float> unit(-1, 1);
  std::uniform_real_distribution<double> chance(0, 1);
  const auto count = static_cast<std::uint32_t>(mesh.vertices().size());
  std::vector<Vec3f> by(count, {0, 0, 0});
  std::vector<std::uint8_t> moves(count, 0);
  std::vector<MovedVertex> moved;
  for (std::uint32_t v = 0; v < count; ++v) {
    const std::uint32_t point = mesh.topology().weld[v];
    if (point == v) {
      moves[v] = chance(random) < part;
      by[v] = {reach * unit(random), reach * unit(random), reach * unit(random)};
    }
    if (moves[point]) moved.push_back({v, otgAdd(mesh.vertices()[v], by[point])});
  }
  std::shuffle(moved.begin(), moved.end(), random);
  return moved;
}

scenes::MeshArrays twoComponents() {
  scenes::MeshArrays two = scenes::makeLump(1, 3, 0.2, 4);
  const scenes::MeshArrays other = scenes::makeSphere(0.3, 2);
  const auto first = static_cast<std::uint32_t>(two.vertices.size());
  for (const Vec3f& v : other.vertices) two.vertices.push_back({v.x + 2, v.y, v.z});
  for (const Triangle& t : other.triangles) two.triangles.push_back({{t.v[0] + first, t.v[1] + first, t.v[2] + first}});
  return two;
}

/// The upper side of a ground: open.
scenes::MeshArrays openSheet() {
  const scenes::MeshArrays ground =
      scenes::makeGround(10, 1, 24, [](double x, double y) { return std::sin(x) * std::cos(y) / 4; });
  scenes::MeshArrays sheet;
  sheet.vertices = ground.vertices;
  for (const Triangle& t : ground.triangles) {
    if (ground.vertices[t.v[0]].z > -0.4f && ground.vertices[t.v[1]].z > -0.4f && ground.vertices[t.v[2]].z > -0.4f)
      sheet.triangles.push_back(t);
  }
  return sheet;
}

scenes::MeshArrays soupOf(const scenes::MeshArrays& mesh) {
  scenes::MeshArrays soup;
  for (const Triangle& t : mesh.triangles) {
    const auto n = static_cast<std::uint32_t>(soup.vertices.size());
    for (const std::uint32_t v : t.v) soup.vertices.push_back(mesh.vertices[v]);
    soup.triangles.push_back({{n, n + 1, n + 2}});
  }
  return soup;
}

}  // namespace

TEST_CASE("moving some vertices in place gives the bytes of moving all of them") {
  std::mt19937 random(12);
  const std::vector<std::pair<const char*, scenes::MeshArrays>> shapes = {
      {"lump", scenes::makeLump(1, 4, 0.2, 7)},     {"box", scenes::makeBox({1, 2, 3})},
      {"torus", scenes::makeTorus(1, 0.4, 40, 20)}, {"two components", twoComponents()},
      {"soup", soupOf(scenes::makeSphere(1, 3))},   {"terrain", openSheet()}};
  int inPlace = 0;
  for (const auto& [name, arrays] : shapes) {
    INFO(name);
    for (const double part : {0.01, 0.2, 1.0}) {
      const auto mesh = makeMesh(arrays);
      for (int step = 0; step < 6; ++step) {
        const auto moved = drawMoves(mesh->mesh(), part, 0.004f * mesh->mesh().radius(), random);
        if (step > 0) touchAll(*mesh);  // once before anything is derived
        const auto whole = movedWhole(*mesh, moved);
        const std::weak_ptr<const void> before = mesh->lifetime();
        REQUIRE(mesh->moveSome(moved));
        CHECK(before.expired());
        ++inPlace;
        checkSame(*mesh, *whole);
        REQUIRE(sahCost(mesh->tree()) == sahCost(whole->tree()));
      }
    }
  }
  CHECK(inPlace == 6 * 3 * 6);
}

TEST_CASE("the tree is built anew in place when refitting has made it too bad") {
  const auto mesh = makeMesh(scenes::makeSphere(1, 4));
  touchAll(*mesh);
  const std::vector<Vec3f> rest(mesh->mesh().vertices().begin(), mesh->mesh().vertices().end());
  int builds = 0;
  for (int step = 1; step <= 25; ++step) {
    std::vector<MovedVertex> moved;
    for (std::uint32_t v = 0; v < rest.size(); ++v) {
      const float angle = 0.4f * static_cast<float>(step) * rest[v].z, c = std::cos(angle), s = std::sin(angle);
      moved.push_back({v, {rest[v].x * c - rest[v].y * s, rest[v].x * s + rest[v].y * c, rest[v].z}});
    }
    const auto whole = movedWhole(*mesh, moved);
    const BinaryTree before = mesh->tree();
    REQUIRE(mesh->moveSome(moved));
    builds += std::any_of(before.nodes.begin(), before.nodes.end(), [&, i = std::size_t{0}](const BvhNode& n) mutable {
      return n.child != mesh->tree().nodes[i++].child;
    });
    checkSame(*mesh, *whole);
  }
  CHECK(builds >= 1);
  CHECK(builds <= 10);
}

TEST_CASE("what cannot be done in place is refused and changes nothing") {
  const auto refuses = [](const scenes::MeshArrays& arrays, const std::vector<MovedVertex>& moved) {
    const auto mesh = makeMesh(arrays);
    const std::vector<unsigned char> before = cookMesh(*mesh);
    CHECK_FALSE(mesh->moveSome(moved));
    REQUIRE((cookMesh(*mesh) == before));
    REQUIRE(mesh->moveSome(std::vector<MovedVertex>{{0, otgScale(mesh->mesh().vertices()[0], 1.001f)}}) ==
            (mesh->mesh().vertices().size() == 8));  // of a soup's point one vertex alone cannot move
  };
  const scenes::MeshArrays box = scenes::makeBox({1, 1, 1});
  const auto mesh = makeMesh(box);
  const auto at = [&](std::uint32_t v) { return mesh->mesh().vertices()[v]; };
  refuses(box, {{0, at(1)}});                           // two points meet
  refuses(box, {{0, otgAdd(at(0), Vec3f{40, 0, 0})}});  // the middle wanders off
  refuses(box, {{0, {0.5f * (at(1).x + at(2).x), 0.5f * (at(1).y + at(2).y), 0.5f * (at(1).z + at(2).z)}},
                {3, {0.5f * (at(1).x + at(2).x), 0.5f * (at(1).y + at(2).y), 0.5f * (at(1).z + at(2).z)}}});
  std::vector<MovedVertex> inside;
  for (std::uint32_t v = 0; v < 8; ++v) inside.push_back({v, {-at(v).x, at(v).y, at(v).z}});
  refuses(box, inside);  // turns inside out
  refuses(soupOf(box), {{5, {0.1f, 0.2f, 0.3f}}});
  const auto shared = makeMesh(box);
  const std::shared_ptr<const TriMesh> other = shared->meshPtr();
  CHECK_FALSE(shared->moveSome(std::vector<MovedVertex>{{0, otgScale(at(0), 1.001f)}}));
}

TEST_CASE("no vertex moves in place to where another one lies, wherever that is kept") {
  const auto mesh = makeMesh(scenes::makeLump(1, 3, 0.2, 4));
  const auto at = [&](std::uint32_t v) { return mesh->mesh().vertices()[v]; };
  const auto distance = [&](std::uint32_t v, std::uint32_t u) {
    return std::hypot(at(u).x - at(v).x, at(u).y - at(v).y, at(u).z - at(v).z);
  };
  const auto areNeighbours = [&](std::uint32_t v, std::uint32_t u) {
    return std::ranges::any_of(mesh->mesh().triangles(), [&](const Triangle& t) {
      return std::ranges::find(t.v, v) != std::end(t.v) && std::ranges::find(t.v, u) != std::end(t.v);
    });
  };
  for (std::uint32_t v = 0; v < 64; ++v) {
    std::uint32_t nearest = kNone;
    for (std::uint32_t u = 0; u < mesh->mesh().vertices().size(); ++u) {
      if (u == v || areNeighbours(v, u)) continue;
      if (nearest == kNone || distance(v, u) < distance(v, nearest)) nearest = u;
    }
    const Vec3f beside = otgAdd(at(nearest), otgScale(otgSub(at(v), at(nearest)), 0.01f));
    INFO(v << " to " << nearest);
    CHECK_FALSE(makeMesh(scenes::makeLump(1, 3, 0.2, 4))->moveSome(std::vector<MovedVertex>{{v, at(nearest)}}));
    CHECK(makeMesh(scenes::makeLump(1, 3, 0.2, 4))->moveSome(std::vector<MovedVertex>{{v, beside}}));
  }
}

TEST_CASE("two vertices may change places, and one may be named twice") {
  const scenes::MeshArrays lump = scenes::makeLump(1, 3, 0.2, 4);
  const auto mesh = makeMesh(lump);
  const Vec3f a = mesh->mesh().vertices()[10], b = mesh->mesh().vertices()[11];
  const std::vector<MovedVertex> swap = {{10, b}, {11, a}};
  const auto whole = movedWhole(*mesh, swap);
  REQUIRE(mesh->moveSome(std::vector<MovedVertex>{{10, {9, 9, 9}}, {11, a}, {10, b}}));
  checkSame(*mesh, *whole);
}

TEST_CASE("contacts after updating a range or a list equal those after updating all, byte for byte") {
  const OdeSession session;
  std::mt19937 random(5);
  std::uniform_real_distribution<float> unit(-1, 1);
  scenes::MeshArrays lump = scenes::makeLump(1, 4, 0.15, 11);
  {  // numbers that have nothing to do with places, and a vertex that repair merges with another
    std::vector<std::uint32_t> order(lump.vertices.size());
    for (std::uint32_t i = 0; i < order.size(); ++i) order[i] = i;
    std::shuffle(order.begin(), order.end(), random);
    scenes::MeshArrays shuffled = lump;
    for (std::uint32_t i = 0; i < order.size(); ++i) shuffled.vertices[order[i]] = lump.vertices[i];
    for (Triangle& t : shuffled.triangles)
      for (std::uint32_t& v : t.v) v = order[v];
    shuffled.vertices.push_back(shuffled.vertices[3]);
    shuffled.triangles[7].v[0] =
        shuffled.triangles[7].v[0] == 3 ? static_cast<std::uint32_t>(order.size()) : shuffled.triangles[7].v[0];
    lump = shuffled;
  }
  const auto count = static_cast<int>(lump.vertices.size());
  for (const int repair : {static_cast<int>(dGPUTRIMESH_REPAIR_NONE), static_cast<int>(dGPUTRIMESH_REPAIR_ALL)}) {
    const auto make = [&] {
      const dGpuTriMeshDataID data = dGpuTriMeshDataCreate();
      dGpuTriMeshBuildParams params;
      dGpuTriMeshBuildParamsInit(&params);
      params.vertices = lump.vertices.data();
      params.vertex_count = count;
      params.indices = lump.triangles.data();
      params.index_count = static_cast<int>(3 * lump.triangles.size());
      params.repair = repair;
      REQUIRE(dGpuTriMeshDataBuild(data, &params) == dGPUTRIMESH_OK);
      return data;
    };
    const Data floor(scenes::makeBox({4, 4, 1}));
    const dGpuTriMeshDataID some = make(), all = make();
    const Geom ground(floor), groundToo(floor);
    const dGeomID a = dCreateGpuTriMesh(nullptr, some), b = dCreateGpuTriMesh(nullptr, all);
    std::vector<Vec3f> now = lump.vertices;
    std::size_t seen = 0;
    for (int step = 0; step < 24; ++step) {
      std::vector<int> numbers;
      std::vector<Vec3f> places;
      std::vector<double> doubles;
      const int first = static_cast<int>(random() % static_cast<unsigned>(count - 40));
      for (int i = 0; i < 40; ++i) {
        const int v = step % 2 == 0 ? first + i : static_cast<int>(random() % static_cast<unsigned>(count));
        Vec3f& p = now[static_cast<std::size_t>(v)];
        p = {p.x + 0.01f * unit(random), p.y + 0.01f * unit(random), p.z + 0.01f * unit(random)};
        if (v == 3 || v == count - 1) now[3] = now.back() = p;
        numbers.push_back(v);
        places.push_back(p);
      }
      if (step % 2 != 0) {  // both vertices of the double one
        for (const int v : {3, count - 1}) {
          numbers.push_back(v);
          places.push_back(now[static_cast<std::size_t>(v)]);
        }
      }
      for (const Vec3f& p : places) doubles.insert(doubles.end(), {p.x, p.y, p.z});
      const auto n = static_cast<int>(places.size());
      const int status = step % 4 == 0   ? dGpuTriMeshDataUpdateRangeSingle(some, places.data(), 0, first, n)
                         : step % 4 == 1 ? dGpuTriMeshDataUpdateListSingle(some, places.data(), 0, numbers.data(), n)
                         : step % 4 == 2 ? dGpuTriMeshDataUpdateRangeDouble(some, doubles.data(), 24, first, n)
                                         : dGpuTriMeshDataUpdateListDouble(some, doubles.data(), 0, numbers.data(), n);
      REQUIRE(status == dGPUTRIMESH_OK);
      REQUIRE(dGpuTriMeshDataUpdateVerticesSingle(all, now.data(), 0, count) == dGPUTRIMESH_OK);
      dGpuTriMeshParams params;
      dGpuTriMeshParamsInit(&params);
      params.traversal = step % 4;
      params.contact_model = step % 3 == 0 ? dGPUTRIMESH_CONTACTS_PAIRWISE : dGPUTRIMESH_CONTACTS_AUTO;
      for (const dGeomID g : {a, b}) {
        dGeomGpuTriMeshSetParams(g, &params);
        dGeomSetPosition(g, 0.1, 0.2, 1.35);
      }
      auto wanted = test::collide(groundToo.id, b), given = test::collide(ground.id, a);
      for (dContactGeom& c : wanted) {
        c.g1 = ground.id;
        c.g2 = a;
      }
      REQUIRE(sameContacts(given, wanted));
      seen += given.size();
    }
    CHECK(seen > 24);
    dGeomDestroy(a);
    dGeomDestroy(b);
    dGpuTriMeshDataDestroy(some);
    dGpuTriMeshDataDestroy(all);
  }
}

TEST_CASE("errors of partial updates leave the mesh as it is") {
  const Data box(scenes::makeBox({1, 1, 1}));
  const auto bytesOf = [&] {
    std::vector<unsigned char> bytes(dGpuTriMeshDataCook(box.id, nullptr, 0));
    dGpuTriMeshDataCook(box.id, bytes.data(), bytes.size());
    return bytes;
  };
  const std::vector<unsigned char> before = bytesOf();
  Vec3f places[3] = {{1, 2, 3}, {2, 3, 4}, {3, 4, 5}};
  const int wrong[3] = {0, 8, 1}, negative[3] = {0, -1, 1};
  CHECK(dGpuTriMeshDataUpdateRangeSingle(box.id, places, 0, 6, 3) == dGPUTRIMESH_ERROR_ARGUMENT);
  CHECK(dGpuTriMeshDataUpdateRangeSingle(box.id, places, 0, -1, 3) == dGPUTRIMESH_ERROR_ARGUMENT);
  CHECK(dGpuTriMeshDataUpdateRangeSingle(box.id, places, 0, 9, 0) == dGPUTRIMESH_ERROR_ARGUMENT);
  CHECK(dGpuTriMeshDataUpdateRangeSingle(box.id, places, 0, 0, -1) == dGPUTRIMESH_ERROR_ARGUMENT);
  CHECK(dGpuTriMeshDataUpdateRangeSingle(box.id, places, 4, 0, 3) == dGPUTRIMESH_ERROR_ARGUMENT);
  CHECK(dGpuTriMeshDataUpdateRangeSingle(box.id, nullptr, 0, 0, 3) == dGPUTRIMESH_ERROR_MESH);
  CHECK(dGpuTriMeshDataUpdateRangeDouble(nullptr, places, 0, 0, 1) == dGPUTRIMESH_ERROR_ARGUMENT);
  CHECK(dGpuTriMeshDataUpdateListSingle(box.id, places, 0, wrong, 3) == dGPUTRIMESH_ERROR_ARGUMENT);
  CHECK(dGpuTriMeshDataUpdateListSingle(box.id, places, 0, negative, 3) == dGPUTRIMESH_ERROR_ARGUMENT);
  CHECK(dGpuTriMeshDataUpdateListDouble(box.id, places, 0, nullptr, 3) == dGPUTRIMESH_ERROR_ARGUMENT);
  places[1].y = std::nanf("");
  CHECK(dGpuTriMeshDataUpdateRangeSingle(box.id, places, 0, 0, 3) == dGPUTRIMESH_ERROR_MESH);
  CHECK(std::string(dGpuTriMeshDataGetErrorString(box.id)) != "");
  CHECK(bytesOf() == before);
  CHECK(dGpuTriMeshDataUpdateRangeSingle(box.id, nullptr, 0, 8, 0) == dGPUTRIMESH_OK);
  CHECK(std::string(dGpuTriMeshDataGetErrorString(box.id)) == "");
  CHECK(bytesOf() == before);
  const dGpuTriMeshDataID empty = dGpuTriMeshDataCreate();
  CHECK(dGpuTriMeshDataUpdateRangeSingle(empty, nullptr, 0, 0, 0) == dGPUTRIMESH_ERROR_ARGUMENT);
  dGpuTriMeshDataDestroy(empty);
}

TEST_CASE("contacts that were prefetched, and batches, are not those of a mesh that has moved since") {
  const OdeSession session;
  scenes::MeshArrays lump = scenes::makeLump(1, 3, 0.15, 11);
  const Data data(lump), floor(scenes::makeBox({4, 4, 1}));
  const dSpaceID space = dSimpleSpaceCreate(nullptr);
  const dGeomID ground = dCreateGpuTriMesh(space, floor.id), ball = dCreateGpuTriMesh(space, data.id);
  for (const dGeomID g : {ground, ball}) {
    dGpuTriMeshParams params;
    dGpuTriMeshParamsInit(&params);
    params.history = dGPUTRIMESH_HISTORY_OFF;
    dGeomGpuTriMeshSetParams(g, &params);
  }
  dGeomSetPosition(ball, 0, 0, 1.4);
  const auto count = static_cast<int>(lump.vertices.size());
  for (int step = 0; step < 4; ++step) {
    REQUIRE(dGpuTriMeshPrefetch(space) >= 0);
    const dGpuTriMeshPair pair = {ground, ball};
    const dGpuTriMeshBatchID batch = dGpuTriMeshBatchSubmit(&pair, 1, 64);
    REQUIRE(batch != nullptr);
    for (Vec3f& v : lump.vertices) v.z -= 0.003f;
    REQUIRE(dGpuTriMeshDataUpdateRangeSingle(data.id, lump.vertices.data(), 0, 0, count) == dGPUTRIMESH_OK);
    const auto contacts = test::collide(ground, ball);
    const Data fresh(lump);
    const dGeomID other = dCreateGpuTriMesh(nullptr, fresh.id);
    dGeomSetPosition(other, 0, 0, 1.4);
    dReal deepest = 0, wanted = 0;
    for (const dContactGeom& c : contacts) deepest = std::max(deepest, c.depth);
    for (const dContactGeom& c : test::collide(ground, other)) wanted = std::max(wanted, c.depth);
    CHECK(deepest == Approx(wanted).epsilon(1e-5));
    dGeomDestroy(other);
    dGpuTriMeshBatchDestroy(batch);
  }
  dSpaceDestroy(space);
}

TEST_CASE("one of several closed parts moves about, into another one, through it and out again") {
  // A ball, and small ones beside it.
  constexpr std::uint32_t kParts = 6;
  scenes::MeshArrays arrays = scenes::makeLump(1, 3, 0.1, 1);
  std::vector<std::uint32_t> first{0, static_cast<std::uint32_t>(arrays.vertices.size())};
  for (std::uint32_t part = 1; part < kParts; ++part) {
    const scenes::MeshArrays small = scenes::makeLump(0.2, 2, 0.1, part);
    for (Vec3f v : small.vertices) {
      v.x += 3.0f * static_cast<float>(part);
      arrays.vertices.push_back(v);
    }
    for (Triangle t : small.triangles) {
      for (std::uint32_t& v : t.v) v += first.back();
      arrays.triangles.push_back(t);
    }
    first.push_back(static_cast<std::uint32_t>(arrays.vertices.size()));
  }
  std::shared_ptr<CollisionMesh> mesh = makeMesh(arrays);
  REQUIRE(mesh->mesh().topology().componentCount() == kParts);
  REQUIRE(mesh->mesh().meshClass() == MeshClass::kSolid);
  int inPlace = 0, anew = 0;
  bool wasShell = false;
  const auto movePart = [&](std::uint32_t part, const Vec3f& by) {
    std::vector<MovedVertex> moved;
    for (std::uint32_t v = 0; v < mesh->mesh().vertices().size(); ++v) {
      const std::uint32_t caller = mesh->mesh().callerVertex(v);
      if (caller < first[part] || caller >= first[part + 1]) continue;
      const Vec3f& p = mesh->mesh().vertices()[v];
      moved.push_back({v, {p.x + by.x, p.y + by.y, p.z + by.z}});
    }
    const std::shared_ptr<CollisionMesh> all = movedWhole(*mesh, moved);
    const bool changesClass = all->mesh().meshClass() != mesh->mesh().meshClass();
    if (mesh->moveSome(moved)) {
      ++inPlace;
      REQUIRE(!changesClass);
      checkSame(*mesh, *all);
    } else {
      ++anew;
      mesh = all;
    }
    wasShell = wasShell || mesh->mesh().meshClass() == MeshClass::kShell;
  };
  for (std::uint32_t part = 1; part < kParts; ++part) {
    const float x = 3.0f * static_cast<float>(part);
    movePart(part, {0, 0.01f, 0});
    movePart(part, {-x + 1.0f, 0, 0});  // across the surface of the ball
    movePart(part, {-0.9f, 0, 0});      // inside
    movePart(part, {0.01f, 0, 0});      // and still inside
    movePart(0, {0.05f, 0, 0});         // the ball around it
    movePart(part, {x - 0.11f, 0, 0});  // out
    movePart(part, {0, -0.01f, 0});
    movePart(0, {-0.05f, 0, 0});
  }
  INFO(inPlace << " in place, " << anew << " anew");
  CHECK(wasShell);  // two skins that face outward, one in the other, bound no solid
  CHECK(inPlace >= 20);
  CHECK(anew >= 10);
}

TEST_CASE("meshes of geoms with a scale move in place, too, and give the contacts of moving all vertices") {
  const OdeSession session;
  std::mt19937 random(7);
  std::uniform_real_distribution<float> unit(-1, 1);
  const scenes::MeshArrays lump = scenes::makeLump(1, 3, 0.15, 11);
  const auto count = static_cast<int>(lump.vertices.size());
  const Data some(lump), all(lump), floor(scenes::makeBox({4, 4, 1}));
  const Geom ground(floor);
  const std::array<double, 3> scales[] = {{1, 1, 1}, {2, 0.5, 1}, {2, 0.5, 1}, {-1, 1, 1.25}, {-1, -2, -1}};
  std::vector<dGeomID> movedSome, movedAll;
  for (const auto& s : scales) {
    for (const auto& [data, geoms] : {std::pair{&some, &movedSome}, {&all, &movedAll}}) {
      const dGeomID g = dCreateGpuTriMesh(nullptr, data->id);
      REQUIRE(dGeomGpuTriMeshSetScale(g, s[0], s[1], s[2]) == dGPUTRIMESH_OK);
      geoms->push_back(g);
    }
  }
  const auto meshOf = [](dGeomID g) { return objectOf(g)->mesh(); };
  CHECK(meshOf(movedSome[1]) == meshOf(movedSome[2]));
  std::vector<Vec3f> now = lump.vertices;
  std::shared_ptr<const CollisionMesh> held;
  std::size_t seen = 0;
  for (int step = 0; step < 12; ++step) {
    std::vector<int> numbers;
    std::vector<Vec3f> places;
    for (int i = 0; i < 30; ++i) {
      const int v = static_cast<int>(random() % static_cast<unsigned>(count));
      Vec3f& p = now[static_cast<std::size_t>(v)];
      p = {p.x + 0.01f * unit(random), p.y + 0.01f * unit(random), p.z + 0.01f * unit(random)};
      numbers.push_back(v);
      places.push_back(p);
    }
    if (step == 6) held = objectOf(movedSome[3])->sharedMesh();
    std::vector<const CollisionMesh*> before;
    for (const dGeomID g : movedSome) before.push_back(meshOf(g));
    const std::vector<unsigned char> heldBefore = held == nullptr ? std::vector<unsigned char>{} : cookMesh(*held);
    REQUIRE(dGpuTriMeshDataUpdateListSingle(some.id, places.data(), 0, numbers.data(), 30) == dGPUTRIMESH_OK);
    REQUIRE(dGpuTriMeshDataUpdateVerticesSingle(all.id, now.data(), 0, count) == dGPUTRIMESH_OK);
    for (std::size_t i = 0; i < movedSome.size(); ++i) {
      INFO("step " << step << " geom " << i);
      // One that somebody else holds goes on as it was, and the geom gets another.
      CHECK((meshOf(movedSome[i]) == before[i]) == !(step == 6 && i == 3));
      const dGeomID a = movedSome[i], b = movedAll[i];
      dReal boxA[6], boxB[6];
      dGeomGetAABB(a, boxA);
      dGeomGetAABB(b, boxB);
      CHECK(std::memcmp(boxA, boxB, sizeof boxA) == 0);
      for (const double z : {1.2, 1.45}) {
        for (const dGeomID g : {a, b}) dGeomSetPosition(g, 0.1, 0.2, z);
        const auto given = test::collide(ground.id, a);
        auto wanted = test::collide(ground.id, b);
        for (dContactGeom& c : wanted) c.g2 = a;
        REQUIRE(sameContacts(given, wanted));
        seen += given.size();
      }
      dGpuTriMeshClosestPoint pointA, pointB;
      const dVector3 at = {0.4, -0.3, 3, 0};
      REQUIRE(dGeomGpuTriMeshClosestPoint(a, at, &pointA) == dGPUTRIMESH_OK);
      REQUIRE(dGeomGpuTriMeshClosestPoint(b, at, &pointB) == dGPUTRIMESH_OK);
      CHECK(std::memcmp(pointA.pos, pointB.pos, sizeof pointA.pos) == 0);
      CHECK(pointA.triangle == pointB.triangle);
    }
    if (held != nullptr) CHECK((cookMesh(*held) == heldBefore));
    if (step == 8) held = nullptr;
  }
  CHECK(seen > 100);
  // A scale that a moved vertex does not bear leaves its geom without a mesh, until vertices come that it bears.
  int outermost = 0;
  for (int v = 0; v < count; ++v) {
    const auto reach = [&](int i) { return std::abs(now[static_cast<std::size_t>(i)].x); };
    if (reach(v) > reach(outermost)) outermost = v;
  }
  const Vec3f there = now[static_cast<std::size_t>(outermost)];
  const Vec3f beyond{1.03f * there.x, there.y, there.z};
  REQUIRE(dGeomGpuTriMeshSetScale(movedSome[1], 3.35e38 / std::abs(there.x), 1, 1) == dGPUTRIMESH_OK);
  const CollisionMesh* const base = meshOf(movedSome[0]);
  REQUIRE(dGpuTriMeshDataUpdateListSingle(some.id, &beyond, 0, &outermost, 1) == dGPUTRIMESH_OK);
  CHECK(meshOf(movedSome[0]) == base);
  CHECK(meshOf(movedSome[1]) == nullptr);
  REQUIRE(dGpuTriMeshDataUpdateListSingle(some.id, &there, 0, &outermost, 1) == dGPUTRIMESH_OK);
  CHECK(meshOf(movedSome[1]) != nullptr);
  for (const dGeomID g : movedSome) dGeomDestroy(g);
  for (const dGeomID g : movedAll) dGeomDestroy(g);
}
