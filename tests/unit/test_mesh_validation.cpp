// SPDX-License-Identifier: BSD-3-Clause
// What the validation report says about broken meshes, each broken in one known way.
#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <random>
#include <set>

#include "base/vectors.h"
#include "mesh/adjacency.h"
#include "scenes/generated_meshes.h"
#include "support/catch.h"

using namespace otg;
using namespace otg::scenes;

namespace {

const Problem* find(const ValidationReport& report, ProblemKind kind) {
  for (const Problem& problem : report.problems)
    if (problem.kind == kind) return &problem;
  return nullptr;
}

ValidationReport reportOf(const MeshArrays& arrays) {
  const MeshResult result = buildTriMesh(arrays.input());
  REQUIRE(result.mesh);
  CHECK(result.report.accepted);
  CHECK(result.report.error.empty());
  return result.report;
}

MeshArrays scaled(MeshArrays mesh, float factor) {
  for (Vec3f& p : mesh.vertices) p = otgScale(p, factor);
  return mesh;
}

MeshArrays insideOut(MeshArrays mesh) {
  for (Triangle& t : mesh.triangles) std::swap(t.v[1], t.v[2]);
  return mesh;
}

MeshArrays moved(const MeshArrays& mesh, Vec3d by) {
  return transformed(mesh, {{1, 0, 0, 0, 1, 0, 0, 0, 1}, by});
}

/// Edge statistics by a map from pairs of positions: slow, and shares nothing with the library.
struct NaiveEdges {
  std::size_t edges = 0, boundary = 0, nonManifold = 0, inconsistent = 0;
};
NaiveEdges countNaively(const MeshArrays& mesh) {
  using Point = std::array<float, 3>;
  std::map<std::pair<Point, Point>, std::vector<bool>> uses;
  const auto point = [&](std::uint32_t v) { return Point{mesh.vertices[v].x, mesh.vertices[v].y, mesh.vertices[v].z}; };
  for (const Triangle& t : mesh.triangles) {
    const Point p[3] = {point(t.v[0]), point(t.v[1]), point(t.v[2])};
    if (p[0] == p[1] || p[1] == p[2] || p[2] == p[0]) continue;
    for (int k = 0; k < 3; ++k) {
      const Point &a = p[k], &b = p[(k + 1) % 3];
      uses[{std::min(a, b), std::max(a, b)}].push_back(a < b);
    }
  }
  NaiveEdges result;
  result.edges = uses.size();
  for (const auto& [edge, directions] : uses) {
    result.boundary += directions.size() == 1;
    result.nonManifold += directions.size() > 2;
    result.inconsistent += directions.size() == 2 && directions[0] == directions[1];
  }
  return result;
}

}  // namespace

TEST_CASE("a box is a valid solid") {
  const ValidationReport report = reportOf(makeBox({1, 2, 3}));
  CHECK(report.valid());
  CHECK((report.closed && report.manifold && report.oriented && report.outward && report.solid));
  CHECK(report.vertices == 8);
  CHECK(report.triangles == 12);
  CHECK(report.edges == 18);
  CHECK(report.components == 1);
  CHECK(report.problems.empty());
}

TEST_CASE("closedness is judged on positions, not on vertex numbers") {
  // A triangle soup, as STL files are.
  const MeshArrays box = makeBox({1, 2, 3});
  MeshArrays soup;
  for (const Triangle& t : box.triangles) {
    const std::uint32_t n = static_cast<std::uint32_t>(soup.vertices.size());
    for (const std::uint32_t v : t.v) soup.vertices.push_back(box.vertices[v]);
    soup.triangles.push_back({{n, n + 1, n + 2}});
  }
  const ValidationReport report = reportOf(soup);
  CHECK(report.valid());
  CHECK(report.solid);
  CHECK(report.vertices == 36);
  CHECK(report.edges == 18);
  // The two zeros are one position.
  MeshArrays zeros = makeBlockWithHole({2, 2, 2}, 1);
  zeros.vertices.push_back({0, 0, 0});
  zeros.vertices.push_back({-0.0f, 0, -0.0f});
  const MeshResult built = buildTriMesh(zeros.input());
  CHECK(built.mesh->topology().weld[zeros.vertices.size() - 1] == zeros.vertices.size() - 2);
}

