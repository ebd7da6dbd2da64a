// SPDX-License-Identifier: BSD-3-Clause
// Meshes with triangles so thin that double arithmetic loses their normals: every contact has a unit normal and finite
// numbers, and so has every query.
#include <algorithm>
#include <cmath>
#include <limits>

#include "base/vectors.h"
#include "collide/inside_test.h"
#include "collide/query.h"
#include "queries/closest_point.h"
#include "queries/mesh_distance.h"
#include "queries/ray_cast.h"
#include "queries/surface_side.h"
#include "scenes/generated_meshes.h"
#include "support/catch.h"
#include "support/draw.h"

using namespace otg;
using namespace otg::scenes;
using namespace otg::test;

namespace {

bool isFinite(const Vec3d& v) {
  return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}

/// A mesh whose edges are divided on one side and not on the other, as boolean operations leave them. The gaps are
/// closed by triangles of two points of an edge and one that is off it by single bits.
MeshArrays withSlivers(MeshArrays mesh, Draw& draw, std::uint32_t slivers) {
  for (std::uint32_t i = 0; i < slivers; ++i) {
    const std::uint32_t t = draw.below(static_cast<std::uint32_t>(mesh.triangles.size()));
    const Triangle old = mesh.triangles[t];
    const Vec3f a = mesh.vertices[old.v[0]], b = mesh.vertices[old.v[1]];
    Vec3f middle = otgScale(otgAdd(a, b), 0.5f);
    float* const parts[] = {&middle.x, &middle.y, &middle.z};
    float& part = *parts[draw.below(3)];
    switch (draw.below(4)) {
      case 0:
        part = std::nextafter(part, 10.0f);
        break;
      case 1:
        part += part == 0 ? 1e-45f : 0;
        break;
      case 2:
        part += part == 0 ? 1e-30f : 0;
        break;
      default:
        break;
    }
    const auto v = static_cast<std::uint32_t>(mesh.vertices.size());
    mesh.vertices.push_back(middle);
    mesh.triangles[t] = {{old.v[0], v, old.v[2]}};
    mesh.triangles.push_back({{v, old.v[1], old.v[2]}});
    mesh.triangles.push_back({{old.v[0], old.v[1], v}});
  }
  return mesh;
}

/// Long triangles about the middle of a plane, off it by single bits.
MeshArrays thinSoup(Draw& draw, std::uint32_t triangles) {
  MeshArrays soup;
  for (std::uint32_t i = 0; i < triangles; ++i) {
    const Vec3d from = draw.inBox(0.5), along = draw.inBox(1);
    for (const double at : {0.0, 1.0, draw.uniform(0, 1)}) {
      const Vec3d p = otgAdd(from, otgScale(along, at));
      soup.vertices.push_back({static_cast<float>(p.x), static_cast<float>(p.y), static_cast<float>(p.z)});
    }
    // Along an axis, and in a plane through it.
    if (i % 3 == 0) {
      for (std::uint32_t k = 0; k < 3; ++k) {
        soup.vertices[3 * i + k].y = k == 2 ? 1e-44f : 0;
        soup.vertices[3 * i + k].z = 0;
      }
    }
    soup.triangles.push_back({{3 * i, 3 * i + 1, 3 * i + 2}});
  }
  return soup;
}

}  // namespace

