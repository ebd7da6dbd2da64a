// SPDX-License-Identifier: BSD-3-Clause
// Distances of meshes by their trees, and by all pairs of triangles tried one by one.
#include <cmath>

#include "base/vectors.h"
#include "collide/pair_frame.h"
#include "queries/mesh_distance.h"
#include "queries/mesh_overlap.h"
#include "queries/triangle_distance.h"
#include "support/catch.h"
#include "support/contact_samples.h"
#include "support/distance_samples.h"
#include "support/draw.h"

using namespace otg;
using namespace otg::test;

namespace {

/// The nearest triangles, ties by their numbers.
MeshDistance oneByOne(const Query& query) {
  MeshDistance best;
  for (std::uint32_t s = 0; s < query.a->mesh().triangleCount(); ++s) {
    if (query.a->mesh().isDegenerate(s)) continue;
    Vec3d a[3], b[3];
    cornersOfA(query.a->mesh(), s, a);
    for (std::uint32_t t = 0; t < query.b->mesh().triangleCount(); ++t) {
      if (query.b->mesh().isDegenerate(t)) continue;
      cornersOfB(query.b->mesh(), query.bInA, t, b);
      const PointPair found = closestOnTriangles(a, b);
      const double distance = std::sqrt(found.distance2);
      if (!best.found || distance < best.distance) best = {true, distance, found.a, found.b, s, t};
    }
  }
  return best;
}

bool same(const MeshDistance& x, const MeshDistance& y) {
  const auto equal = [](const Vec3d& p, const Vec3d& q) { return p.x == q.x && p.y == q.y && p.z == q.z; };
  return x.found == y.found && x.distance == y.distance && x.triangleA == y.triangleA && x.triangleB == y.triangleB &&
         equal(x.pointA, y.pointA) && equal(x.pointB, y.pointB);
}

}  // namespace

TEST_CASE("the distance of meshes is that of all pairs of triangles, whatever the tree") {
  Draw draw(4);
  const std::vector<samples::NamedMesh> meshes = samples::meshesForDistances();
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  int apart = 0, meeting = 0, beyond = 0;
  for (const auto& [nameA, meshA] : meshes) {
    const CollisionMesh a(meshA, BuildStrategy::kSah), otherA(meshA, BuildStrategy::kMeanSplit);
    for (const auto& [nameB, meshB] : meshes) {
      const CollisionMesh b(meshB, BuildStrategy::kSah), otherB(meshB, BuildStrategy::kMeanSplit);
      for (int i = 0; i < 6; ++i) {
        Query query, other;
        query.bInA = samples::poseForDistance(*meshA, *meshB, draw, i);
        other.bInA = query.bInA;
        query.a = &a, query.b = &b;
        other.a = &otherA, other.b = &otherB;
        Vec3d vertex{};
        TrianglePair pair{};
        if (findMeeting(query, pair) || containedVertex(query, vertex)) {
          CHECK(meshDistance(query, kInfinity).distance == 0);
          ++meeting;
          continue;
        }
        INFO(nameA << " and " << nameB << ", pose " << i);
        const MeshDistance expected = oneByOne(query), found = meshDistance(query, kInfinity);
        CHECK(same(found, expected));
        CHECK(same(meshDistance(other, kInfinity), expected));
        ++apart;
        if (!expected.found) continue;
        CHECK(same(meshDistance(query, expected.distance), expected));  // a limit is a limit
        CHECK(same(meshDistance(other, 2 * expected.distance), expected));
        if (expected.distance > 0) {
          CHECK_FALSE(meshDistance(query, expected.distance * (1 - 1e-15)).found);
          ++beyond;
        }
      }
    }
  }
  CHECK(apart > 200);
  CHECK(meeting > 20);
  CHECK(beyond > 200);
}

TEST_CASE("nearest points lie on their triangles, slivers among them") {
  Draw draw(6);
  for (int i = 0; i < 20000; ++i) {
    Vec3d t[3] = {draw.inBox(1), draw.inBox(1), {}};
    const double hair = std::pow(10, draw.uniform(-17, 0));
    t[2] = otgAdd(otgAdd(t[0], otgScale(otgSub(t[1], t[0]), draw.uniform(0, 1))), otgScale(draw.inBox(1), hair));
    const Vec3d p = otgScale(draw.inBox(1), std::pow(10, draw.uniform(-1, 2)));
    const Vec3d on = otgPointOnTriangle(t[0], t[1], t[2], p);
    // No farther than that from the triangle's chords through a corner, which are at most so far apart as it is wide.
    const double reach = 2e-10 * (norm(p) + 2);
    double nearest = 1e30;
    for (int k = 0; k <= 400; ++k) {
      const Vec3d across = otgAdd(t[0], otgScale(otgSub(t[2], t[0]), k / 400.0));
      const PointPair chord = closestOnSegments(t[1], across, on, on);
      nearest = std::min(nearest, std::sqrt(chord.distance2));
    }
    REQUIRE(nearest < reach + hair);
  }
}
