// SPDX-License-Identifier: BSD-3-Clause
// Which meshes are convex, against whole numbers, and what becomes of them as polyhedra.
#include <cmath>
#include <map>
#include <random>
#include <set>

#include "base/vectors.h"
#include "bvh/collision_mesh.h"
#include "mesh/convex_polyhedron.h"
#include "primitives/convex_hull.h"
#include "scenes/generated_meshes.h"
#include "support/catch.h"

using namespace otg;

namespace {

/// A hull of points with small whole coordinates, of which products are exact.
scenes::MeshArrays hullOf(std::mt19937& random, int points, int reach) {
  std::normal_distribution<double> normal;
  std::vector<Vec3d> places;
  for (int i = 0; i < points; ++i) {
    const Vec3d d = unit(Vec3d{normal(random), normal(random), normal(random)});
    places.push_back({std::round(d.x * reach), std::round(d.y * reach), std::round(d.z * reach)});
  }
  scenes::MeshArrays mesh;
  std::map<std::uint32_t, std::uint32_t> number;
  for (const auto& triangle : convexHull(places)) {
    Triangle t{};
    for (std::size_t k = 0; k < 3; ++k) {
      const auto [at, isNew] = number.emplace(triangle[k], static_cast<std::uint32_t>(mesh.vertices.size()));
      if (isNew) {
        const Vec3d& p = places[triangle[k]];
        mesh.vertices.push_back({static_cast<float>(p.x), static_cast<float>(p.y), static_cast<float>(p.z)});
      }
      t.v[k] = at->second;
    }
    mesh.triangles.push_back(t);
  }
  return mesh;
}

/// No vertex above any triangle, in whole numbers.
bool isConvexInWholeNumbers(const scenes::MeshArrays& mesh) {
  const auto whole = [](const Vec3f& v) {
    return std::array<std::int64_t, 3>{static_cast<std::int64_t>(v.x), static_cast<std::int64_t>(v.y),
                                       static_cast<std::int64_t>(v.z)};
  };
  for (const Triangle& t : mesh.triangles) {
    const auto a = whole(mesh.vertices[t.v[0]]), b = whole(mesh.vertices[t.v[1]]), c = whole(mesh.vertices[t.v[2]]);
    std::int64_t u[3], v[3], n[3];
    for (std::size_t k = 0; k < 3; ++k) {
      u[k] = b[k] - a[k];
      v[k] = c[k] - a[k];
    }
    for (std::size_t k = 0; k < 3; ++k) n[k] = u[(k + 1) % 3] * v[(k + 2) % 3] - u[(k + 2) % 3] * v[(k + 1) % 3];
    for (const Vec3f& vertex : mesh.vertices) {
      const auto p = whole(vertex);
      if (n[0] * (p[0] - a[0]) + n[1] * (p[1] - a[1]) + n[2] * (p[2] - a[2]) > 0) return false;
    }
  }
  return true;
}

Convexity convexityOfArrays(const scenes::MeshArrays& arrays) {
  return convexityOf(*scenes::build(arrays));
}

/// Every face a loop, every edge there twice, every vertex below every face, and the supports those of all vertices.
void checkPolyhedron(const TriMesh& mesh, const ConvexPolyhedron& body, std::mt19937& random) {
  const double rounding = roundingOfVertices(mesh);
  std::multiset<std::pair<std::uint32_t, std::uint32_t>> edges;
  for (std::uint32_t f = 0; f < body.faceCount(); ++f) {
    const auto& face = body.face(f);
    CHECK(norm(face.normal) == Approx(1));
    for (const auto& c : body.corners(f)) {
      CHECK(c.face == f);
      CHECK(body.faceOfTriangle(c.triangle) == f);
      edges.emplace(c.vertex, c.next);
      const Topology::Edge& edge = mesh.topology().edges[c.edge];
      const auto along = [&](std::uint32_t v) {
        const Vec3f& p = mesh.vertices()[v];
        return otgDot(Vec3d{p.x, p.y, p.z}, body.vertices()[c.next] - body.vertices()[c.vertex]);
      };
      CHECK((along(edge.b) > along(edge.a)) == c.isForward);
    }
    double most = -1e300;
    for (const Vec3f& v : mesh.vertices()) most = std::max(most, otgDot(face.normal, Vec3d{v.x, v.y, v.z}));
    CHECK(std::fabs(most - face.offset) <= rounding);
  }
  for (const auto& [from, to] : edges) {
    REQUIRE(edges.count({from, to}) == 1);
    REQUIRE(edges.count({to, from}) == 1);
  }
  CHECK(body.vertices().size() + body.faceCount() == edges.size() / 2 + 2);
  std::normal_distribution<double> normal;
  for (int i = 0; i < 200; ++i) {
    const Vec3d d = unit(Vec3d{normal(random), normal(random), normal(random)});
    double most = -1e300;
    for (const Vec3f& v : mesh.vertices()) most = std::max(most, otgDot(d, Vec3d{v.x, v.y, v.z}));
    REQUIRE(std::fabs(otgDot(d, body.vertices()[body.support(d)]) - most) <= 4 * rounding);
  }
}

}  // namespace