TEST_CASE("a hole shows as boundary edges") {
  MeshArrays open = makeBox({1, 1, 1});
  const Triangle removed = open.triangles[5];
  open.triangles.erase(open.triangles.begin() + 5);
  const ValidationReport report = reportOf(open);
  CHECK_FALSE(report.closed);
  CHECK(report.manifold);
  CHECK(report.oriented);
  CHECK_FALSE(report.outward);
  CHECK_FALSE(report.solid);
  CHECK_FALSE(report.valid());
  CHECK(report.boundaryEdges == 3);
  const Problem* problem = find(report, ProblemKind::kBoundaryEdge);
  REQUIRE(problem);
  CHECK(problem->count == 3);
  // Three neighbours, one for each edge of the removed triangle.
  REQUIRE(problem->elements.size() == 3);
  CHECK(std::is_sorted(problem->elements.begin(), problem->elements.end()));
  for (const std::uint32_t t : problem->elements) {
    int shared = 0;
    for (const std::uint32_t v : open.triangles[t].v) shared += std::count(removed.v, removed.v + 3, v) > 0;
    CHECK(shared == 2);
  }
  REQUIRE(find(report, ProblemKind::kEulerMismatch));
  CHECK(find(report, ProblemKind::kEulerMismatch)->message.find("E = 18 and F = 11") != std::string::npos);
}

TEST_CASE("a fin makes an edge non-manifold") {
  MeshArrays finned = makeBox({1, 1, 1});
  const Triangle first = finned.triangles[0];
  finned.vertices.push_back({5, 5, 5});
  finned.triangles.push_back({{first.v[0], first.v[1], 8}});
  const ValidationReport report = reportOf(finned);
  CHECK(report.nonManifoldEdges == 1);
  CHECK(report.boundaryEdges == 2);
  CHECK_FALSE(report.manifold);
  CHECK_FALSE(report.closed);
  CHECK_FALSE(report.solid);
  CHECK(report.nonManifoldVertices == 0);
  REQUIRE(find(report, ProblemKind::kNonManifoldEdge));
  CHECK(find(report, ProblemKind::kNonManifoldEdge)->elements.size() == 3);
  CHECK(find(report, ProblemKind::kNonManifoldEdge)->elements.front() == 0);
  CHECK(find(report, ProblemKind::kNonManifoldEdge)->elements.back() == 12);
}

TEST_CASE("two boxes that share an edge use it four times") {
  const MeshArrays two = merge({makeBox({1, 1, 1}), moved(makeBox({1, 1, 1}), {1, 1, 0})});
  const ValidationReport report = buildTriMesh(two.input(), RepairOptions{.weldVertices = true}).report;
  CHECK(report.nonManifoldEdges == 1);
  CHECK(report.boundaryEdges == 0);
  CHECK(report.components == 1);
  CHECK(report.nonManifoldVertices == 0);
  CHECK_FALSE(report.closed);
  CHECK(report.solid);  // taken apart
  // With vertices of their own they only touch.
  const ValidationReport apart = reportOf(two);
  CHECK(apart.solid);
  CHECK(apart.valid());
  CHECK(apart.components == 2);
}

TEST_CASE("two boxes that share a corner are a solid with a non-manifold vertex") {
  const MeshArrays two = merge({makeBox({1, 1, 1}), moved(makeBox({1, 1, 1}), {1, 1, 1})});
  CHECK(reportOf(two).valid());  // vertices of their own
  const ValidationReport report = buildTriMesh(two.input(), RepairOptions{.weldVertices = true}).report;
  CHECK(report.closed);
  CHECK(report.solid);
  CHECK_FALSE(report.manifold);
  CHECK_FALSE(report.valid());
  CHECK(report.components == 2);
  CHECK(report.nonManifoldVertices == 1);
  REQUIRE(find(report, ProblemKind::kNonManifoldVertex));
  const auto& elements = find(report, ProblemKind::kNonManifoldVertex)->elements;
  REQUIRE(elements.size() == 1);
  CHECK(two.vertices[elements[0]] == Vec3f{0.5f, 0.5f, 0.5f});
  CHECK(elements[0] < 8);  // the first of the two vertices there
}

