// SPDX-License-Identifier: BSD-3-Clause
// Rays against a mesh by its tree, and against every triangle tried one by one.
#include <algorithm>
#include <cmath>
#include <set>

#include "base/vectors.h"
#include "collide/inside_test.h"
#include "scenes/generated_meshes.h"
#include "support/catch.h"
#include "support/ray_samples.h"

using namespace otg;
using namespace otg::samples;

namespace {

/// Nearest first, ties by triangle.
std::vector<RayHit> oneByOne(const TriMesh& mesh, const LongRay& ray) {
  const TriangleRay alone(mesh, ray.ray);
  std::vector<RayHit> hits;
  for (std::uint32_t t = 0; t < mesh.triangleCount(); ++t) {
    RayHit hit;
    if (mesh.isDegenerate(t) || !alone.hits(t, hit)) continue;
    if (hit.distance <= ray.length) hits.push_back(hit);
  }
  std::sort(hits.begin(), hits.end(), [](const RayHit& x, const RayHit& y) {
    return std::pair(x.distance, x.triangle) < std::pair(y.distance, y.triangle);
  });
  return hits;
}

/// Hits that follow each other closely on one side, each of them at a triangle that has a corner with an earlier one,
/// are one: a slow way to what castRay() gives. `hits`: as oneByOne() lists them.
std::vector<RayHit> merged(const TriMesh& mesh, const std::vector<RayHit>& hits) {
  const double same = 1e-9 * static_cast<double>(mesh.radius());
  std::vector<RayHit> kept;
  std::vector<std::set<std::uint32_t>> corners;  // of each that is kept, of all its triangles
  for (const RayHit& hit : hits) {
    std::set<std::uint32_t> own;
    for (const std::uint32_t v : mesh.triangles()[hit.triangle].v) own.insert(mesh.topology().weld[v]);
    std::size_t i = kept.size();
    for (; i > 0 && hit.distance - kept[i - 1].distance <= same; --i) {
      const auto isShared = [&](std::uint32_t v) { return corners[i - 1].count(v) > 0; };
      if (kept[i - 1].back == hit.back && std::any_of(own.begin(), own.end(), isShared)) break;
    }
    if (i > 0 && hit.distance - kept[i - 1].distance <= same) {
      kept[i - 1].triangle = std::min(kept[i - 1].triangle, hit.triangle);
      corners[i - 1].insert(own.begin(), own.end());
    } else {
      kept.push_back(hit);
      corners.push_back(own);
    }
  }
  return kept;
}

}  // namespace

TEST_CASE("a ray that would take for ever to its triangle does not hit it") {
  const Vec3d a{0, 0, 0}, b{1, 0, 0}, c{0, 1, 0}, from{0.25, 0.25, -1e-7};
  for (const double speed : {1e-320, 1.0}) {
    const Vec3d d{0, 0, speed}, along = otgRayAlong(d), inverse{1 / along.x, 1 / along.y, 1 / along.z};
    double at = 0;
    CHECK((otgRayHitsTriangle(from, d, along, inverse, a, b, c, 1e-6, &at) != 0) == (speed == 1));
  }
}

TEST_CASE("the hit of a ray is that of all triangles tried one by one, whatever the tree") {
  std::size_t hit = 0, missed = 0, tied = 0, several = 0, joined = 0;
  for (const auto& [name, mesh] : meshesToHit()) {
    const CollisionMesh sah(mesh, BuildStrategy::kSah), mean(mesh, BuildStrategy::kMeanSplit);
    const std::size_t count = std::clamp<std::size_t>(800000 / (mesh->triangleCount() + 1), 16, 1600);
    std::size_t number = 0, wrong = 0;
    for (const LongRay& ray : raysFor(*mesh, 5, count)) {
      std::vector<RayHit> expected = oneByOne(*mesh, ray);
      for (const bool cullBack : {false, true}) {
        if (cullBack) std::erase_if(expected, [](const RayHit& h) { return h.back; });
        ++(expected.empty() ? missed : hit);
        tied += expected.size() > 1 && expected[0].distance == expected[1].distance ? 1 : 0;
        RayCast cast{ray.ray, ray.length, RayMode::kClosest, cullBack, {}};
        const RayHit first = expected.empty() ? RayHit() : expected[0];
        for (const CollisionMesh* tree : {&sah, &mean}) {
          INFO(name << ", ray " << number << (cullBack ? ", culled" : ""));
          cast.mode = RayMode::kClosest;
          if (castForOne(*tree, cast) == first) continue;
          ++wrong;
          CHECK(castForOne(*tree, cast).triangle == first.triangle);
          CHECK(castForOne(*tree, cast).distance == first.distance);
        }
        cast.mode = RayMode::kAny;
        const RayHit any = castForOne(sah, cast);
        CHECK((expected.empty() ? any.triangle == kNone
                                : std::find(expected.begin(), expected.end(), any) != expected.end()));
        cast.mode = RayMode::kAll;
        std::vector<RayHit> all, again;
        castRay(sah, cast, all);
        castRay(mean, cast, again);
        CHECK(all == again);
        if (expected.size() < 100 || number % 32 == 0) CHECK(all == merged(*mesh, expected));
        several += all.size() > 2;
        joined += all.size() < expected.size();
      }
      ++number;
      REQUIRE(wrong < 5);
    }
  }
  CHECK(hit > 5000);
  CHECK(missed > 5000);
  CHECK(tied > 1000);
  CHECK(several > 100);
  CHECK(joined > 100);
}

