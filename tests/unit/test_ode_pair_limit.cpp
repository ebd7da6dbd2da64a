// SPDX-License-Identifier: BSD-3-Clause
// How many candidate pairs a query may have: up to the limit the answer is whole, beyond it there is none.
#include <memory>

#include "collide/query.h"
#include "support/catch.h"
#include "support/mesh_samples.h"
#include "support/ode_world.h"

using namespace otg;
using namespace otg::test;

namespace {

/// Triangles that lie on one another.
scenes::MeshArrays copies(int count) {
  scenes::MeshArrays arrays;
  arrays.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  arrays.triangles.assign(static_cast<std::size_t>(count), Triangle{{0, 1, 2}});
  return arrays;
}

int maxPairsOf(dGeomID geom) {
  dGpuTriMeshParams params;
  dGpuTriMeshParamsInit(&params);
  REQUIRE(dGeomGpuTriMeshGetParams(geom, &params) == dGPUTRIMESH_OK);
  return params.max_pairs;
}

int setMaxPairs(dGeomID geom, int count) {
  dGpuTriMeshParams params;
  dGpuTriMeshParamsInit(&params);
  params.max_pairs = count;
  return dGeomGpuTriMeshSetParams(geom, &params);
}

duint64 failuresOf(dGeomID geom) {
  dGpuTriMeshStats stats;
  dGpuTriMeshStatsInit(&stats);
  REQUIRE(dGeomGpuTriMeshGetStats(geom, &stats) == dGPUTRIMESH_OK);
  return stats.failed_queries;
}

}  // namespace

TEST_CASE("a query has its answer up to the limit and none beyond it, by every traversal") {
  const CollisionMesh a(scenes::build(scenes::makeTorus(1, 0.4, 40, 20)), BuildStrategy::kSah);
  const CollisionMesh b(scenes::build(scenes::makeLump(0.9, 4, 0.2, 7)), BuildStrategy::kSah);
  for (const Traversal traversal :
       {Traversal::kStandard, Traversal::kQuantized, Traversal::kNoLeaf, Traversal::kWide}) {
    Query query;
    query.a = &a;
    query.b = &b;
    query.bInA = {{1, 0, 0, 0, 1, 0, 0, 0, 1}, {0.3, 0.1, 0.2}};
    query.options.middle.traversal = traversal;
    Workspace workspace;
    findIntersectingPairs(query, workspace);
    const std::vector<TrianglePair> candidates = workspace.candidates, intersecting = workspace.intersecting;
    REQUIRE(candidates.size() > 2000);
    query.options.middle.maxPairs = static_cast<int>(candidates.size());
    findIntersectingPairs(query, workspace);
    CHECK(workspace.candidates == candidates);
    CHECK(workspace.intersecting == intersecting);
    for (const int fewer : {static_cast<int>(candidates.size()) - 1, 1000, 1}) {
      query.options.middle.maxPairs = fewer;
      CHECK_THROWS_AS(collide(query, workspace), TooManyPairs);
      CHECK(workspace.reduced.empty());
    }
  }
}

TEST_CASE("a pair of geoms with too many pairs of triangles fails, and the others do not") {
  const OdeSession ode;
  const Data data(copies(50)), box(scenes::makeBox({1, 1, 1}, 1));
  const Geom one(data), other(data), third(box);
  dGeomSetPosition(other.id, 0.1, 0.1, 0);
  dGeomSetPosition(third.id, 0.2, 0.2, 0.4);
  CHECK(maxPairsOf(one.id) == 1 << 24);
  for (const int wrong : {0, -1}) CHECK(setMaxPairs(one.id, wrong) == dGPUTRIMESH_ERROR_ARGUMENT);
  REQUIRE(setMaxPairs(one.id, 2500) == dGPUTRIMESH_OK);
  CHECK(!collide(one.id, other.id).empty());
  CHECK(failuresOf(one.id) == 0);

  REQUIRE(setMaxPairs(one.id, 2499) == dGPUTRIMESH_OK);
  const std::vector<dContactGeom> ofOthers = collide(third.id, other.id);
  REQUIRE(!ofOthers.empty());
  CHECK(collide(one.id, other.id).empty());
  CHECK(dGpuTriMeshGetError() == dGPUTRIMESH_ERROR_MEMORY);
  CHECK(collide(other.id, one.id).empty());
  CHECK(failuresOf(one.id) == 2);
  CHECK(failuresOf(other.id) == 2);

  const dGpuTriMeshPair pairs[] = {{one.id, other.id}, {third.id, other.id}};
  constexpr int kPlaces = 64;
  dContactGeom contacts[2 * kPlaces];
  int counts[2];
  const int count = dGpuTriMeshCollidePairs(pairs, 2, kPlaces, contacts, sizeof(dContactGeom), counts);
  REQUIRE(count == static_cast<int>(ofOthers.size()));
  CHECK(counts[0] == 0);
  CHECK(dGpuTriMeshGetError() == dGPUTRIMESH_ERROR_MEMORY);
  CHECK(sameContacts({contacts + kPlaces, contacts + kPlaces + counts[1]}, ofOthers));
  CHECK(failuresOf(one.id) == 3);
  CHECK(failuresOf(third.id) == 0);
}
