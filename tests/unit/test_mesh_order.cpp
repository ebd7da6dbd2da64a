// SPDX-License-Identifier: BSD-3-Clause
// A mesh that is sorted for locality is the same mesh under other numbers, and callers see their own.
#include <algorithm>
#include <set>

#include "collide/query.h"
#include "mesh/local_order.h"
#include "scenes/generated_meshes.h"
#include "support/catch.h"

using namespace otg;
using namespace otg::scenes;

namespace {

std::shared_ptr<const TriMesh> sorted(const MeshArrays& arrays, const RepairOptions& repair = {}) {
  return buildTriMesh(arrays.input(), repair, MeshOrder::kLocal).mesh;
}

void checkSameTopology(const Topology& a, const Topology& b) {
  CHECK(std::ranges::equal(a.weld, b.weld));
  CHECK(std::ranges::equal(a.edgeOf, b.edgeOf));
  CHECK(std::ranges::equal(a.twin, b.twin));
  CHECK(std::ranges::equal(a.componentOf, b.componentOf));
  CHECK(std::ranges::equal(a.componentClosed, b.componentClosed));
  REQUIRE(a.edges.size() == b.edges.size());
  bool same = true;
  for (std::size_t e = 0; e < a.edges.size(); ++e) same &= a.edges[e].a == b.edges[e].a && a.edges[e].b == b.edges[e].b;
  CHECK(same);
  REQUIRE(a.componentVolume.size() == b.componentVolume.size());
  for (std::size_t c = 0; c < a.componentVolume.size(); ++c) {
    CHECK(a.componentVolume[c] == Approx(b.componentVolume[c]).margin(1e-12));
  }
}

/// Built from the mesh's own numbers, with edges in the direction of the caller's.
Topology topologyOf(const TriMesh& mesh) {
  Topology topology = buildTopology(mesh.vertices(), mesh.triangles());
  std::vector<std::uint32_t> callerVertex(mesh.vertices().size());
  for (std::uint32_t v = 0; v < callerVertex.size(); ++v) callerVertex[v] = mesh.callerVertex(v);
  orientEdges(topology, callerVertex);
  return topology;
}

/// Cubes beside each other, a soup triangle, an unused vertex, and corners that are separate vertices.
MeshArrays mixed() {
  MeshArrays far = makeBox({1, 1, 1}, 3);
  for (Vec3f& v : far.vertices) v.x += 4;
  MeshArrays mesh = merge({makeSphere(1, 3), far, makeTorus(2, 0.3, 16, 8)});
  const auto n = static_cast<std::uint32_t>(mesh.vertices.size());
  mesh.vertices.insert(mesh.vertices.end(), {{9, 9, 9}, {5, 0, 0}, {5, 1, 0}, {5, 0, 2}, mesh.vertices[0]});
  mesh.triangles.push_back({{n + 1, n + 2, n + 3}});
  for (std::uint32_t& v : mesh.triangles[0].v) {
    if (v == 0) v = n + 4;
  }
  return mesh;
}

}  // namespace

TEST_CASE("renumbering gives what building the renumbered mesh gives") {
  for (const MeshArrays& arrays : {mixed(), makeSphere(1, 3), makeBox({1, 2, 3}, 1)}) {
    const auto mesh = sorted(arrays);
    REQUIRE(mesh != nullptr);
    REQUIRE(mesh->vertices().size() == arrays.vertices.size());
    checkSameTopology(mesh->topology(), topologyOf(*mesh));
    std::set<std::uint32_t> seen;
    for (std::uint32_t t = 0; t < mesh->triangleCount(); ++t) {
      const std::uint32_t caller = mesh->callerTriangle(t);
      REQUIRE(mesh->triangleOfCaller(caller) == t);
      REQUIRE(seen.insert(caller).second);
      for (int k = 0; k < 3; ++k) {
        const std::uint32_t v = mesh->triangles()[t].v[k];
        REQUIRE(mesh->callerVertex(v) == arrays.triangles[caller].v[k]);
        REQUIRE(mesh->vertices()[v] == arrays.vertices[mesh->callerVertex(v)]);
      }
    }
  }
}