TEST_CASE("fans are distinguished on open and badly wound meshes too") {
  // Two triangles that touch in a point only; then two that share an edge, once wound well and once not.
  MeshArrays bowTie{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {-1, 0, 0}, {0, -1, 0}}, {{{0, 1, 2}}, {{0, 3, 4}}}};
  CHECK(reportOf(bowTie).nonManifoldVertices == 1);
  CHECK(reportOf(bowTie).components == 2);
  bowTie.triangles[1] = {{0, 2, 3}};
  CHECK(reportOf(bowTie).nonManifoldVertices == 0);
  CHECK(reportOf(bowTie).components == 1);
  bowTie.triangles[1] = {{0, 3, 2}};
  CHECK(reportOf(bowTie).nonManifoldVertices == 0);
  CHECK(reportOf(bowTie).inconsistentEdges == 1);
  // The corner-sharing boxes, opened far from the corner, take the way for open meshes.
  MeshArrays two = merge({makeBox({1, 1, 1}, 3), moved(makeBox({1, 1, 1}, 3), {1, 1, 1})});
  const auto far = std::find_if(two.triangles.begin(), two.triangles.end(), [&](const Triangle& t) {
    return std::all_of(t.v, t.v + 3, [&](std::uint32_t v) { return two.vertices[v].x < 0; });
  });
  REQUIRE(far != two.triangles.end());
  two.triangles.erase(far);
  CHECK(reportOf(two).boundaryEdges == 3);
  CHECK(reportOf(two).nonManifoldVertices == 1);
}

TEST_CASE("one flipped triangle disagrees with its three neighbours") {
  MeshArrays flipped = makeSphere(1, 2);
  std::swap(flipped.triangles[7].v[0], flipped.triangles[7].v[1]);
  const ValidationReport report = reportOf(flipped);
  CHECK(report.closed);
  CHECK(report.manifold);
  CHECK_FALSE(report.oriented);
  CHECK_FALSE(report.solid);
  CHECK(report.inconsistentEdges == 3);
  REQUIRE(find(report, ProblemKind::kInconsistentWinding));
  const auto& elements = find(report, ProblemKind::kInconsistentWinding)->elements;
  CHECK(elements.size() == 4);
  CHECK(std::count(elements.begin(), elements.end(), 7u) == 1);
}

TEST_CASE("a mesh turned inside out is closed and oriented but not a solid") {
  const ValidationReport report = reportOf(insideOut(makeTorus(2, 0.5, 24, 12)));
  CHECK(report.closed);
  CHECK(report.oriented);
  CHECK_FALSE(report.outward);
  CHECK_FALSE(report.solid);
  REQUIRE(find(report, ProblemKind::kInwardWinding));
  CHECK(find(report, ProblemKind::kInwardWinding)->elements == std::vector<std::uint32_t>{0});
}

TEST_CASE("cavities face inward, islands in them outward") {
  const MeshArrays shell = makeSphere(3, 3), hollow = makeSphere(2, 3), island = makeSphere(1, 3);
  CHECK(reportOf(merge({shell, insideOut(hollow)})).valid());
  CHECK(reportOf(merge({insideOut(hollow), shell})).valid());
  CHECK(reportOf(merge({shell, insideOut(hollow), island})).valid());
  const ValidationReport wrongCavity = reportOf(merge({shell, hollow}));
  CHECK_FALSE(wrongCavity.solid);
  CHECK(find(wrongCavity, ProblemKind::kInwardWinding)->elements == std::vector<std::uint32_t>{1});
  const ValidationReport wrongIsland = reportOf(merge({shell, insideOut(hollow), insideOut(island)}));
  CHECK(find(wrongIsland, ProblemKind::kInwardWinding)->elements == std::vector<std::uint32_t>{2});
}

