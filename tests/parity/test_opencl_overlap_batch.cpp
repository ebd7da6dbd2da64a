// SPDX-License-Identifier: BSD-3-Clause
// Batches with pairs of solids whose overlap the device describes: the contacts are the host's, to the last bit.
#include <algorithm>
#include <atomic>
#include <cmath>
#include <thread>

#include "opencl/runtime/call.h"
#include "opencl/runtime/log.h"
#include "shared/layout/solid_layout.h"
#include "support/large_overlaps.h"
#include "support/part_of.h"

using namespace otg;
using namespace otg::scenes;
using namespace otg::test;

namespace {

/// Pairs of a batch with more than 32 intersecting pairs of triangles are too large for its own kernels, and described,
/// whatever the device: by default GPUs have a second size of these kernels, for up to 64.
opencl::Tuning describing() {
  opencl::Tuning tuning = always();
  tuning.solidSizes = 1;
  tuning.solidLargeHits = 32;
  tuning.leastOverlaps = 1;
  return tuning;
}

/// How many pairs the device described.
std::uint64_t checkDescribed(opencl::Backend& backend, const std::vector<Query>& queries,
                             const std::vector<std::vector<Contact>>& expected) {
  const std::uint64_t before = backend.counts().described;
  opencl::BatchAnswer answer;
  CHECK(backend.collideBatch(queries, answer));
  REQUIRE(answer.size() == queries.size());
  CHECK(countWrong(answer, expected) == 0);
  CHECK(backend.counts().onHost == 0);
  return backend.counts().described - before;
}

/// Pairs of small bodies, which batches do by themselves, between pairs of large ones; some apart.
std::vector<Query> mixed(const MeshList& large, const MeshList& small, std::uint32_t seed, std::size_t count) {
  std::vector<Query> queries = overlaps(large, seed, count / 2, 0.9);
  Draw draw(seed + 100);
  while (queries.size() < count) {
    const auto any = [&] { return draw.below(static_cast<std::uint32_t>(small.size())); };
    const std::size_t a = any(), b = any();
    Query query = makeQuery(*small[a], *small[b], poseAround(draw, 0.5, 2));
    query.options.contacts = ContactModel::kSolid;
    query.options.maxContacts = 16;
    queries.insert(queries.begin() + draw.below(static_cast<std::uint32_t>(queries.size())), query);
  }
  return queries;
}

MeshList smallBodies() {
  MeshList meshes;
  for (const MeshArrays& arrays : {makeTetrahedron({0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}),
                                   makeBox({1, 1.5, 0.8}, 1), makeSphere(0.8, 1), makeCylinder(0.5, 1.4, 12, 1)}) {
    meshes.push_back(collisionMesh(arrays));
  }
  return meshes;
}

}  // namespace

TEST_CASE("large pairs of a batch of solids are described, and the others are not disturbed") {
  const MeshList meshes = bodies(), small = smallBodies();
  const auto backend = openBackend(describing());
  REQUIRE(backend);
  if (!canDescribe(*backend)) return;
  const std::vector<Query> queries = mixed(meshes, small, 11, 80);
  const std::vector<std::vector<Contact>> expected = onHost(queries);
  const std::size_t uneven = unevenPairs(answersOnHost(queries));  // which are the host's
  CHECK(uneven < 20);
  CHECK(checkDescribed(*backend, queries, expected) + uneven >= 25);
  CHECK(backend->counts().describedInVain < 20 + uneven);
  CHECK(backend->counts().contactsMade + uneven >= 25);
  CHECK(backend->counts().contactsLeft <= 2 + uneven);
  // Again, and single pairs and a batch without any in between.
  const std::vector<Query> others = overlaps(meshes, 12, 3, 0.8);
  checkAll(*backend, others, answersOnHost(others));
  const std::vector<Query> none(queries.begin(), queries.begin() + 1);
  checkDescribed(*backend, none, onHost(none));
  CHECK(checkDescribed(*backend, queries, expected) + uneven >= 25);
  // By threads of the caller's, and with times.
  opencl::BatchAnswer answer;
  opencl::StageTimes times;
  std::atomic<std::size_t> shared{0};
  const opencl::RunParts threads = [&](std::size_t count, const auto& work) {
    std::vector<std::thread> team;
    for (std::size_t k = 0; k < 3; ++k) team.emplace_back([&, k] { work(count * k / 3, count * (k + 1) / 3); });
    for (std::thread& thread : team) thread.join();
    shared += count;
  };
  CHECK(backend->collideBatch(queries, answer, &times, threads));
  CHECK(shared >= 25);
  std::size_t wrong = 0;
  for (std::size_t i = 0; i < queries.size(); ++i) {
    wrong += sameBytes(answer.of(i), expected[i]) ? 0 : 1;
  }
  CHECK(wrong == 0);
  CHECK(times.host > 0);
}