TEST_CASE("neighbours are neighbours in memory") {
  const auto mesh = sorted(makeSphere(1, 5));
  const auto gap = [](const TriMesh& m) {
    double sum = 0;
    for (std::uint32_t h = 0; h < m.topology().twin.size(); ++h) {
      sum += std::abs(static_cast<double>(m.topology().twin[h] / 3) - static_cast<double>(h / 3));
    }
    return sum / static_cast<double>(m.topology().twin.size());
  };
  CHECK(gap(*mesh) < 0.1 * static_cast<double>(mesh->triangleCount()));
}

TEST_CASE("numbers depend on what hangs together, not on places or winding") {
  const MeshArrays arrays = makeLump(1, 4, 0.3, 5);
  const auto mesh = sorted(arrays);
  MeshArrays bent = arrays, turned = arrays;
  for (Vec3f& v : bent.vertices) v = {v.y + v.x * v.x, -v.x, 3 * v.z};
  for (Triangle& t : turned.triangles) std::swap(t.v[1], t.v[2]);
  for (const MeshArrays& other : {bent, turned}) {
    const auto same = sorted(other);
    bool triangles = true, vertices = true;
    for (std::uint32_t t = 0; t < mesh->triangleCount(); ++t) {
      triangles = triangles && mesh->callerTriangle(t) == same->callerTriangle(t);
    }
    for (std::uint32_t v = 0; v < mesh->vertices().size(); ++v) {
      vertices = vertices && mesh->callerVertex(v) == same->callerVertex(v);
    }
    CHECK(triangles);
    CHECK(vertices);
  }
}

TEST_CASE("a mesh whose neighbours all meet in one triangle is numbered all the same") {
  MeshArrays star;  // a fan about each corner of each triangle that is there before: trees of triangles
  star.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  star.triangles = {{{0, 1, 2}}};
  for (std::uint32_t t = 0; t < 3000; ++t) {
    const auto n = static_cast<std::uint32_t>(star.vertices.size());
    const Triangle from = star.triangles[t / 2];
    star.vertices.push_back({static_cast<float>(n), static_cast<float>(n * n % 7), 1});
    const std::uint32_t k = 1 + t % 2;
    star.triangles.push_back({{from.v[(k + 1) % 3], from.v[k], n}});
  }
  const auto mesh = sorted(star);
  REQUIRE(mesh != nullptr);
  checkSameTopology(mesh->topology(), topologyOf(*mesh));
}

TEST_CASE("contacts after an update of vertices are those of a new mesh, to the last bit") {
  const MeshArrays before = makeLump(1, 4, 0.3, 5);
  MeshArrays after = before;
  for (Vec3f& v : after.vertices) v = {1.2f * v.x, v.y + 0.2f * v.z * v.z, v.z};
  const auto built = buildTriMesh(after.input(), {}, MeshOrder::kBySize).mesh;
  const auto updated = moveVertices(*buildTriMesh(before.input(), {}, MeshOrder::kBySize).mesh, after.input()).mesh;
  const CollisionMesh first(built, BuildStrategy::kSah), second(updated, BuildStrategy::kSah);
  for (const double far : {0.7, 1.2, 1.6, 1.8}) {
    Query query;
    query.bInA = {{0, -1, 0, 1, 0, 0, 0, 0, 1}, {far, 0.3, 0.2}};
    query.options.contacts = ContactModel::kSolid;
    Workspace x, y;
    query.a = query.b = &first;
    collide(query, x);
    query.a = query.b = &second;
    collide(query, y);
    REQUIRE(!x.reduced.empty());
    REQUIRE(x.reduced.size() == y.reduced.size());
    for (std::size_t i = 0; i < x.reduced.size(); ++i) {
      CHECK(x.reduced[i].position == y.reduced[i].position);
      CHECK(x.reduced[i].normal == y.reduced[i].normal);
      CHECK(x.reduced[i].depth == y.reduced[i].depth);
    }
  }
}