TEST_CASE("components beside each other, crossing, or in each other's holes are no cavities") {
  const MeshArrays box = makeBox({2, 2, 2});
  CHECK(reportOf(merge({box, moved(box, {5, 0, 0})})).solid);
  CHECK(reportOf(merge({box, moved(box, {1, 0.5, 0.25})})).solid);
  // Inside the bounds of a torus, in its hole; and a bar through the hole that sticks out on both sides.
  const MeshArrays ring = makeTorus(2, 0.5, 48, 24);
  CHECK(reportOf(merge({ring, scaled(box, 0.2f)})).solid);
  CHECK(reportOf(merge({ring, makeBox({0.2, 0.2, 9})})).solid);
  CHECK_FALSE(reportOf(merge({ring, insideOut(scaled(box, 0.2f))})).solid);
  // In the flesh of the torus, with bounds in the bounds.
  CHECK(reportOf(merge({ring, moved(insideOut(scaled(box, 0.2f)), {0, 2, 0})})).solid);
  // Half in the flesh, half in the hole.
  CHECK(reportOf(merge({ring, moved(scaled(box, 0.3f), {1.5, 0, 0})})).solid);
  CHECK_FALSE(reportOf(merge({ring, moved(insideOut(scaled(box, 0.3f)), {1.5, 0, 0})})).solid);
  // A box that pokes through the wall from a cavity's place crosses it: wound inward it is wrong.
  CHECK_FALSE(reportOf(merge({makeBox({4, 4, 4}), insideOut(makeBox({1, 1, 6}))})).solid);
}

TEST_CASE("rays through vertices and edges of the outer component count right") {
  // Lattice boxes: probes, lattice vertices and edges line up in every projection.
  for (const int n : {1, 2, 3, 6}) {
    for (const double x : {0.0, 0.5, 1.0, -1.25}) {
      const MeshArrays inner = moved(makeBox({1, 1, 1}, n), {x, 0, 0});
      CHECK(reportOf(merge({makeBox({6, 6, 6}, 6), insideOut(inner)})).solid);
      CHECK_FALSE(reportOf(merge({makeBox({6, 6, 6}, 6), inner})).solid);
      CHECK(reportOf(merge({makeBox({6, 6, 6}, 6), insideOut(moved(makeBox({2, 2, 2}, n), {x, 1, 0}))})).solid);
    }
  }
}

TEST_CASE("rays through the middle of a slanted edge count once, whatever rounding makes of the edge") {
  // The rays run along z, the shortest extent. The diagonal of the box's top is x = y, where the centroids of two of
  // each cavity's four triangles lie exactly.
  const MeshArrays outer = makeBox({6, 6, 5});
  std::mt19937 random(5);
  std::uniform_real_distribution<double> uniform(-2.5, 2.5);
  for (int i = 0; i < 200; ++i) {
    const double a = uniform(random), b = uniform(random), c = uniform(random), d = uniform(random);
    const MeshArrays cavity = insideOut(makeTetrahedron({a, b, 0}, {b, a, 0}, {c, c, 1}, {d, d, -1}));
    CHECK(reportOf(merge({outer, cavity})).solid);
  }
}

TEST_CASE("a hundred cavities in a large body are found without trying all pairs") {
  std::vector<MeshArrays> parts = {makeBox({12, 12, 12}, 20)};
  for (int i = 0; i < 100; ++i)
    parts.push_back(insideOut(moved(makeSphere(0.3, 2), {i % 10 - 4.5, i / 10 - 4.5, 0.1 * (i % 7)})));
  CHECK(reportOf(merge(parts)).valid());
  std::swap(parts[37], parts[0] = insideOut(parts[0]));
  parts[0] = insideOut(parts[0]);
  const ValidationReport report = reportOf(merge(parts));
  // The body now faces inward, and so does the cavity that was turned outward.
  CHECK(find(report, ProblemKind::kInwardWinding)->elements == std::vector<std::uint32_t>{0, 37});
}

TEST_CASE("two copies of a triangle back to back enclose nothing") {
  const MeshArrays leaf{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{{0, 1, 2}}, {{0, 2, 1}}}};
  const ValidationReport report = reportOf(leaf);
  CHECK(report.closed);
  CHECK(report.oriented);
  CHECK_FALSE(report.outward);
  CHECK_FALSE(report.solid);
  CHECK(report.duplicateTriangles == 1);
}

TEST_CASE("very flat bodies and small ones in large meshes are still solids") {
  CHECK(reportOf(makeBox({1, 1, 1e-5})).solid);
  CHECK(reportOf(moved(makeBox({1, 1, 1}), {1000, 2000, -500})).solid);
  CHECK(reportOf(merge({makeSphere(1000, 2), moved(makeSphere(0.01, 2), {3000, 0, 0})})).solid);
  CHECK(reportOf(scaled(makeSphere(1, 3), 1e-12f)).solid);
  CHECK(reportOf(scaled(makeSphere(1, 3), 1e12f)).solid);
}

