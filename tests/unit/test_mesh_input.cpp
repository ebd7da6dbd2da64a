// SPDX-License-Identifier: BSD-3-Clause
// Arrays as callers have them: layouts, bad numbers, limits; and meshes whose vertices move.
#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

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

void checkRefused(const MeshResult& result, ProblemKind kind) {
  CHECK_FALSE(result.mesh);
  CHECK_FALSE(result.report.accepted);
  CHECK_FALSE(result.report.valid());
  CHECK_FALSE(result.report.error.empty());
  CHECK(result.report.error.find('\n') == std::string::npos);
  REQUIRE(find(result.report, kind));
  CHECK(result.report.error.find(find(result.report, kind)->message) != std::string::npos);
}

/// The box's vertices as `Scalar`s, `stride` bytes apart, behind `shift` bytes that take away the alignment.
template <class Scalar>
std::vector<unsigned char> strided(const MeshArrays& mesh, std::size_t stride, std::size_t shift) {
  std::vector<unsigned char> bytes(shift + stride * (mesh.vertices.size() - 1) + 3 * sizeof(Scalar), 0xee);
  for (std::size_t i = 0; i < mesh.vertices.size(); ++i) {
    const Vec3f& p = mesh.vertices[i];
    const Scalar c[3] = {Scalar{p.x}, Scalar{p.y}, Scalar{p.z}};
    std::memcpy(bytes.data() + shift + i * stride, c, sizeof(c));
  }
  return bytes;
}

}  // namespace

TEST_CASE("any stride, alignment and precision of the arrays gives the same mesh") {
  const MeshArrays box = makeBox({1, 2, 3}, 2);
  const auto expected = build(box);
  for (const std::size_t padding : {0, 1, 4, 13}) {
    // The last element ends where the array ends: reading a whole stride there would be out of bounds.
    const std::size_t triangleStride = 12 + padding;
    std::vector<unsigned char> indices(padding + triangleStride * (box.triangles.size() - 1) + 12, 0xff);
    for (std::size_t t = 0; t < box.triangles.size(); ++t)
      std::memcpy(indices.data() + padding + t * triangleStride, &box.triangles[t], 12);
    for (const auto scalar : {MeshInput::Scalar::kFloat, MeshInput::Scalar::kDouble}) {
      const std::size_t stride = (scalar == MeshInput::Scalar::kFloat ? 12 : 24) + padding;
      const auto bytes = scalar == MeshInput::Scalar::kFloat ? strided<float>(box, stride, padding)
                                                             : strided<double>(box, stride, padding);
      MeshInput input{
          bytes.data() + padding, scalar, stride, box.vertices.size(), indices.data() + padding, triangleStride,
          box.triangles.size()};
      MeshResult result = buildTriMesh(input);
      REQUIRE(result.mesh);
      CHECK(std::equal(box.vertices.begin(), box.vertices.end(), result.mesh->vertices().begin()));
      CHECK(std::equal(box.triangles.begin(), box.triangles.end(), result.mesh->triangles().begin()));
      CHECK(result.mesh->boundsMax() == expected->boundsMax());
      if (padding == 0) {
        input.vertexStride = input.triangleStride = 0;
        CHECK(buildTriMesh(input).report.solid);
      }
    }
  }
}

TEST_CASE("doubles are rounded to float once") {
  const double third = 1.0 / 3;
  const std::vector<double> vertices = {third, 0, 0, 0, -third, 0, 0, 0, 1e-300};
  const std::uint32_t indices[3] = {0, 1, 2};
  const MeshInput input{vertices.data(), MeshInput::Scalar::kDouble, 0, 3, indices, 0, 1};
  const MeshResult result = buildTriMesh(input);
  REQUIRE(result.mesh);
  CHECK(result.mesh->vertices()[0].x == static_cast<float>(third));
  CHECK(result.mesh->vertices()[1].y == -static_cast<float>(third));
  CHECK(result.mesh->vertices()[2].z == 0);
}

TEST_CASE("indices out of range are refused and named") {
  MeshArrays mesh = makeBox({1, 1, 1});
  mesh.triangles[3].v[1] = 8;
  mesh.triangles[10].v[2] = 0xffffffffu;
  const MeshResult result = buildTriMesh(mesh.input());
  checkRefused(result, ProblemKind::kIndexOutOfRange);
  CHECK(find(result.report, ProblemKind::kIndexOutOfRange)->count == 2);
  CHECK(find(result.report, ProblemKind::kIndexOutOfRange)->elements == std::vector<std::uint32_t>{3, 10});
  // Without any vertex every index is out of range.
  mesh.vertices.clear();
  checkRefused(buildTriMesh(mesh.input()), ProblemKind::kIndexOutOfRange);
}