TEST_CASE("what cannot be described in a batch is done by itself") {
  MeshList meshes = bodies();
  // Boxes in aligned poses, whose crossings lie in one point; two components; a body inside another.
  const auto box = meshes[1], grid = collisionMesh(makeBox({1, 1, 1}, 20));
  MeshArrays two = makeBox({0.4, 0.4, 0.4}, 12);
  const auto moved = static_cast<std::uint32_t>(two.vertices.size());
  const MeshArrays one = two;
  for (Vec3f v : one.vertices) two.vertices.push_back({v.x + 0.7f, v.y, v.z});
  for (const Triangle& t : one.triangles) two.triangles.push_back({t.v[0] + moved, t.v[1] + moved, t.v[2] + moved});
  const auto pairOfBoxes = collisionMesh(two), tiny = collisionMesh(makeSphere(0.05, 1));
  std::vector<Query> queries = overlaps(meshes, 21, 12, 0.8);
  const auto add = [&](const CollisionMesh& a, const CollisionMesh& b, const Transformd& bInA) {
    queries.push_back(makeQuery(a, b, bInA));
    queries.back().options.contacts = ContactModel::kSolid;
    queries.back().options.maxContacts = 12;
  };
  const Transformd aligned{{1, 0, 0, 0, 1, 0, 0, 0, 1}, {0.25, 0.5, 0.999}};
  for (int i = 0; i < 4; ++i) {
    add(*grid, *grid, aligned);
    add(*grid, *box, {{1, 0, 0, 0, 1, 0, 0, 0, 1}, {0.1 * i, 0, 0.9}});
    add(*meshes[0], *pairOfBoxes, makePose({0, 0, 1}, 0.3 * i, {0.8, 0.1, 0}));
    add(*meshes[0], *tiny, makePose({0, 0, 1}, 0.3 * i, {0.1, 0.1, 0}));
    add(*meshes[0], *meshes[0], makePose({0, 1, 0}, 0.3 * i, {0.9, 0.1, 0}));
  }
  for (Query& query : queries) query.options.maxContacts = 12;
  const auto backend = openBackend(describing());
  REQUIRE(backend);
  const std::vector<std::vector<Contact>> expected = onHost(queries);
  const std::uint64_t described = checkDescribed(*backend, queries, expected);
  if (!canDescribe(*backend)) return;
  CHECK(described >= 8);
  CHECK(backend->counts().describedInVain > 0);
  // Fewer than are worth it, and where it is switched off.
  opencl::Tuning tuning = describing();
  tuning.leastOverlaps = 1000;
  CHECK(checkDescribed(*openBackend(tuning), queries, expected) == 0);
  tuning = describing();
  tuning.doubles = false;
  CHECK(checkDescribed(*openBackend(tuning), queries, expected) == 0);
}

TEST_CASE("any number of small regions is described beside large ones") {
  // A dome among bumps of different heights, under a plate. Pairs with more than eight regions went to the host.
  const auto bumps = [](double x, double y) {
    return (0.12 + 0.02 * x) * std::cos(9 * x) * std::cos(9 * y) + 0.3 * std::exp(-4 * (x * x + y * y));
  };
  const auto ground = collisionMesh(makeGround(4, 1, 96, bumps)), plate = collisionMesh(makeBox({3, 3, 0.4}, 40));
  Draw draw(12);
  std::vector<Query> queries;
  std::size_t many = 0;
  while (queries.size() < 40) {
    const Vec3d place{draw.uniform(-0.3, 0.3), draw.uniform(-0.3, 0.3), draw.uniform(0.26, 0.3)};
    const double angle = draw.uniform(0, 0.01);
    Query query = makeQuery(*ground, *plate, makePose(draw.direction(), angle, place));
    query.options.contacts = ContactModel::kSolid;
    query.options.maxContacts = 400;
    Workspace workspace;
    collide(query, workspace);
    if (workspace.stats.unevenRegions > 0) continue;  // the host's
    const HostOverlap found(query);
    const auto large = std::count_if(found.regions.regions.begin(), found.regions.regions.end(),
                                     [](const Region& region) { return region.cellEnd > region.cellBegin; });
    if (large == 0) continue;
    many += found.regions.regions.size() >= 20 ? 1 : 0;
    queries.push_back(query);
  }
  CHECK(many >= 20);
  const auto backend = openBackend(describing());
  REQUIRE(backend);
  if (!canDescribe(*backend)) return;
  CHECK(checkDescribed(*backend, queries, onHost(queries)) == queries.size());
  CHECK(backend->counts().describedInVain == 0);
  CHECK(backend->counts().contactsMade == queries.size());
}