TEST_CASE("duplicates are found in any order of their vertices, however many they are") {
  MeshArrays twice = makeBox({1, 1, 1});
  const Triangle t = twice.triangles[4];
  twice.triangles.push_back({{t.v[1], t.v[2], t.v[0]}});
  twice.triangles.push_back({{t.v[2], t.v[1], t.v[0]}});
  const ValidationReport report = reportOf(twice);
  CHECK(report.duplicateTriangles == 2);
  CHECK(find(report, ProblemKind::kDuplicateTriangle)->elements == std::vector<std::uint32_t>{12, 13});
  CHECK(report.nonManifoldEdges == 3);

  MeshArrays many{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, std::vector<Triangle>(100000, Triangle{{0, 1, 2}})};
  CHECK(reportOf(many).duplicateTriangles == 99999);
  CHECK(find(reportOf(many), ProblemKind::kDuplicateTriangle)->elements.size() == Problem::kMaxElements);

  // Alone with its mirror image, where the two are each other's twins.
  MeshArrays leaf{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {5, 5, 5}, {6, 5, 5}, {5, 6, 5}},
                  {{{3, 4, 5}}, {{0, 1, 2}}, {{1, 0, 2}}}};
  CHECK(find(reportOf(leaf), ProblemKind::kDuplicateTriangle)->elements == std::vector<std::uint32_t>{2});
  // Neighbours that share two points, in a closed mesh, are none.
  CHECK(reportOf(makeTetrahedron({0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1})).duplicateTriangles == 0);
}

TEST_CASE("repeated indices and equal positions are degenerate and take part in no edge") {
  MeshArrays mesh = makeBox({1, 1, 1});
  mesh.triangles.push_back({{0, 0, 1}});
  mesh.vertices.push_back(mesh.vertices[3]);
  mesh.triangles.push_back({{3, 8, 1}});
  const MeshResult result = buildTriMesh(mesh.input());
  const ValidationReport& report = result.report;
  CHECK(report.degenerateTriangles == 2);
  CHECK(find(report, ProblemKind::kDegenerateTriangle)->elements == std::vector<std::uint32_t>{12, 13});
  CHECK(report.closed);
  CHECK(report.solid);
  CHECK_FALSE(report.valid());
  CHECK(report.edges == 18);
  CHECK(report.components == 1);
  CHECK(result.mesh->triangleCount() == 14);
  CHECK(result.mesh->isDegenerate(13));
  CHECK_FALSE(result.mesh->isDegenerate(11));
  CHECK(result.mesh->topology().componentOf[12] == kNone);
  for (int k = 0; k < 6; ++k) CHECK(result.mesh->topology().edgeOf[36 + k] == kNone);
}

TEST_CASE("vertices exactly on a line are degenerate, others never") {
  const auto degenerate = [](Vec3f a, Vec3f b, Vec3f c) {
    return reportOf({{a, b, c}, {{{0, 1, 2}}}}).degenerateTriangles == 1;
  };
  CHECK(degenerate({0, 0, 0}, {1, 0, 0}, {2, 0, 0}));
  CHECK(degenerate({0, 0, 0}, {2, 0, 0}, {1, 0, 0}));
  CHECK(degenerate({1, 2, 3}, {2, 4, 6}, {4, 8, 12}));
  CHECK(degenerate({0, 0, 0}, {1e30f, 0, 0}, {2e30f, 0, 0}));
  CHECK(degenerate({0, 0, 0}, {1e-40f, 1e-40f, 0}, {2e-40f, 2e-40f, 0}));
  CHECK_FALSE(degenerate({0, 0, 0}, {1, 0, 0}, {0.5f, 1e-6f, 0}));
  CHECK_FALSE(degenerate({0, 0, 0}, {1, 0, 0}, {0.5f, 1e-9f, 0}));
  CHECK_FALSE(degenerate({0, 0, 0}, {1, 0, 0}, {2, 0, 1e-12f}));
  CHECK_FALSE(degenerate({0, 0, 0}, {1, 0, 0}, {2, 0, 1e-45f}));
  CHECK_FALSE(degenerate({0, 0, 0}, {1e38f, 1e38f, 0}, {1e-45f, 0, 0}));
  CHECK_FALSE(degenerate({1, 1, 1}, {3, 3, 3}, {2, 2, 2.0000002f}));
  // Small, but well shaped; and the same far from the origin.
  CHECK_FALSE(degenerate({0, 0, 0}, {1e-20f, 0, 0}, {0, 1e-20f, 0}));
  CHECK_FALSE(degenerate({1000, 0, 0}, {1000, 1e-3f, 0}, {1000, 0, 1e-3f}));
  CHECK_FALSE(degenerate({0, 0, 0}, {1e30f, 0, 0}, {0, 1e30f, 0}));
  CHECK_FALSE(degenerate({0, 0, 0}, {1e-40f, 0, 0}, {0, 1e-40f, 0}));
}