TEST_CASE("reports name the caller's elements, at building and after moving vertices") {
  MeshArrays arrays = mixed();
  const MeshResult plain = buildTriMesh(arrays.input());
  const MeshResult ordered = buildTriMesh(arrays.input(), {}, MeshOrder::kLocal);
  const auto check = [](const ValidationReport& a, const ValidationReport& b) {
    REQUIRE(a.problems.size() == b.problems.size());
    for (std::size_t i = 0; i < a.problems.size(); ++i) {
      CHECK(a.problems[i].kind == b.problems[i].kind);
      CHECK(a.problems[i].count == b.problems[i].count);
      CHECK(a.problems[i].message == b.problems[i].message);
    }
  };
  check(plain.report, ordered.report);
  for (std::size_t i = 0; i < plain.report.problems.size(); ++i) {
    CHECK(plain.report.problems[i].elements == ordered.report.problems[i].elements);
  }
  for (Vec3f& v : arrays.vertices) v.z *= 1.5f;
  const MeshResult movedPlain = moveVertices(*plain.mesh, arrays.input());
  const MeshResult moved = moveVertices(*ordered.mesh, arrays.input());
  REQUIRE(moved.mesh != nullptr);
  check(movedPlain.report, moved.report);
  for (const Problem& problem : moved.report.problems) {
    if (problem.kind == ProblemKind::kUnusedVertex) {
      CHECK(problem.elements == std::vector<std::uint32_t>{static_cast<std::uint32_t>(arrays.vertices.size() - 5)});
    }
  }
  for (std::uint32_t v = 0; v < moved.mesh->vertices().size(); ++v) {
    REQUIRE(moved.mesh->vertices()[v] == arrays.vertices[moved.mesh->callerVertex(v)]);
  }
  checkSameTopology(moved.mesh->topology(), topologyOf(*moved.mesh));
}

TEST_CASE("repairs and order go together") {
  const auto mesh = sorted(mixed(), RepairOptions::all());
  REQUIRE(mesh != nullptr);
  const MeshArrays arrays = mixed();
  const auto repaired = buildTriMesh(arrays.input(), RepairOptions::all()).mesh;
  REQUIRE(mesh->triangleCount() == repaired->triangleCount());
  for (std::uint32_t t = 0; t < mesh->triangleCount(); ++t) {
    for (int k = 0; k < 3; ++k) {
      const Vec3f& p = mesh->vertices()[mesh->triangles()[t].v[k]];
      REQUIRE(p == repaired->vertices()[repaired->triangles()[mesh->callerTriangle(t)].v[k]]);
      REQUIRE(p == arrays.vertices[mesh->callerVertex(mesh->triangles()[t].v[k])]);
    }
  }
}

TEST_CASE("queries answer in the caller's numbers") {
  const MeshArrays arrays = makeLump(1, 4, 0.3, 5);
  const CollisionMesh plain(scenes::build(arrays), BuildStrategy::kSah), ordered(sorted(arrays), BuildStrategy::kSah);
  Query query;
  query.bInA = {{0, -1, 0, 1, 0, 0, 0, 0, 1}, {1.1, 0.3, 0.2}};
  query.options.contacts = ContactModel::kPairwise;
  query.options.reduction.method = Reduction::kNone;
  query.options.maxContacts = 65535;
  Workspace x, y;
  query.a = query.b = &plain;
  collide(query, x);
  query.a = query.b = &ordered;
  collide(query, y);
  REQUIRE(x.intersecting.size() > 100);
  CHECK(pairsOfCaller(query, y.intersecting) == x.intersecting);
  const auto byTriangles = [](const Contact& p, const Contact& q) {
    return std::tie(p.triangleA, p.triangleB, p.position.x, p.position.y, p.position.z) <
           std::tie(q.triangleA, q.triangleB, q.position.x, q.position.y, q.position.z);
  };
  std::sort(x.reduced.begin(), x.reduced.end(), byTriangles);
  std::sort(y.reduced.begin(), y.reduced.end(), byTriangles);
  REQUIRE(x.reduced.size() == y.reduced.size());
  for (std::size_t i = 0; i < x.reduced.size(); ++i) {
    CHECK(x.reduced[i].triangleA == y.reduced[i].triangleA);
    CHECK(x.reduced[i].triangleB == y.reduced[i].triangleB);
    CHECK(x.reduced[i].depth == y.reduced[i].depth);
  }
}