TEST_CASE("pairs of a batch whose own kernels find them at odds are described") {
  // Goes through itself about its axis, and has no inner corners there, which would be the host's.
  const auto mesh = collisionMesh(makeTorus(0.4, 0.5, 20, 12));
  std::vector<Query> queries;
  Workspace workspace;
  for (const Query& query : overlaps({mesh}, 41, 2500, 2.2)) {
    findIntersectingPairs(query, workspace);
    const std::size_t hits = workspace.intersecting.size();
    if (hits < OTG_SOLID_ODD_HITS || hits > opencl::Tuning{}.solidLargeHits || !atOdds(query).any()) continue;
    collide(query, workspace);
    if (workspace.stats.unevenRegions == 0) queries.push_back(query);  // the others are the host's
  }
  REQUIRE(queries.size() >= 30);
  opencl::Tuning tuning = always();
  tuning.leastOverlaps = 1;
  const auto backend = openBackend(tuning);
  REQUIRE(backend);
  if (!canDescribe(*backend)) return;
  opencl::BatchAnswer answer;
  CHECK(backend->collideBatch(queries, answer));
  CHECK(countWrong(answer, onHost(queries)) == 0);
  // Left to the host are small regions on edges that large ones cross, too, where crossings are at odds: the host could
  // not make them from their own hits.
  const std::size_t kLeft = queries.size() / 4;
  CHECK(backend->counts().described >= queries.size() - kLeft);
  CHECK(answer.leftToHost <= kLeft);
}

TEST_CASE("a few large pairs of a batch are done by the host while the device does the others") {
  const MeshList meshes = bodies(), small = smallBodies();
  const std::vector<Query> queries = mixed(meshes, small, 61, 40);
  const std::vector<std::vector<Contact>> expected = onHost(queries);
  std::atomic<std::size_t> shared{0};
  const opencl::RunParts threads = [&](std::size_t count, const auto& work) {
    std::vector<std::thread> team;
    for (std::size_t k = 0; k < 3; ++k) team.emplace_back([&, k] { work(count * k / 3, count * (k + 1) / 3); });
    for (std::thread& thread : team) thread.join();
    shared += count;
  };
  for (const std::uint32_t most : {0u, 1000u}) {
    opencl::Tuning tuning = describing();
    tuning.leastOverlaps = 1000;
    tuning.meanwhile = most;
    tuning.leastPiece = 10;  // four pieces
    const auto backend = openBackend(tuning);
    REQUIRE(backend);
    for (int run = 0; run < 2; ++run) {
      shared = 0;
      opencl::BatchAnswer answer;
      CHECK(backend->collideBatch(queries, answer, nullptr, threads));
      CHECK(countWrong(answer, expected) == 0);
      CHECK(backend->counts().onHost == 0);
      CHECK(shared >= 5);
      if (!backend->device().doubles) continue;
      CHECK((most == 0 ? answer.byHost.empty() : answer.byHost.size() >= 5));
      CHECK(answer.byHost.size() <= answer.leftToHost);
    }
  }
}

TEST_CASE("pairs that the host does while the device is at work have the histories of the host, whatever call fails") {
  const MeshList meshes = bodies(), small = smallBodies();
  const opencl::RunParts threads = [](std::size_t count, const auto& work) {
    std::vector<std::thread> team;
    for (std::size_t k = 0; k < 3; ++k) team.emplace_back([&, k] { work(count * k / 3, count * (k + 1) / 3); });
    for (std::thread& thread : team) thread.join();
  };
  opencl::setLogSink([](const std::string&) {});
  opencl::Tuning tuning = describing();
  tuning.leastOverlaps = 1000;
  tuning.leastPiece = 5;
  const auto backend = openBackend(tuning);
  REQUIRE(backend);
  if (!canDescribe(*backend)) return;
  std::uint64_t calls = 0;
  std::size_t byHost = 0;
  checkHistories(mixed(meshes, small, 71, 20), 72, 5, [&](const auto& queries, const auto& forHost) {
    const std::uint64_t before = opencl::FaultInjection::callCount();
    opencl::BatchAnswer answer;
    CHECK(backend->collideBatch(queries, answer, nullptr, threads));
    CHECK(countWrong(answer, onHost(forHost)) == 0);
    byHost += answer.byHost.size();
    calls = opencl::FaultInjection::callCount() - before;
  });
  CHECK(byHost > 20);
  CHECK(calls > 60);
  Draw draw(73);
  for (const int code : {CL_OUT_OF_RESOURCES, CL_MEM_OBJECT_ALLOCATION_FAILURE}) {
    for (int round = 0; round < 8; ++round) {
      checkHistories(mixed(meshes, small, 71, 20), 74, 4, [&](const auto& queries, const auto& forHost) {
        opencl::FaultInjection::failAt(1 + draw.below(static_cast<std::uint32_t>(calls)), code);
        opencl::BatchAnswer answer;
        backend->collideBatch(queries, answer, nullptr, threads);
        opencl::FaultInjection::failAt(0);
        CHECK(countWrong(answer, onHost(forHost)) == 0);
      });
    }
  }
  CHECK(backend->counts().onHost > 0);
  opencl::setLogSink({});
}