TEST_CASE("degenerate triangles are those of integer arithmetic, at every scale and with an outlier") {
  std::mt19937 random(7);
  const auto below = [&](int n) { return static_cast<std::int64_t>(random() % static_cast<unsigned>(n)); };
  std::size_t flat = 0, thin = 0;
  for (int i = 0; i < 20000; ++i) {
    std::int64_t p[3][3];
    for (int k = 0; k < 3; ++k) {
      p[0][k] = below(1 << 10);
      const std::int64_t step = below(1 << 10) - (1 << 9);
      p[1][k] = p[0][k] + 8 * step;
      p[2][k] = p[0][k] + below(2) + i % 17 * step;
    }
    bool expected = true;
    for (int k = 0; k < 3; ++k) {
      const int j = (k + 1) % 3;
      const std::int64_t cross = (p[1][k] - p[0][k]) * (p[2][j] - p[0][j]) - (p[1][j] - p[0][j]) * (p[2][k] - p[0][k]);
      expected = expected && cross == 0;
    }
    const float scale = std::ldexp(1.0f, static_cast<int>(below(200)) - 140);
    MeshArrays mesh;
    for (const auto& q : p) {
      mesh.vertices.push_back(
          {scale * static_cast<float>(q[0]), scale * static_cast<float>(q[1]), scale * static_cast<float>(q[2])});
    }
    mesh.triangles = {{{0, 1, 2}}};
    if (i % 2 == 0) {  // 1e10 sizes away
      for (int k = 0; k < 3; ++k) {
        mesh.vertices.push_back({1e14f * scale, k == 1 ? scale : 0, k == 2 ? scale : 0});
      }
      mesh.triangles.push_back({{3, 4, 5}});
    }
    REQUIRE(reportOf(mesh).degenerateTriangles == (expected ? 1 : 0));
    (expected ? flat : thin) += 1;
  }
  CHECK(flat > 2000);
  CHECK(thin > 10000);
}

TEST_CASE("a triangle far away leaves a small cube its faces") {
  MeshArrays mesh = makeBox({0.01, 0.01, 0.01});
  const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
  for (const Vec3f& v : {Vec3f{1e5f, 0, 0}, Vec3f{1e5f, 1, 0}, Vec3f{1e5f, 0, 1}}) mesh.vertices.push_back(v);
  mesh.triangles.push_back({{first, first + 1, first + 2}});
  CHECK(reportOf(mesh).degenerateTriangles == 0);
}

TEST_CASE("triangles as thin as can be have their normals") {
  const auto normal = [](Vec3f a, Vec3f b, Vec3f c) {
    const MeshArrays mesh{{a, b, c}, {{{0, 1, 2}}}};
    return buildAdjacency(*buildTriMesh(mesh.input()).mesh).normal[0];
  };
  const auto isNear = [](const Vec3d& n, const Vec3d& expected) { return norm(otgSub(n, expected)) < 1e-9; };
  CHECK(isNear(normal({0, 0, 0}, {1, 0, 0}, {0.5f, 1e-12f, 0}), {0, 0, 1}));
  CHECK(isNear(normal({0, 0, 0}, {1, 0, 0}, {0.5f, 0, 1e-45f}), {0, -1, 0}));
  // In the plane x = y, which double arithmetic no longer sees.
  const double half = std::sqrt(0.5);
  CHECK(isNear(normal({0, 0, 0}, {1, 1, 1}, {0.75f, 0.75f, std::nextafter(0.75f, 1.0f)}), {half, -half, 0}));
  CHECK(isNear(normal({0, 0, 0}, {1e-40f, 1e-40f, 0}, {1e-40f, 1e-40f, 1e-45f}), {half, -half, 0}));
  CHECK(isNear(normal({0, 0, 0}, {1e38f, 1e38f, 0}, {1e-30f, 1e-30f, 1e-45f}), {half, -half, 0}));
  CHECK(isNear(normal({0x1p23f, 0, 0}, {0x1p23f + 1, 1, 0}, {1, 1 - 0x1p23f, 0x1p-149f}), {half, -half, 0}));
  CHECK(norm(normal({1, 2, 3}, {2, 4, 6}, {4, 8, 12})) == 0);
}

