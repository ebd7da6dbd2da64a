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
  // Between neighbouring sections the surface is ruled by two triangles for each quad. So the volume is that of the
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

TEST_CASE("a gear has the volume of its outline less its bore") {
  const int teeth = 17;
  const double root = 0.9, tip = 1.1, share = 2 * std::numbers::pi / teeth;
  // Triangles from the axis: gap between teeth, two flanks, tip.
  const double outline = teeth * 0.5 *
                         (root * root * std::sin(0.32 * share) + 2 * root * tip * std::sin(0.20 * share) +
                          tip * tip * std::sin(0.28 * share));
  const double bore =
      teeth * 0.5 * 0.09 * (std::sin(0.32 * share) + 2 * std::sin(0.20 * share) + std::sin(0.28 * share));
  checkSolid(makeGear(teeth, 1, 0.2, 0.5, 0.3), 1, 0.5 * (outline - bore));
  checkSolid(makeGear(teeth, 1, 0.2, 0.5, 0), 0, 0.5 * outline);
  CHECK(build(makeGear(teeth, 1, 0.2, 0.5, 0.3))->boundsMax().x == Approx(tip * std::cos(0.14 * share)));
}

TEST_CASE("a block with a hole lacks the hole's volume") {
  checkSolid(makeBlockWithHole({2, 3, 4}, 0.5), 1, (6 - 0.25) * 4);
}

TEST_CASE("bolt and nut have the volume of the thread's profile") {
  const double radius = 8, pitch = 2, apothem = 12;
  const double root = radius - 5.0 / 16 * std::sqrt(3.0) * pitch;
  // Over whole turns every direction sees whole pitches of the profile: crest 1/8, groove 1/4, flanks 5/16 each.
  const auto meanSquare = [](double crest, double groove) {
    return crest * crest / 8 + groove * groove / 4 +
           2 * 5.0 / 16 * (crest * crest + crest * groove + groove * groove) / 3;
  };
  const double hexagon = 2 * std::sqrt(3.0) * apothem * apothem;
  for (const int segments : {48, 192}) {
    const double polygon = 0.5 * segments * std::sin(2 * std::numbers::pi / segments);  // per square of the radius
    checkSolid(makeBolt(radius, pitch, 40, segments), 0, 40 * polygon * meanSquare(radius, root) + 10 * hexagon,
               0.1 / segments);
    checkSolid(makeNut(radius, pitch, 12, 0.1, segments), 1,
               12 * (hexagon - polygon * meanSquare(radius + 0.1, root + 0.1)), 0.1 / segments);
  }
  checkSolid(makeBolt(radius, pitch, 13.7, 30), 0,
             13.7 * 15 * std::sin(2 * std::numbers::pi / 30) * meanSquare(radius, root) + 10 * hexagon, 0.01);
}

TEST_CASE("a nut on a bolt at the right phase has its clearance all around") {
  const double radius = 8, pitch = 2, clearance = 0.1;
  const int segments = 48;
  const MeshArrays bolt = makeBolt(radius, pitch, 40, segments), nut = makeNut(radius, pitch, 12, clearance, segments);
  // In each of the half-planes through the axis that hold vertices, the bolt's profile is a polyline r(z).
  struct Corner {
    double z, r;
  };
  const auto profile = [&](const MeshArrays& mesh, int column, double largestRadius) {
    std::vector<Corner> corners;
    for (const Vec3f& p : mesh.vertices) {
      const double r = std::hypot(p.x, p.y), turn = std::atan2(p.y, p.x) / (2 * std::numbers::pi) * segments;
      if (r > 1 && r < largestRadius && p.z >= 0 && (static_cast<int>(std::lround(turn)) - column) % segments == 0)
        corners.push_back({p.z, r});
    }
    std::sort(corners.begin(), corners.end(), [](const Corner& a, const Corner& b) { return a.z < b.z; });
    return corners;
  };
  const auto radiusAt = [](const std::vector<Corner>& line, double z) {
    const auto above = std::lower_bound(line.begin(), line.end(), z, [](const Corner& c, double x) { return c.z < x; });
    REQUIRE(above != line.end());
    if (above == line.begin()) return above->r;
    const auto below = above - 1;
    return below->r + (above->r - below->r) * (z - below->z) / (above->z - below->z);
  };
  for (int column = 0; column < segments; ++column) {
    const auto thread = profile(bolt, column, 9), hole = profile(nut, column, 9);
    REQUIRE(thread.size() > 4 * 20);
    REQUIRE(hole.size() > 4 * 6);
    for (const int turns : {0, 3, 13}) {
      for (const Corner& c : hole) CHECK(c.r - radiusAt(thread, c.z + turns * pitch) > 0.99 * clearance);
      // Half a pitch off, the nut's crests would sit in the bolt's.
      double least = 1;
      for (const Corner& c : hole) least = std::min(least, c.r - radiusAt(thread, c.z + (turns + 0.5) * pitch));
      CHECK(least < -0.5);
    }
  }
}