TEST_CASE("vertices that are no finite floats are refused and named") {
  const float bad[] = {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity(),
                       -std::numeric_limits<float>::infinity()};
  for (const float value : bad) {
    MeshArrays mesh = makeBox({1, 1, 1});
    mesh.vertices[2].y = value;
    mesh.vertices[6].z = value;
    const MeshResult result = buildTriMesh(mesh.input(), RepairOptions::all());
    checkRefused(result, ProblemKind::kNonFiniteVertex);
    CHECK(result.report.nonfiniteVertices == 2);
    CHECK(find(result.report, ProblemKind::kNonFiniteVertex)->elements == std::vector<std::uint32_t>{2, 6});
  }
  // Beyond float, and the last doubles that are not.
  const std::uint32_t indices[3] = {0, 1, 2};
  for (const double value : {1e39, -1e39, 1e300, std::numeric_limits<double>::quiet_NaN()}) {
    const std::vector<double> vertices = {0, 0, 0, 1, 0, 0, 0, value, 0};
    checkRefused(buildTriMesh({vertices.data(), MeshInput::Scalar::kDouble, 0, 3, indices, 0, 1}),
                 ProblemKind::kNonFiniteVertex);
  }
  const std::vector<double> largest = {0, 0, 0, 1e38, 0, 0, 0, std::numeric_limits<float>::max(), 0};
  CHECK(buildTriMesh({largest.data(), MeshInput::Scalar::kDouble, 0, 3, indices, 0, 1}).mesh);
}

TEST_CASE("all refusals are reported at once") {
  MeshArrays mesh = makeBox({1, 1, 1});
  mesh.vertices[0].x = std::numeric_limits<float>::quiet_NaN();
  mesh.triangles[0].v[0] = 99;
  const MeshResult result = buildTriMesh(mesh.input());
  checkRefused(result, ProblemKind::kNonFiniteVertex);
  checkRefused(result, ProblemKind::kIndexOutOfRange);
}

TEST_CASE("null arrays, small strides and counts above the limits are refused without being read") {
  const MeshArrays box = makeBox({1, 1, 1});
  MeshInput input = box.input();
  input.vertices = nullptr;
  checkRefused(buildTriMesh(input), ProblemKind::kNullArray);
  input = box.input();
  input.indices = nullptr;
  checkRefused(buildTriMesh(input), ProblemKind::kNullArray);
  input = box.input();
  input.vertexStride = 11;
  checkRefused(buildTriMesh(input), ProblemKind::kBadStride);
  input.vertexStride = 12;
  CHECK(buildTriMesh(input).mesh);
  input.triangleStride = 8;
  checkRefused(buildTriMesh(input), ProblemKind::kBadStride);
  input = box.input();
  input.scalar = MeshInput::Scalar::kDouble;
  input.vertexStride = 23;
  checkRefused(buildTriMesh(input), ProblemKind::kBadStride);
  input = box.input();
  input.vertexCount = kMaxVertices + 1;
  checkRefused(buildTriMesh(input), ProblemKind::kTooManyVertices);
  input = box.input();
  input.triangleCount = kMaxTriangles + 1;
  checkRefused(buildTriMesh(input), ProblemKind::kTooManyTriangles);
  input.triangleCount = std::numeric_limits<std::size_t>::max();
  checkRefused(buildTriMesh(input), ProblemKind::kTooManyTriangles);
  CHECK(buildTriMesh({}).mesh);  // null arrays of nothing are an empty mesh
}

TEST_CASE("bounds, centre and radius enclose what triangles use") {
  const auto mesh = build(transformed(makeLump(3, 3, 0.4, 5), {{1, 0, 0, 0, 1, 0, 0, 0, 1}, {100, -50, 7}}));
  const Vec3f &lo = mesh->boundsMin(), &hi = mesh->boundsMax(), &c = mesh->center();
  CHECK(c.x == static_cast<float>((double{lo.x} + hi.x) / 2));
  double farthest = 0;
  for (const Vec3f& p : mesh->vertices()) {
    CHECK((p.x >= lo.x && p.y >= lo.y && p.z >= lo.z && p.x <= hi.x && p.y <= hi.y && p.z <= hi.z));
    farthest = std::max(farthest, std::hypot(double{p.x} - c.x, double{p.y} - c.y, double{p.z} - c.z));
  }
  CHECK(mesh->radius() >= farthest);
  CHECK(mesh->radius() <= farthest * (1 + 1e-6));
}

