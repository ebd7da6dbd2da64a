// SPDX-License-Identifier: BSD-3-Clause
// Pairs of meshes, alone and in batches, on a simulated device: the contacts of the model `pairwise` are the host's.
#include "collide/stages.h"
#include "opencl/published/published_design.h"
#include "simulator/simulated_device.h"
#include "support/solid_batches.h"

using namespace otg;
using namespace otg::scenes;
using namespace otg::test;

namespace {

/// Boxes on each other, turned and aligned; a fine mesh through a coarse one.
std::vector<Query> somePairs(const MeshList& meshes) {
  return {makeQuery(*meshes[0], *meshes[0], makePose({0, 0, 1}, 0.5, {0, 0, 0.999})),
          makeQuery(*meshes[0], *meshes[1], makePose({0.48, 0.6, 0.64}, 1, {0.2, 0.1, 0.9})),
          makeQuery(*meshes[1], *meshes[1], makePose({0.48, 0.6, 0.64}, 0.7, {0.6, 0.4, 0.1}))};
}

MeshList someMeshes() {
  return {collisionMesh(makeBox({1, 1, 1}, 1)), collisionMesh(makeLump(1, 2, 0.2, 3))};
}

}  // namespace

TEST_CASE("single pairs are walked and reduced as on the host") {
  const MeshList meshes = someMeshes();
  opencl::Tuning tuning = simulated();
  SECTION("by one work-group where hits are few") {}
  SECTION("by the kernels for many hits") {
    tuning.fewHits = 8;
  }
  const auto backend = openSimulated(tuning);
  for (Query query : somePairs(meshes)) {
    checkParity(*backend, query);
    query.options.maxContacts = 3;
    checkParity(*backend, query);  // the second time it knows how many hits there are
  }
  CHECK(backend->counts().onHost == 0);
}

TEST_CASE("a device without doubles finds the host's pairs") {
  const MeshList meshes = someMeshes();
  opencl::Tuning tuning = simulated();
  tuning.doubles = false;
  const auto backend = openSimulated(tuning);
  for (const Query& query : somePairs(meshes)) checkParity(*backend, query);
  CHECK(backend->counts().onHost == 0);
}

TEST_CASE("walks stop at too many hits, and the host does the pair") {
  const MeshList meshes = someMeshes();
  const std::vector<Query> queries = somePairs(meshes);
  opencl::Tuning tuning = simulated();
  tuning.mostHits = tuning.batchHits = 8;
  const auto backend = openSimulated(tuning);
  for (const Query& query : queries) checkParity(*backend, query);
  checkBatch(*backend, queries, onHost(queries));
  CHECK(backend->counts().onHost == 0);
  CHECK(backend->counts().leftToHost > 0);
}

TEST_CASE("levels are opened breadth-first where cuts do not hold all triangles") {
  const auto lump = collisionMesh(makeLump(1, 4, 0.2, 3)), box = collisionMesh(makeBox({0.5, 0.5, 0.5}, 1));
  opencl::Tuning tuning = simulated();
  tuning.levelTriangles = 0;
  const auto backend = openSimulated(tuning);
  checkParity(*backend, makeQuery(*lump, *box, makePose({0.48, 0.6, 0.64}, 1, {0.8, 0.1, 0.9})));
  CHECK(backend->counts().onHost == 0);
}

TEST_CASE("one phase on the simulated device finds the host's pairs") {
  const MeshList meshes = someMeshes();
  const auto backend = openSimulated(simulated());
  const Query query = somePairs(meshes)[1];
  Workspace device, host;
  collide(query, host);
  CHECK(backend->findIntersectingPairs(query, device));
  CHECK(device.intersecting == host.intersecting);
  CHECK(backend->findCandidates(query, device));
  nearPhase(query, device);
  std::sort(device.intersecting.begin(), device.intersecting.end());
  CHECK(device.intersecting == host.intersecting);
}

TEST_CASE("levels find the host's contacts on the simulated device") {
  const MeshList meshes = someMeshes();
  const auto backend = openSimulated(simulated());
  const Query query = somePairs(meshes)[1];
  Workspace device, host;
  collide(query, host);
  for (const bool fused : {true, false}) {
    opencl::LevelsOptions how;
    how.startDepth = 2;
    how.fusedNear = fused;
    CHECK(backend->published().collideByLevels(query, device, how));
    checkSame(device, host);
  }
}

TEST_CASE("phases apart find the host's contacts on the simulated device") {
  const MeshList meshes = someMeshes();
  const auto backend = openSimulated(simulated());
  const Query query = somePairs(meshes)[1];
  Workspace device, host;
  collide(query, host);
  opencl::LevelsOptions how;
  how.startDepth = 2;
  for (const auto way : {opencl::PrefixSums::kWorkEfficient, opencl::PrefixSums::kSinglePass}) {
    how.sendTrees = way == opencl::PrefixSums::kSinglePass;
    how.prefixSums = way;
    CHECK(backend->published().findCandidatesByLevels(query, device, how));
    CHECK(backend->published().collideCandidates(
        query, device, how.sendTrees ? opencl::NearOrder::kContactsFirst : opencl::NearOrder::kFilterFirst));
    checkSame(device, host);
  }
}

TEST_CASE("batches of pairs are walked and reduced as on the host") {
  const MeshList meshes = someMeshes();
  opencl::Tuning tuning = simulated();
  SECTION("by work-groups of the usual sizes") {}
  SECTION("by those for many hits") {
    tuning.smallHits = 16;
    tuning.mediumHits = 64;
  }
  const auto backend = openSimulated(tuning);
  std::vector<Query> queries = somePairs(meshes);
  queries.push_back(queries.back());
  queries.back().options.maxContacts = 3;
  checkBatch(*backend, queries, onHost(queries));
}

TEST_CASE("batches are asked for yes or no") {
  const MeshList meshes = someMeshes();
  const auto backend = openSimulated(simulated());
  std::vector<Query> queries = somePairs(meshes);
  queries.push_back(makeQuery(*meshes[0], *meshes[1], makePose({0, 0, 1}, 1, {0, 0, 3})));
  queries.push_back(makeQuery(*meshes[0], *meshes[0], makePose({0, 0, 1}, 0, {0, 0, 1})));  // face to face
  std::vector<std::uint8_t> answer;
  CHECK(backend->intersectBatch(queries, answer));
  Workspace host;
  for (std::size_t i = 0; i < queries.size(); ++i) {
    findIntersectingPairs(queries[i], host);
    CHECK((answer[i] != 0) == !host.intersecting.empty());
  }
}
