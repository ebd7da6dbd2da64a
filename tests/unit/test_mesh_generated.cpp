// SPDX-License-Identifier: BSD-3-Clause
// Every generated mesh is a solid of the genus and the volume that its formula says.
#include <algorithm>
#include <cmath>
#include <numbers>

#include "scenes/generated_meshes.h"
#include "support/catch.h"

using namespace otg;
using namespace otg::scenes;

namespace {

/// Twice the number of components less twice the number of handles.
long eulerCharacteristic(const TriMesh& mesh) {
  return static_cast<long>(mesh.report().vertices) - static_cast<long>(mesh.report().edges) +
         static_cast<long>(mesh.report().triangles);
}

void checkSolid(const MeshArrays& arrays, int genus, double volume, double tolerance = 1e-5) {
  const auto mesh = build(arrays);
  const ValidationReport& report = mesh->report();
  for (const Problem& problem : report.problems) UNSCOPED_INFO(problem.message);
  CHECK(report.solid);
  CHECK(report.valid());
  CHECK(report.components == 1);
  CHECK(eulerCharacteristic(*mesh) == 2 - 2 * genus);
  CHECK(mesh->massProperties().volume == Approx(volume).epsilon(tolerance));
}

/// Area of the regular polygon with n corners on a circle.
double polygonArea(double radius, int n) {
  return 0.5 * n * radius * radius * std::sin(2 * std::numbers::pi / n);
}

}  // namespace

TEST_CASE("box, tetrahedron, cylinder and torus have the volume of their formula") {
  checkSolid(makeBox({1, 2, 3}), 0, 6);
  checkSolid(makeBox({1, 2, 3}, 7), 0, 6);
  CHECK(makeBox({1, 2, 3}, 7).triangles.size() == 6 * 7 * 7 * 2);
  checkSolid(makeTetrahedron({0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}), 0, 1.0 / 6);
  checkSolid(makeTetrahedron({0, 0, 0}, {0, 1, 0}, {1, 0, 0}, {0, 0, 1}), 0, 1.0 / 6);
  checkSolid(makeCylinder(2, 3, 24), 0, 3 * polygonArea(2, 24));
  checkSolid(makeCylinder(2, 3, 24, 5), 0, 3 * polygonArea(2, 24));
  CHECK(makeTorus(2, 0.5, 40, 24).triangles.size() == 2 * 40 * 24);
}

TEST_CASE("a torus has the volume that Pappus' theorem gives its polygonal section") {
  // Between neighbouring sections the surface is ruled by two triangles for each quad, so the volume is that of the
  // polygon-swept torus only up to O(1 / segments^2): convergence is what is tested, with the known order.
  const auto error = [](int n) {
    const auto mesh = build(makeTorus(2, 0.5, 2 * n, n));
    REQUIRE(mesh->report().solid);
    CHECK(eulerCharacteristic(*mesh) == 0);
    return 2 * std::numbers::pi * std::numbers::pi * 2 * 0.25 - mesh->massProperties().volume;
  };
  CHECK(error(16) > 0);
  CHECK(error(16) / error(32) == Approx(4).epsilon(0.05));
  CHECK(error(32) / error(64) == Approx(4).epsilon(0.05));
}

TEST_CASE("spheres and lumps are solids; spheres converge to the ball's volume from below") {
  const double ball = 4.0 / 3 * std::numbers::pi * 8;
  double before = 0;
  for (int level = 0; level < 6; ++level) {
    const MeshArrays sphere = makeSphere(2, level);
    CHECK(sphere.triangles.size() == (std::size_t{20} << (2 * level)));
    const auto mesh = build(sphere);
    CHECK(mesh->report().valid());
    CHECK(eulerCharacteristic(*mesh) == 2);
    const double error = ball - mesh->massProperties().volume;
    CHECK(error > 0);
    if (level > 1) CHECK(before / error == Approx(4).epsilon(0.1));
    before = error;
  }
  for (std::uint32_t seed = 0; seed < 4; ++seed) {
    const auto mesh = build(makeLump(1, 4, 0.3, seed));
    CHECK(mesh->report().valid());
    CHECK(eulerCharacteristic(*mesh) == 2);
    double nearest = 2, farthest = 0;
    for (const Vec3f& p : mesh->vertices()) {
      nearest = std::min(nearest, std::hypot(double{p.x}, double{p.y}, double{p.z}));
      farthest = std::max(farthest, std::hypot(double{p.x}, double{p.y}, double{p.z}));
    }
    CHECK(nearest >= 0.7 - 1e-6);
    CHECK(farthest <= 1.3 + 1e-6);
    CHECK(farthest - nearest > 0.1);
  }
  CHECK(makeLump(1, 2, 0.3, 1).vertices != makeLump(1, 2, 0.3, 2).vertices);
}

TEST_CASE("a bowl is the difference of two polyhedral hemispheres") {
  // A layer between two rings of the same regular polygon is a frustum: h / 3 (A1 + A2 + sqrt(A1 A2)).
  const int segments = 36, rings = 12;
  const auto hemisphere = [&](double r) {
    double volume = 0;
    for (int i = 0; i < rings; ++i) {
      const double p = std::numbers::pi / 2 * i / rings, q = std::numbers::pi / 2 * (i + 1) / rings;
      const double a = polygonArea(r * std::sin(p), segments), b = polygonArea(r * std::sin(q), segments);
      volume += r * (std::cos(p) - std::cos(q)) / 3 * (a + b + std::sqrt(a * b));
    }
    return volume;
  };
  checkSolid(makeBowl(1, 0.2, segments, rings), 0, hemisphere(1) - hemisphere(0.8));
}

TEST_CASE("the ground is a slab with the given top") {
  checkSolid(makeGround(10, 1, 5), 0, 100);
  CHECK(build(makeGround(10, 1, 5))->boundsMax().z == 0);
  checkSolid(makeGround(10, 1, 1), 0, 100);
  // Linear heights are met exactly: the mean height is that of the centre.
  checkSolid(makeGround(10, 1, 6, [](double x, double y) { return 0.1 * x - 0.05 * y + 0.25; }), 0, 125);
  const auto hills = build(makeGround(10, 2, 64, [](double x, double y) { return std::sin(x) * std::cos(y); }));
  CHECK(hills->report().solid);
  CHECK(hills->massProperties().volume == Approx(200).epsilon(1e-3));  // an odd function on a symmetric domain
}

TEST_CASE("parts are appended and moved without changing what they are") {
  const Transformd pose{{0, -1, 0, 1, 0, 0, 0, 0, 1}, {5, 6, 7}};
  const MeshArrays box = makeBox({1, 2, 3});
  const auto moved = build(transformed(box, pose));
  CHECK(moved->boundsMin() == Vec3f{4, 5.5, 5.5});
  CHECK(moved->boundsMax() == Vec3f{6, 6.5, 8.5});
  const auto both = build(merge({box, transformed(box, pose)}));
  CHECK(both->report().solid);
  CHECK(both->report().components == 2);
  CHECK(both->massProperties().volume == Approx(12));
}
