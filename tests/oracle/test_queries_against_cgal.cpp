// SPDX-License-Identifier: BSD-3-Clause
// Nearest points, sides, rays and distances of generated meshes against CGAL's.
#include <numbers>

#include "base/vectors.h"
#include "oracle/cgal_queries.h"
#include "queries/mesh_distance.h"
#include "queries/mesh_overlap.h"
#include "queries/ray_cast.h"
#include "queries/surface_side.h"
#include "scenes/generated_meshes.h"
#include "support/catch.h"
#include "support/draw.h"

using namespace otg;
using namespace otg::scenes;
using namespace otg::test;

namespace {

constexpr double kPi = std::numbers::pi;

struct Named {
  const char* name;
  MeshArrays arrays;
};

std::vector<Named> meshes() {
  const auto hills = [](double x, double y) { return 0.2 * std::sin(2 * x) * std::cos(3 * y); };
  return {{"box", makeBox({1, 0.7, 0.4}, 2)},         {"sphere", makeSphere(0.7, 4)},
          {"lump", makeLump(0.6, 4, 0.3, 5)},         {"torus", makeTorus(0.5, 0.2, 40, 24)},
          {"gear", makeGear(9, 0.6, 0.15, 0.2, 0.2)}, {"bowl", makeBowl(0.8, 0.1, 24, 8)},
          {"ground", makeGround(2, 0.3, 16, hills)},  {"bolt", makeBolt(0.3, 0.1, 0.6, 24)},
          {"cylinder", makeCylinder(0.3, 1.6, 20, 4)}};
}

Vec3d middleOf(const TriMesh& mesh) {
  return {mesh.center().x, mesh.center().y, mesh.center().z};
}

}  // namespace

TEST_CASE("distances and sides of points are CGAL's") {
  Draw draw(1);
  for (const Named& named : meshes()) {
    const CollisionMesh mesh(build(named.arrays), BuildStrategy::kSah);
    const CgalSurface truth(mesh.mesh(), makeMove({0, 0, 0}));
    const double size = mesh.mesh().radius();
    int inside = 0;
    for (int i = 0; i < 2000; ++i) {
      const Vec3d p = otgAdd(middleOf(mesh.mesh()), draw.inBox((i % 4 == 0 ? 3 : 1) * size));
      const SurfacePoint found = closestPoint(mesh, p);
      INFO(named.name << " point " << i);
      REQUIRE(std::abs(found.distance - truth.distance(p)) < 1e-12 * size);
      REQUIRE(std::abs(norm(otgSub(found.point, p)) - found.distance) < 1e-12 * size);
      REQUIRE(truth.distance(found.point) < 1e-12 * size);
      const bool isIn = truth.isInside(p);
      REQUIRE(isInside(mesh, p, found) == isIn);
      inside += isIn ? 1 : 0;
    }
    CHECK(inside > 10);
  }
}

TEST_CASE("rays go through a surface where CGAL's do") {
  Draw draw(2);
  for (const Named& named : meshes()) {
    const CollisionMesh mesh(build(named.arrays), BuildStrategy::kSah);
    const CgalSurface truth(mesh.mesh(), makeMove({0, 0, 0}));
    const double size = mesh.mesh().radius();
    std::size_t several = 0;
    std::vector<RayHit> hits;
    for (int i = 0; i < 2000; ++i) {
      RayCast cast;
      // From inside, from near by and from far away.
      const double away = i % 8 == 0 ? 1e4 : i % 2 == 0 ? 3 : 0.5;
      cast.ray.origin = otgAdd(middleOf(mesh.mesh()), otgScale(draw.direction(), away * size));
      const Vec3d way = otgSub(otgAdd(middleOf(mesh.mesh()), draw.inBox(0.7 * size)), cast.ray.origin);
      cast.ray.direction = otgScale(way, 1 / norm(way));
      cast.length = 1e5 * size;
      cast.mode = RayMode::kAll;
      castRay(mesh, cast, hits);
      const std::vector<double> expected = truth.hits(cast.ray.origin, cast.ray.direction);
      INFO(named.name << " ray " << i);
      REQUIRE(hits.size() == expected.size());
      several += hits.size() > 2 ? 1 : 0;
      for (std::size_t k = 0; k < hits.size(); ++k) {
        // Oblique triangles stretch the rounding of the origin's distance.
        REQUIRE(std::abs(hits[k].distance - expected[k]) < 1e-10 * (away + 1) * size);
      }
      cast.mode = RayMode::kClosest;
      const std::vector<RayHit> all = hits;
      castRay(mesh, cast, hits);
      REQUIRE(hits.size() == std::min<std::size_t>(all.size(), 1));
      if (!hits.empty()) REQUIRE(hits[0].distance == all[0].distance);
    }
    if (named.name == std::string("torus") || named.name == std::string("gear")) CHECK(several > 50);
  }
}

TEST_CASE("distances of two meshes are CGAL's least over all pairs of triangles") {
  Draw draw(3);
  const MeshArrays arrays[] = {makeLump(0.5, 2, 0.3, 3), makeTorus(0.5, 0.2, 16, 8), makeBox({1, 0.7, 0.4}, 2),
                               makeGear(7, 0.6, 0.15, 0.2, 0.2)};
  int apart = 0, meeting = 0;
  for (const MeshArrays& first : arrays) {
    const CollisionMesh a(build(first), BuildStrategy::kSah);
    const CgalSurface truthA(a.mesh(), makeMove({0, 0, 0}));
    for (const MeshArrays& second : arrays) {
      const CollisionMesh b(build(second), BuildStrategy::kSah);
      for (int i = 0; i < 3; ++i) {
        Query query;
        query.a = &a;
        query.b = &b;
        query.bInA =
            makePose(draw.direction(), draw.uniform(-kPi, kPi), otgScale(draw.direction(), draw.uniform(0.3, 2)));
        const double expected = truthA.distance(CgalSurface(b.mesh(), query.bInA));
        const MeshDistance found = meshDistance(query, std::numeric_limits<double>::infinity());
        REQUIRE(found.found);
        if (expected > 0 && found.distance == 0) {
          REQUIRE(found.triangleA == kNone);  // one inside the other
          continue;
        }
        INFO("expected " << expected << " found " << found.distance);
        REQUIRE(std::abs(found.distance - expected) < 1e-12);
        REQUIRE(overlap(query) == (expected == 0));
        REQUIRE(std::abs(norm(otgSub(found.pointA, found.pointB)) - found.distance) < 1e-12);
        REQUIRE(truthA.distance(found.pointA) < 1e-12);
        (expected > 0 ? apart : meeting) += 1;
      }
    }
  }
  CHECK(apart > 15);
  CHECK(meeting > 3);
}