TEST_CASE("contacts of meshes with the thinnest triangles have unit normals and finite numbers") {
  Draw draw(1);
  std::size_t contacts = 0, solids = 0;
  for (int round = 0; round < 300; ++round) {
    const auto one = [&] {
      switch (draw.below(4)) {
        case 0:
          return withSlivers(makeBox({1, 0.8, 0.6}, 2), draw, 12);
        case 1:
          return withSlivers(makeSphere(0.6, 2), draw, 20);
        case 2:
          return withSlivers(makeGround(1, 0.3, 4), draw, 12);
        default:
          return thinSoup(draw, 40);
      }
    };
    const CollisionMesh a(build(one()), BuildStrategy::kSah), b(build(one()), BuildStrategy::kSah);
    solids += a.mesh().report().solid;
    Query query;
    query.a = &a;
    query.b = &b;
    query.bInA =
        round % 3 == 0 ? makeMove(draw.inBox(0.5)) : makePose(draw.direction(), draw.uniform(-3, 3), draw.inBox(0.5));
    if (round % 9 == 0) query.bInA = makeMove({0, 0, 0});
    for (const ContactModel model : {ContactModel::kPairwise, ContactModel::kSolid}) {
      for (const Reduction method : {Reduction::kNone, Reduction::kCone}) {
        query.options.contacts = model;
        query.options.reduction.method = method;
        query.options.maxContacts = 4096;
        Workspace workspace;
        collide(query, workspace);
        for (const Contact& c : workspace.reduced) {
          REQUIRE(isFinite(c.position));
          REQUIRE(std::abs(norm(c.normal) - 1) < 1e-9);
          REQUIRE(std::isfinite(c.depth));
          REQUIRE(c.depth >= 0);
        }
        contacts += workspace.reduced.size();
      }
    }
    const MeshDistance distance = meshDistance(query, std::numeric_limits<double>::infinity());
    REQUIRE(distance.found);
    REQUIRE(isFinite(distance.pointA));
    REQUIRE(isFinite(distance.pointB));
  }
  CHECK(contacts > 10000);
  CHECK(solids > 50);
}

TEST_CASE("points and rays find finite answers on the thinnest triangles") {
  Draw draw(2);
  std::size_t hitCount = 0;
  for (int round = 0; round < 60; ++round) {
    const CollisionMesh mesh(
        build(round % 2 == 0 ? thinSoup(draw, 40) : withSlivers(makeBox({1, 0.8, 0.6}, 2), draw, 20)),
        BuildStrategy::kSah);
    for (std::uint32_t t = 0; t < mesh.mesh().triangleCount(); ++t) {
      const double length = norm(faceNormal(mesh.mesh(), t));
      REQUIRE((mesh.mesh().isDegenerate(t) ? length == 0 : std::abs(length - 1) < 1e-9));
      REQUIRE((mesh.adjacency().area[t] > 0) == !mesh.mesh().isDegenerate(t));
    }
    for (int i = 0; i < 200; ++i) {
      const double far = i % 5 == 0 ? 1e20 : 1;
      const Vec3d p = otgScale(draw.inBox(1), far);
      const SurfacePoint on = closestPoint(mesh, p);
      REQUIRE(on.triangle != kNone);
      REQUIRE(isFinite(on.point));
      REQUIRE(std::abs(norm(outwardNormal(mesh, on)) - 1) < 1e-9);
      RayCast cast;
      cast.ray = {draw.inBox(2), draw.direction()};
      if (i % 3 == 0) cast.ray = {{0, 0, i % 2 == 0 ? 0.0 : 1e-300}, {1, 0, 0}};
      cast.length = 10;
      cast.mode = RayMode::kAll;
      cast.filter = [](std::uint32_t, double u, double v) {
        REQUIRE(std::isfinite(u));
        REQUIRE(std::isfinite(v));
        return true;
      };
      std::vector<RayHit> hits;
      castRay(mesh, cast, hits);
      for (const RayHit& hit : hits) REQUIRE((hit.distance >= 0 && hit.distance <= 10));
      hitCount += hits.size();
    }
  }
  CHECK(hitCount > 1000);
}

TEST_CASE("a box with slivers along its edges holds the points that it holds without them") {
  Draw draw(3);
  const CollisionMesh plain(build(makeBox({1, 0.8, 0.6}, 2)), BuildStrategy::kSah);
  for (int round = 0; round < 20; ++round) {
    const CollisionMesh mesh(build(withSlivers(makeBox({1, 0.8, 0.6}, 2), draw, 30)), BuildStrategy::kSah);
    for (int i = 0; i < 2000; ++i) {
      const Vec3d p = draw.inBox(0.7);
      REQUIRE(pointInMesh(mesh, p) == pointInMesh(plain, p));
    }
  }
}