TEST_CASE("moved vertices keep the topology and renew everything measured") {
  const auto sphere = build(makeSphere(1, 3));
  MeshArrays twice = makeSphere(2, 3);
  const MeshResult moved = moveVertices(*sphere, twice.input());
  REQUIRE(moved.mesh);
  CHECK(moved.report.solid);
  CHECK(std::ranges::equal(moved.mesh->topology().twin, sphere->topology().twin));
  CHECK(moved.mesh->topology().componentVolume[0] == Approx(8 * sphere->topology().componentVolume[0]));
  CHECK(moved.mesh->massProperties().volume == Approx(8 * sphere->massProperties().volume));
  CHECK(moved.mesh->radius() == Approx(2 * sphere->radius()));
  // Turned inside out by mirroring.
  for (Vec3f& p : twice.vertices) p.x = -p.x;
  CHECK_FALSE(moveVertices(*sphere, twice.input()).report.outward);
  // Flattened: every triangle has no area left, and top and bottom vertices coincide.
  for (Vec3f& p : twice.vertices) p.x = p.y = 0;
  CHECK(moveVertices(*sphere, twice.input()).report.degenerateTriangles == sphere->triangleCount());
}

TEST_CASE("where equal positions part or meet, moving rebuilds the topology") {
  const MeshArrays box = makeBox({1, 1, 1});
  MeshArrays soup;
  for (const Triangle& t : box.triangles) {
    const std::uint32_t n = static_cast<std::uint32_t>(soup.vertices.size());
    for (const std::uint32_t v : t.v) soup.vertices.push_back(box.vertices[v]);
    soup.triangles.push_back({{n, n + 1, n + 2}});
  }
  const auto mesh = build(soup);
  CHECK(mesh->report().solid);
  MeshArrays torn = soup;
  torn.vertices[0].x += 0.25f;
  const MeshResult result = moveVertices(*mesh, torn.input());
  CHECK_FALSE(result.report.closed);
  CHECK(result.report.boundaryEdges > 0);
  CHECK(moveVertices(*result.mesh, soup.input()).report.solid);
}

TEST_CASE("moving refuses other counts and bad numbers") {
  const auto mesh = build(makeBox({1, 1, 1}));
  MeshArrays other = makeBox({1, 1, 1});
  other.vertices.push_back({0, 0, 0});
  checkRefused(moveVertices(*mesh, other.input()), ProblemKind::kVertexCountMismatch);
  other.vertices.resize(7);
  checkRefused(moveVertices(*mesh, other.input()), ProblemKind::kVertexCountMismatch);
  other = makeBox({1, 1, 1});
  other.vertices[3].z = std::numeric_limits<float>::quiet_NaN();
  checkRefused(moveVertices(*mesh, other.input()), ProblemKind::kNonFiniteVertex);
  MeshInput null;
  null.vertexCount = 8;
  checkRefused(moveVertices(*mesh, null), ProblemKind::kNullArray);
}

TEST_CASE("a mesh whose vertices were merged is moved by the caller's own array") {
  MeshArrays doubled = makeBox({1, 1, 1});
  doubled.vertices.insert(doubled.vertices.begin() + 1, doubled.vertices[0]);  // 0 and 1 are one point
  for (Triangle& t : doubled.triangles)
    for (std::uint32_t& v : t.v) v += v > 0 || (&t - doubled.triangles.data()) % 2 == 0;
  const MeshResult result = buildTriMesh(doubled.input(), RepairOptions::all());
  REQUIRE(result.mesh);
  CHECK(result.mesh->vertices().size() == 8);
  for (Vec3f& p : doubled.vertices) p = otgScale(p, 3.0f);
  const MeshResult moved = moveVertices(*result.mesh, doubled.input());
  REQUIRE(moved.mesh);
  CHECK(moved.report.solid);
  CHECK(moved.mesh->massProperties().volume == Approx(27));
  CHECK(moved.report.repair.weldedVertices == 1);
}