TEST_CASE("Convexity is that of whole numbers", "[convex]") {
  std::mt19937 random(7);
  int convex = 0, dented = 0;
  for (int i = 0; i < 400; ++i) {
    const int reach = i % 2 ? 1000 : 30;  // in the second case with faces of several triangles
    scenes::MeshArrays mesh = hullOf(random, 5 + i % 60, reach);
    // Points that lie almost in a face may be left out by the hull itself: whole numbers say what is so.
    bool truth = isConvexInWholeNumbers(mesh);
    convex += truth;
    CHECK((convexityOfArrays(mesh) == Convexity::kExact) == truth);
    for (int k = 0; k < 4; ++k) {
      scenes::MeshArrays moved = mesh;
      Vec3f& v = moved.vertices[random() % moved.vertices.size()];
      const float by = k < 2 ? 1.0f : static_cast<float>(reach / 4);
      (random() % 2 ? v.x : v.y) -= std::copysign(by, random() % 2 ? v.x : v.y);
      const auto built = scenes::build(moved);
      if (built->meshClass() != MeshClass::kSolid) continue;
      truth = isConvexInWholeNumbers(moved);
      dented += !truth;
      CHECK((convexityOf(*built) == Convexity::kExact) == truth);
    }
  }
  CHECK(convex > 300);
  CHECK(dented > 300);
}

TEST_CASE("One unit in the last place makes a face concave", "[convex]") {
  // A box whose lid is a fan about its middle.
  for (const float height : {0.5f, 1.0f}) {
    const float up = std::nextafter(height, 2.0f), down = std::nextafter(height, 0.0f);
    for (const float middle : {height, up, down, height + 1e-3f, height - 1e-3f}) {
      scenes::MeshArrays mesh = scenes::makeBox({1, 1, 1});
      for (Vec3f& v : mesh.vertices) v.z = v.z > 0 ? height : -height;
      std::vector<Triangle> kept;
      std::vector<std::uint32_t> rim;
      for (const Triangle& t : mesh.triangles) {
        const bool isLid = mesh.vertices[t.v[0]].z > 0 && mesh.vertices[t.v[1]].z > 0 && mesh.vertices[t.v[2]].z > 0;
        if (!isLid) kept.push_back(t);
      }
      for (const auto& [x, y] : {std::pair{-1, -1}, {1, -1}, {1, 1}, {-1, 1}}) {
        rim.push_back(static_cast<std::uint32_t>(mesh.vertices.size()));
        const auto sx = static_cast<float>(x), sy = static_cast<float>(y);
        mesh.vertices.push_back({0.5f * sx, 0.5f * sy, height});
      }
      mesh.vertices.push_back({0, 0, middle});
      for (std::size_t k = 0; k < 4; ++k) kept.push_back({{rim[k], rim[(k + 1) % 4], rim[3] + 1}});
      mesh.triangles = kept;
      const auto built = scenes::build(mesh);
      REQUIRE(built->meshClass() == MeshClass::kSolid);
      const Convexity expected = middle >= height           ? Convexity::kExact
                                 : middle >= height - 1e-6f ? Convexity::kToRounding
                                                            : Convexity::kNone;
      INFO("height " << height << ", middle " << middle);
      CHECK(convexityOf(*built) == expected);
      const auto body = buildConvexPolyhedron(*built);
      REQUIRE((body != nullptr) == (expected != Convexity::kNone));
      if (body != nullptr) CHECK(body->faceCount() == (middle > height + 1e-6f ? 9u : 6u));
    }
  }
}