TEST_CASE("the way out of a solid along a ray that grazes triangles is the same with every tree") {
  test::Draw draw(11);
  std::size_t out = 0, differ = 0;
  for (const std::uint32_t seed : {1u, 2u, 3u, 4u}) {
    const auto mesh = scenes::build(scenes::makeLump(1, 3, 0.3, seed));
    const CollisionMesh sah(mesh, BuildStrategy::kSah), mean(mesh, BuildStrategy::kMeanSplit);
    Query query;
    query.a = &sah;
    query.b = &mean;
    query.bInA = {{1, 0, 0, 0, 1, 0, 0, 0, 1}, {0, 0, 0}};
    const PlacedMeshes meshes(query);
    for (int k = 0; k < 20000; ++k) {
      // In a triangle's plane to within rounding: where such a ray crosses it is what rounding makes of it.
      Vec3d p[3];
      cornersOf(*mesh, draw.below(mesh->triangleCount()), p);
      const Vec3d e = otgSub(p[1], p[0]), f = otgSub(p[2], p[0]);
      const Vec3d target = otgAdd(p[0], otgAdd(otgScale(e, draw.uniform(0, 0.5)), otgScale(f, draw.uniform(0, 0.5))));
      const Vec3d d = unit(otgAdd(otgScale(e, draw.uniform(-1, 1)), otgScale(f, draw.uniform(-1, 1))));
      const Vec3d from = otgSub(target, otgScale(d, draw.uniform(0, 4)));
      const double first = exitDistance(meshes, 0, from, d, 10, 1e-9),
                   second = exitDistance(meshes, 1, from, d, 10, 1e-9);
      out += first > 0;
      differ += first != second;
    }
  }
  CHECK(out > 3000);
  CHECK(differ == 0);
}

TEST_CASE("a ray that grazes a triangle hits it no earlier than where it comes near it") {
  test::Draw draw(3);
  int hits = 0, wild = 0;
  for (int i = 0; i < 300; ++i) {
    Soup soup;
    const auto corner = [&] {
      const Vec3d p = draw.inBox(1);
      return Vec3f{static_cast<float>(p.x), static_cast<float>(p.y), static_cast<float>(p.z)};
    };
    soup.add(corner(), corner(), corner());
    const auto mesh = soup.build();
    if (mesh->isDegenerate(0)) continue;
    Vec3d p[3];
    cornersOf(*mesh, 0, p);
    for (int k = 0; k < 100; ++k) {
      // In the triangle's plane to within rounding, from outside of it.
      const Vec3d e = otgSub(p[1], p[0]), f = otgSub(p[2], p[0]);
      const Vec3d target = otgAdd(p[0], otgAdd(otgScale(e, draw.uniform(0, 0.5)), otgScale(f, draw.uniform(0, 0.5))));
      Vec3d d = otgAdd(otgScale(e, draw.uniform(-1, 1)), otgScale(f, draw.uniform(-1, 1)));
      d = otgScale(d, 1 / norm(d));
      const MeshRay ray{otgSub(target, otgScale(d, draw.uniform(4, 9))), d};
      double crossing = 0;
      if (otgRayMeetsTriangle(ray.origin, d, p[0], p[1], p[2], &crossing) != 0 && crossing >= 0) {
        wild += std::fabs(crossing - std::sqrt(otgDot(otgSub(target, ray.origin), otgSub(target, ray.origin)))) > 4;
      }
      RayHit hit;
      if (!TriangleRay(*mesh, ray).hits(0, hit)) continue;
      ++hits;
      // Before its box is where the ray still has to get to it along some axis.
      const Vec3d at = otgAdd(ray.origin, otgScale(d, hit.distance));
      const Vec3d lo = otgLowest3(p[0], p[1], p[2]), hi = otgHighest3(p[0], p[1], p[2]);
      const double room = 1e-5;
      const bool before = (d.x > 0 ? at.x < lo.x - room : at.x > hi.x + room) ||
                          (d.y > 0 ? at.y < lo.y - room : at.y > hi.y + room) ||
                          (d.z > 0 ? at.z < lo.z - room : at.z > hi.z + room);
      REQUIRE_FALSE(before);
    }
  }
  CHECK(hits > 1000);
  CHECK(wild > 100);
}