TEST_CASE("descriptions of a batch do not depend on the sizes of lists and pieces") {
  const MeshList meshes = bodies(), small = smallBodies();
  const std::vector<Query> queries = mixed(meshes, small, 31, 60);
  const std::vector<std::vector<Contact>> expected = onHost(queries);
  std::vector<opencl::Tuning> tunings(7, describing());
  tunings[0].overlapUnits = 1;
  tunings[0].hitPlaces = 1;
  tunings[1].overlapPairs = 1;
  tunings[2].overlapPairs = 7;
  tunings[2].overlapGroup = 64;
  tunings[2].leastPiece = 16;            // several pieces of the batch
  tunings[2].batchWork = 40000;          // and more, by their cost
  tunings[3].overlapGroupsPerUnit = 64;  // several work-groups for a pair
  tunings[4].meshBudget = 16u << 20;     // not all meshes at once
  tunings[5].overlapContacts = 0;        // the host makes all contacts from descriptions
  tunings[6].overlapArena = 1;           // no room for regions at first
  std::uint64_t described = 0;
  for (const opencl::Tuning& tuning : tunings) {
    const auto backend = openBackend(tuning);
    REQUIRE(backend);
    if (!canDescribe(*backend)) return;
    const std::uint64_t now = checkDescribed(*backend, queries, expected);
    CHECK(now >= 15);
    if (described != 0) CHECK(now == described);
    described = now;
    if (tuning.overlapUnits == 1) CHECK(backend->counts().repeats > 1);
    if (tuning.overlapArena == 1) CHECK(backend->counts().repeats > 0);
    CHECK((backend->counts().contactsMade > 0) == (tuning.overlapContacts != 0));
    CHECK(checkDescribed(*backend, queries, expected) == described);
  }
}

TEST_CASE("pairs of a batch that are described have the histories of the host") {
  const MeshList meshes = bodies(), small = smallBodies();
  const auto backend = openBackend(describing());
  REQUIRE(backend);
  if (!canDescribe(*backend)) return;
  checkHistories(mixed(meshes, small, 41, 20), 42, 5, [&](const auto& queries, const auto& forHost) {
    CHECK(checkDescribed(*backend, queries, onHost(forHost)) > 0);
  });
}

TEST_CASE("a batch with described pairs comes out the same whatever call fails") {
  const MeshList meshes = bodies(), small = smallBodies();
  const std::vector<Query> queries = mixed(meshes, small, 51, 10);
  const std::vector<std::vector<Contact>> expected = onHost(queries);
  opencl::setLogSink([](const std::string&) {});
  opencl::Tuning tuning = describing();
  tuning.overlapPairs = 3;
  const auto backend = openBackend(tuning);
  REQUIRE(backend);
  if (!canDescribe(*backend)) return;
  checkDescribed(*backend, queries, expected);
  const std::uint64_t before = opencl::FaultInjection::callCount();
  CHECK(checkDescribed(*backend, queries, expected) > 0);
  const std::uint64_t calls = opencl::FaultInjection::callCount() - before;
  CHECK(calls > 60);
  for (const int code : {CL_OUT_OF_RESOURCES, CL_MEM_OBJECT_ALLOCATION_FAILURE}) {
    for (std::uint64_t n = 1; n <= calls + 100; n += code == CL_OUT_OF_RESOURCES ? 1 : 7) {
      if (!isInPart(n)) continue;
      opencl::FaultInjection::failAt(n, code);
      opencl::BatchAnswer answer;
      backend->collideBatch(queries, answer);
      REQUIRE(countWrong(answer, expected) == 0);
      opencl::FaultInjection::failAt(0);
    }
  }
  CHECK(backend->counts().onHost > 0);
  opencl::setLogSink({});
}