TEST_CASE("Faces, edges and supports of convex meshes", "[convex]") {
  std::mt19937 random(3);
  struct Sample {
    scenes::MeshArrays mesh;
    std::size_t faces, vertices;  ///< 0: not known beforehand
  };
  std::vector<Sample> samples = {{scenes::makeBox({0.5, 0.5, 0.5}), 6, 8},
                                 {scenes::makeBox({0.3, 0.2, 0.7}, 4), 6, 8},
                                 {scenes::makeBox({0.3, 0.2, 0.7}, 16), 6, 8},
                                 {scenes::makeCylinder(0.5, 1, 32, 3), 34, 64},
                                 {scenes::makeSphere(1, 0), 0, 0},
                                 {scenes::makeSphere(1, 3), 0, 0},
                                 {scenes::makeSphere(0.3, 5), 0, 0},
                                 {scenes::makeTetrahedron({0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}), 4, 4}};
  for (const int points : {8, 20, 60, 200}) samples.push_back({hullOf(random, points, 1000), 0, 0});
  for (const Sample& sample : samples) {
    const auto mesh = scenes::build(sample.mesh);
    INFO(mesh->triangleCount() << " triangles");
    const auto body = buildConvexPolyhedron(*mesh);
    REQUIRE(body != nullptr);
    if (sample.faces > 0) CHECK(body->faceCount() == sample.faces);
    if (sample.vertices > 0) CHECK(body->vertices().size() == sample.vertices);
    checkPolyhedron(*mesh, *body, random);
  }
}

TEST_CASE("Meshes that are no convex bodies", "[convex]") {
  CHECK(buildConvexPolyhedron(*scenes::build(scenes::makeTorus(1, 0.3, 24, 12))) == nullptr);
  CHECK(buildConvexPolyhedron(*scenes::build(scenes::makeLump(1, 3, 0.3, 1))) == nullptr);
  CHECK(buildConvexPolyhedron(*scenes::build({})) == nullptr);
  // Two boxes in one mesh.
  scenes::MeshArrays two = scenes::makeBox({0.5, 0.5, 0.5});
  const auto count = static_cast<std::uint32_t>(two.vertices.size());
  const scenes::MeshArrays one = two;
  for (const Vec3f& v : one.vertices) two.vertices.push_back({v.x + 3, v.y, v.z});
  for (const Triangle& t : one.triangles) two.triangles.push_back({{t.v[0] + count, t.v[1] + count, t.v[2] + count}});
  CHECK(buildConvexPolyhedron(*scenes::build(two)) == nullptr);
  // Inside out; without a triangle; too thin for its coordinates.
  scenes::MeshArrays turned = one;
  for (Triangle& t : turned.triangles) std::swap(t.v[1], t.v[2]);
  CHECK(buildConvexPolyhedron(*scenes::build(turned)) == nullptr);
  scenes::MeshArrays open = one;
  open.triangles.pop_back();
  CHECK(buildConvexPolyhedron(*scenes::build(open)) == nullptr);
  CHECK(buildConvexPolyhedron(*scenes::build(scenes::makeBox({1, 1, 1e-5}))) == nullptr);
  CHECK(buildConvexPolyhedron(*scenes::build(scenes::makeBox({1, 1, 1e-2}))) != nullptr);
}

TEST_CASE("Moved vertices make convexity be found again", "[convex]") {
  const auto shared = scenes::build(scenes::makeSphere(1, 2));
  const scenes::MeshArrays arrays = scenes::makeSphere(1, 2);
  auto own = scenes::build(arrays);
  CollisionMesh mesh(std::move(own), BuildStrategy::kSah);
  REQUIRE(mesh.convex() != nullptr);
  const std::uint32_t v = mesh.ownVertex(0);
  const Vec3f before = mesh.mesh().vertices()[v];
  const Vec3f dent{0.5f * before.x, 0.5f * before.y, 0.5f * before.z};
  REQUIRE(mesh.moveSome(std::vector<MovedVertex>{{v, dent}}));
  CHECK(mesh.convex() == nullptr);
  REQUIRE(mesh.moveSome(std::vector<MovedVertex>{{v, before}}));
  CHECK(mesh.convex() != nullptr);
}
