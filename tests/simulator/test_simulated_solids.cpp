// SPDX-License-Identifier: BSD-3-Clause
// Batches of solids, and of solids on sheets, on a simulated device with work-groups as GPUs have them: the contacts
// are the host's.
#include "scenes/concave_meshes.h"
#include "scenes/height_grid.h"
#include "simulator/simulated_device.h"
#include "support/solid_batches.h"

using namespace otg;
using namespace otg::scenes;
using namespace otg::test;

TEST_CASE("the contacts of solids in a batch are the host's") {
  const MeshList meshes = {collisionMesh(makeTetrahedron({0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1})),
                           collisionMesh(makeBox({1, 1.5, 0.8}, 1)), collisionMesh(makeSphere(0.8, 1))};
  opencl::Tuning tuning = simulated();
  std::vector<Query> queries = touching(meshes, 1, 6, 0.01, 0.3);
  SECTION("by work-groups for small overlaps and for large ones") {
    tuning.solidHits = 16;
  }
  SECTION("by work-groups of one size") {
    tuning.solidSizes = 1;
  }
  const auto backend = openSimulated(tuning);
  CHECK(checkBatch(*backend, queries, onHost(queries)) >= 5);
}

TEST_CASE("boxes that stand on each other have the host's contacts") {
  const MeshList meshes = {collisionMesh(makeBox({1, 1, 1}, 1)), collisionMesh(makeBox({2, 2, 0.5}, 2))};
  std::vector<Query> queries;
  for (int i = 0; i < 3; ++i) {
    Query query = makeQuery(*meshes[1], *meshes[0], makePose({0, 0, 1}, 0.4 * i, {0.1 * i, 0, 0.749}));
    query.options.contacts = ContactModel::kSolid;
    query.options.maxContacts = 4 + 4 * i;
    queries.push_back(query);
  }
  const auto backend = openSimulated(simulated());
  CHECK(checkBatch(*backend, queries, onHost(queries)) == 3);
}

TEST_CASE("boxes in an inner corner, whose parts leave by several faces, have the host's contacts") {
  const MeshList meshes = {collisionMesh(makeCorner(2, 0.5, 2)), collisionMesh(makeBox({0.6, 0.5, 0.4}, 1))};
  std::vector<Query> queries;
  for (int i = 0; i < 3; ++i) {
    const Vec3d place = {0.79 - 0.004 * i, 0.2 * i, 0.695 - 0.003 * i};
    Query query = makeQuery(*meshes[0], *meshes[1], makePose({0.1, 1, 0.2}, 0.01 * i, place));
    query.options.contacts = ContactModel::kSolid;
    query.options.maxContacts = 16;
    Workspace workspace;
    collide(query, workspace);
    CHECK(workspace.stats.unevenRegions == 1);
    queries.push_back(query);
  }
  const auto backend = openSimulated(simulated());
  CHECK(checkBatch(*backend, queries, onHost(queries)) == 3);
}

TEST_CASE("solids on a sheet have the host's contacts") {
  HeightGrid grid;
  grid.sizeX = grid.sizeY = 4;
  grid.columns = grid.rows = 5;
  setRoughHeights(grid, 0.2, 1.2, 1);
  const auto ground = collisionMesh(sheetOf(grid)), box = collisionMesh(makeBox({1, 1, 1}, 1));
  std::vector<Query> queries;
  for (int i = 0; i < 3; ++i) {
    Query query = makeQuery(*ground, *box, makePose({0.48, 0.6, 0.64}, 0.4 * i, {1.5 * (i - 1), 0.2, 0.5}));
    query.options.contacts = ContactModel::kSolid;
    query.options.maxContacts = 8;
    queries.push_back(query);
  }
  const auto backend = openSimulated(simulated());
  CHECK(checkBatch(*backend, queries, onHost(queries)) >= 2);
}
