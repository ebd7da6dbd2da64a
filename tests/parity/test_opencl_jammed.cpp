// SPDX-License-Identifier: BSD-3-Clause
// Jammed pairs of solids: devices leave them to the host, one at a time and in batches, as long as they are leaving.
#include "collide/consistent_contacts.h"
#include "collide/solid/solid_contacts.h"
#include "scenes/concave_meshes.h"
#include "support/large_overlaps.h"
#include "support/slot_mesh.h"

using namespace otg;
using namespace otg::scenes;
using namespace otg::test;

namespace {

/// Pairs of which most are jammed.
std::vector<Query> jammedPairs(const MeshList& meshes, std::size_t count) {
  Draw draw(5);
  Workspace workspace;
  std::vector<Query> queries;
  while (queries.size() < count) {
    const auto any = [&]() -> const CollisionMesh& { return *meshes[draw.below(2)]; };
    const CollisionMesh &a = any(), &b = any();
    Query query = makeQuery(a, b, poseAround(draw, 0.1, 1.2));
    query.options.contacts = ContactModel::kSolid;
    query.options.maxContacts = 16;
    findIntersectingPairs(query, workspace);
    if (!solidContacts(query, workspace)) continue;
    if (cutContradictions(query, workspace.contacts) || queries.size() % 4 == 0) queries.push_back(query);
  }
  return queries;
}

/// With large regions from two levels of subdivision on.
MeshList bowlAndGear(int levels) {
  return {collisionMesh(subdivided(makeBowl(1, 0.1, 16, 8), levels)),
          collisionMesh(subdivided(makeGear(12, 1, 0.2, 0.4, 0.3), levels))};
}

int countJammed(const std::vector<Query>& queries) {
  return static_cast<int>(std::count_if(queries.begin(), queries.end(), [](const Query& query) {
    return query.history != nullptr && query.history->current.isJammed;
  }));
}

}  // namespace

TEST_CASE("jammed pairs of a batch leave as on the host") {
  const MeshList meshes = bowlAndGear(0);
  const auto backend = openBackend();
  REQUIRE(backend);
  int jammed = 0;
  checkHistories(jammedPairs(meshes, 40), 7, 5, [&](const auto& queries, const auto& forHost) {
    checkBatch(*backend, queries, onHost(forHost));
    jammed += countJammed(forHost);
  });
  CHECK(jammed > 60);
}

TEST_CASE("pairs are jammed by contacts that the device made") {
  const auto slot = collisionMesh(makeSlot());
  MeshList bars;
  std::vector<Query> queries;
  for (int i = 0; i < 24; ++i) {
    bars.push_back(collisionMesh(makeBox({1.1 + 0.01 * i, 0.6, 0.6}, 1)));
    const Transformd pose = makePose({0, 1, 0}, 0.002 * i, {0.001 * i, 0.1, 0.6});
    queries.push_back(makeQuery(*slot, *bars.back(), pose));
    queries.back().options.contacts = ContactModel::kSolid;
  }
  const auto backend = openBackend();
  REQUIRE(backend);
  if (!backend->device().doubles) return;
  CHECK(checkBatch(*backend, queries, onHost(queries)) > 20);
  int jammed = 0;
  checkHistories(queries, 9, 3, [&](const auto& onDevice, const auto& forHost) {
    checkBatch(*backend, onDevice, onHost(forHost));
    jammed += countJammed(forHost);
  });
  CHECK(jammed == 3 * 24);
}

TEST_CASE("jammed pairs whose overlap the device describes leave as on the host") {
  const MeshList meshes = bowlAndGear(2);
  const auto backend = openBackend(always());
  REQUIRE(backend);
  if (!canDescribe(*backend)) return;
  int jammed = 0;
  checkHistories(jammedPairs(meshes, 12), 8, 4, [&](const auto& queries, const auto& forHost) {
    checkAll(*backend, queries, answersOnHost(forHost));
    jammed += countJammed(forHost);
  });
  CHECK(jammed > 15);
}