TEST_CASE("an empty mesh is accepted and says so") {
  for (const bool vertices : {false, true}) {
    MeshArrays empty;
    if (vertices) empty.vertices = {{1, 2, 3}};
    const MeshResult result = buildTriMesh(empty.input());
    REQUIRE(result.mesh);
    CHECK(result.report.accepted);
    CHECK_FALSE(result.report.valid());
    CHECK_FALSE(result.report.solid);
    CHECK_FALSE(result.report.closed);
    CHECK(find(result.report, ProblemKind::kEmpty));
    CHECK(result.mesh->meshClass() == MeshClass::kShell);
    CHECK(result.mesh->boundsMin().x > result.mesh->boundsMax().x);
    CHECK(result.mesh->radius() == 0);
    CHECK(result.mesh->massProperties().volume == 0);
    CHECK(result.mesh->massProperties().centerOfMass.norm() == 0);
  }
}

TEST_CASE("unused vertices are named but harmless") {
  MeshArrays mesh = makeBox({1, 1, 1});
  mesh.vertices.push_back({100, 100, 100});
  const MeshResult result = buildTriMesh(mesh.input());
  CHECK(result.report.valid());
  REQUIRE(find(result.report, ProblemKind::kUnusedVertex));
  CHECK(find(result.report, ProblemKind::kUnusedVertex)->elements == std::vector<std::uint32_t>{8});
  CHECK(result.mesh->boundsMax() == Vec3f{0.5f, 0.5f, 0.5f});
}

TEST_CASE("edge statistics of random soups agree with counting by a map") {
  std::mt19937 random(3);
  for (int round = 0; round < 60; ++round) {
    // Few positions, so that edges meet in all ways; from 4 points on, also hubs with many edges.
    const std::uint32_t points = 4 + static_cast<std::uint32_t>(random() % 40);
    MeshArrays soup;
    for (std::uint32_t i = 0; i < points; ++i)
      soup.vertices.push_back(
          {static_cast<float>(random() % 5), static_cast<float>(random() % 5), static_cast<float>(random() % 3)});
    for (int i = 0; i < 120; ++i)
      soup.triangles.push_back(
          {{static_cast<std::uint32_t>(random() % points), static_cast<std::uint32_t>(random() % points),
            round % 2 ? 0 : static_cast<std::uint32_t>(random() % points)}});
    const ValidationReport report = reportOf(soup);
    const NaiveEdges naive = countNaively(soup);
    CHECK(report.edges == naive.edges);
    CHECK(report.boundaryEdges == naive.boundary);
    CHECK(report.nonManifoldEdges == naive.nonManifold);
    CHECK(report.inconsistentEdges == naive.inconsistent);
    std::set<std::multiset<std::array<float, 3>>> different;
    for (const Triangle& t : soup.triangles) {
      std::multiset<std::array<float, 3>> corners;
      for (const std::uint32_t v : t.v) corners.insert({soup.vertices[v].x, soup.vertices[v].y, soup.vertices[v].z});
      different.insert(corners);
    }
    CHECK(report.duplicateTriangles == soup.triangles.size() - different.size());
  }
}

TEST_CASE("every kind of problem has its own name") {
  std::set<std::string> names;
  for (int kind = 0; kind <= static_cast<int>(ProblemKind::kUnusedVertex); ++kind)
    names.insert(problemName(static_cast<ProblemKind>(kind)));
  CHECK(names.size() == static_cast<std::size_t>(ProblemKind::kUnusedVertex) + 1);
  CHECK(names.count("unknown") == 0);
}
