// SPDX-License-Identifier: BSD-3-Clause
// Many pairs in one submission: each has the contacts that it has by itself.
#include <algorithm>
#include <atomic>
#include <cmath>
#include <stdexcept>
#include <thread>

#include "opencl/runtime/call.h"
#include "opencl/runtime/log.h"
#include "support/mesh_samples.h"
#include "support/opencl.h"
#include "support/opencl_scenes.h"
#include "support/part_of.h"

using namespace otg;
using namespace otg::scenes;
using namespace otg::test;

namespace {

using MeshList = std::vector<std::shared_ptr<const CollisionMesh>>;

/// From one triangle to thousands, closed and open; the empty mesh too.
MeshList mixedMeshes() {
  MeshList meshes;
  samples::Soup one;
  one.add({-1, -0.5f, 0}, {1, -0.5f, 0.1f}, {0, 1, 0});
  meshes.push_back(std::make_shared<CollisionMesh>(one.build(), BuildStrategy::kSah));
  for (const MeshArrays& arrays :
       {makeTetrahedron({0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}), makeBox({1, 1.5, 0.8}, 1), makeBox({1, 1, 1}, 7),
        makeSphere(0.8, 2), makeTorus(0.7, 0.25, 31, 13), makeLump(0.9, 4, 0.2, 5), makeGear(12, 0.9, 0.2, 0.3, 0.1),
        makeLump(0.9, 5, 0.2, 6), MeshArrays{}}) {
    meshes.push_back(collisionMesh(arrays));
  }
  meshes.push_back(std::make_shared<CollisionMesh>(samples::randomSoup(3, 300, 0.5f, 0.4f), BuildStrategy::kMeanSplit));
  return meshes;
}

std::vector<Query> randomQueries(const MeshList& meshes, std::uint32_t seed, std::size_t count) {
  Draw draw(seed);
  std::vector<Query> queries;
  const auto any = [&]() -> const CollisionMesh& {
    return *meshes[draw.below(static_cast<std::uint32_t>(meshes.size()))];
  };
  for (std::size_t i = 0; i < count; ++i) {
    const CollisionMesh& a = any();
    queries.push_back(makeQuery(a, any(), makePose(draw.direction(), draw.uniform(0, 3), draw.inBox(0.9))));
    queries.back().options.maxContacts = 16;
    if (i % 5 == 0) queries.back().options.contacts = ContactModel::kSolid;
    if (i % 7 == 0) queries.back().options.reduction.method = Reduction::kNone;
    if (i % 97 == 0) queries.back().bInA.t.x = NAN;
  }
  return queries;
}

struct Expected {
  std::vector<std::vector<Contact>> contacts;
  std::vector<std::uint8_t> intersects;
  std::vector<std::size_t> refused;
  std::uint64_t intersectingPairs = 0;
};

Expected onHost(const std::vector<Query>& queries) {
  Expected expected;
  Workspace workspace;
  for (std::size_t i = 0; i < queries.size(); ++i) {
    try {
      collide(queries[i], workspace);
    } catch (const std::invalid_argument&) {
      workspace = {};
      expected.refused.push_back(i);
    }
    expected.contacts.push_back(workspace.reduced);
    expected.intersects.push_back(!workspace.intersecting.empty());
    expected.intersectingPairs += workspace.intersecting.size();
  }
  return expected;
}

void checkBatch(opencl::Backend& backend, const std::vector<Query>& queries, const Expected& expected,
                bool allOnDevice = true) {
  opencl::BatchAnswer answer;
  CHECK(backend.collideBatch(queries, answer) == allOnDevice);
  REQUIRE(answer.size() == queries.size());
  std::size_t wrong = 0;
  for (std::size_t i = 0; i < queries.size(); ++i) wrong += sameBytes(answer.of(i), expected.contacts[i]) ? 0 : 1;
  CHECK(wrong == 0);
  CHECK(answer.refused == expected.refused);
  CHECK(answer.stats.intersectingPairs == expected.intersectingPairs);
  std::vector<std::uint8_t> intersects;
  CHECK(backend.intersectBatch(queries, intersects) == allOnDevice);
  CHECK(intersects == expected.intersects);
}

}  // namespace

TEST_CASE("a batch of all kinds of meshes has the contacts of each pair by itself") {
  const MeshList meshes = mixedMeshes();
  const std::vector<Query> queries = randomQueries(meshes, 1, 400);
  const Expected expected = onHost(queries);
  REQUIRE(expected.intersectingPairs > 10000);
  const auto check = [&](const opencl::Tuning& tuning, bool repeats) {
    const auto backend = openBackend(tuning);
    REQUIRE(backend);
    checkBatch(*backend, queries, expected);
    CHECK((backend->counts().repeats > 0) == repeats);
    CHECK(backend->counts().onHost == 0);
    CHECK(backend->counts().queries == 2 * queries.size());
  };
  check({}, true);  // the list of hits has to grow for so many
  opencl::Tuning tuning;
  tuning.hitPlaces = 1u << 20;
  check(tuning, false);
  for (const std::uint32_t group : {32u, 64u, 256u}) {
    for (const std::uint32_t leaf : {1u, 3u, 4u}) {
      tuning.batchGroup = group;
      tuning.leafTriangles = leaf;
      check(tuning, false);
    }
  }
  tuning.stackRoom = 16;
  check(tuning, false);
  tuning.batchPairs = 13;  // many submissions
  check(tuning, false);
  tuning.batchPairs = 1u << 16;
  tuning.batchTriangles = 3000;  // some pairs by themselves
  check(tuning, false);
  tuning.doubles = false;  // what is undecided and all contacts to the host
  check(tuning, false);
  tuning = {};
  tuning.hitPlaces = 1;
  tuning.recordsExpected = 1;
  check(tuning, true);
  tuning = {};
  tuning.hitPlaces = 1u << 20;
  tuning.contactPlaces = 1;
  check(tuning, true);
  tuning.contactPlaces = 1u << 16;
  tuning.batchKeptPlaces = 10;  // most pairs have more, and go to the host
  tuning.batchChooseGroup = 32;
  tuning.recordGroup = 128;
  check(tuning, false);
  tuning.pieces = 3;
  tuning.leastPiece = 50;
  check(tuning, false);
  tuning.smallHits = 4;  // work-groups for few hits, for more, and the way for many, all of them used
  tuning.mediumHits = 32;
  tuning.smallGroup = 32;
  tuning.mediumGroup = 96;
  check(tuning, false);
  tuning.reduce = false;
  check(tuning, false);
}

TEST_CASE("pairs of numbered meshes have the contacts of queries, and a second run gives the same bytes") {
  const MeshList meshes = mixedMeshes();
  opencl::NumberedPairs batch;
  std::vector<const CollisionMesh*> all;
  for (const auto& mesh : meshes) all.push_back(mesh.get());
  const auto backend = openBackend();
  REQUIRE(backend);
  for (const ContactModel model : {ContactModel::kPairwise, ContactModel::kSolid}) {
    std::vector<Query> queries = randomQueries(meshes, 5, 200);
    std::vector<opencl::MeshPair> pairs;
    for (Query& query : queries) {
      query.options = {};
      query.options.maxContacts = 9;
      query.options.contacts = model;
      const auto number = [&](const CollisionMesh* mesh) {
        return static_cast<std::uint32_t>(std::find(all.begin(), all.end(), mesh) - all.begin());
      };
      pairs.push_back({number(query.a), number(query.b), query.bInA});
    }
    const Expected expected = onHost(queries);
    batch.meshes = all;
    batch.pairs = pairs;
    batch.options = queries[0].options;
    for (int round = 0; round < 3; ++round) {
      opencl::BatchAnswer answer;
      opencl::StageTimes times;
      CHECK(backend->collideBatch(batch, answer, round == 2 ? &times : nullptr));
      REQUIRE(answer.size() == queries.size());
      std::size_t wrong = 0;
      for (std::size_t i = 0; i < queries.size(); ++i) wrong += sameBytes(answer.of(i), expected.contacts[i]) ? 0 : 1;
      CHECK(wrong == 0);
      CHECK(answer.refused == expected.refused);
      CHECK(answer.stats.intersectingPairs == expected.intersectingPairs);
      CHECK((times.total > 0) == (round == 2));
      std::vector<std::uint8_t> intersects;
      CHECK(backend->intersectBatch(batch, intersects));
      CHECK(intersects == expected.intersects);
    }
  }
}

TEST_CASE("meshes that do not fit at once are done in parts") {
  MeshList meshes;
  for (std::uint32_t seed = 0; seed < 30; ++seed) meshes.push_back(collisionMesh(makeLump(0.9, 3, 0.2, seed)));
  const std::vector<Query> queries = randomQueries(meshes, 2, 100);
  const Expected expected = onHost(queries);
  opencl::Tuning tuning;
  tuning.meshBudget = 2500 << 10;  // some ten of them
  const auto backend = openBackend(tuning);
  REQUIRE(backend);
  checkBatch(*backend, queries, expected);
  CHECK(backend->counts().meshEvictions > 10);
  CHECK(backend->counts().onHost == 0);
}

TEST_CASE("an empty batch and a batch of nothing to do") {
  const auto backend = openBackend();
  REQUIRE(backend);
  checkBatch(*backend, {}, {});
  const MeshList meshes = {collisionMesh({}), collisionMesh(makeBox({1, 1, 1}))};
  std::vector<Query> queries = {makeQuery(*meshes[0], *meshes[1], makeMove({0, 0, 0})),
                                makeQuery(*meshes[1], *meshes[0], makeMove({0, 0, 0})),
                                makeQuery(*meshes[1], *meshes[1], makeMove({5, 0, 0}))};
  checkBatch(*backend, queries, onHost(queries));
}

TEST_CASE("yes or no of boxes that touch is decided on the device") {
  const MeshList meshes = {collisionMesh(makeBox({1, 1, 1}, 1)), collisionMesh(makeBox({1, 0.5, 0.75}, 2))};
  Draw draw(6);
  std::vector<Query> touching, apart;
  for (int i = 0; i < 200; ++i) {
    const CollisionMesh &a = *meshes[draw.below(2)], &b = *meshes[draw.below(2)];
    const double height = static_cast<double>(a.mesh().boundsMax().z - b.mesh().boundsMin().z);
    const double side = static_cast<double>(a.mesh().boundsMax().x - b.mesh().boundsMin().x);
    // Upon each other, edge to edge, and above each other by the least that there is.
    const double x = i % 3 == 0 ? side : 0, up = i % 4 == 0 ? 0x1p-52 : 0;
    touching.push_back(makeQuery(a, b, makeMove({x, 0, height + up})));
    apart.push_back(makeQuery(a, b, makeMove({x, 0, height + 0.1})));
  }
  const Expected expected = onHost(touching);
  const auto yes = std::count(expected.intersects.begin(), expected.intersects.end(), 1);
  CHECK(yes > 100);
  CHECK(yes < 200);
  const auto backend = openBackend();
  REQUIRE(backend);
  std::vector<std::uint8_t> intersects;
  const auto callsFor = [&](const std::vector<Query>& queries) {
    CHECK(backend->intersectBatch(queries, intersects));
    const std::uint64_t before = opencl::FaultInjection::callCount();
    CHECK(backend->intersectBatch(queries, intersects));
    return opencl::FaultInjection::callCount() - before;
  };
  callsFor(touching);  // lists are as long as they need to be, kernels are there
  const std::uint64_t callsForNothing = callsFor(apart), calls = callsFor(touching);
  CHECK(intersects == expected.intersects);
  // Nothing is read but the answers.
  if (backend->device().doubles) CHECK(calls == callsForNothing);
}

namespace {

/// Boxes that touch, with contacts of the model `pairwise`: most of what intersects is left open by double arithmetic.
std::vector<Query> touchingBoxes(const MeshList& boxes, int poses) {
  std::vector<Query> queries;
  for (std::uint32_t i = 0; i < boxes.size(); ++i) {
    for (std::uint32_t j = 0; j < boxes.size(); ++j) {
      for (const Transformd& pose : touchingPoses(*boxes[i], *boxes[j], 100 + 8 * i + j, poses)) {
        queries.push_back(makeQuery(*boxes[i], *boxes[j], pose));
        queries.back().options.maxContacts = 16;
        if (queries.size() % 7 == 0) queries.back().options.reduction.method = Reduction::kNone;
      }
    }
  }
  return queries;
}

MeshList boxesOfManySizes() {
  return {collisionMesh(makeBox({1, 1, 1}, 1)), collisionMesh(makeBox({1, 0.5, 0.75}, 2)),
          collisionMesh(makeBox({0.7, 0.9, 0.3}, 5)), collisionMesh(makeBox({1, 1, 1}, 8))};
}

}  // namespace

TEST_CASE("no contacts of boxes that touch are left to the host") {
  const MeshList boxes = boxesOfManySizes();
  const std::vector<Query> queries = touchingBoxes(boxes, 25);
  const Expected expected = onHost(queries);
  CHECK(std::count(expected.intersects.begin(), expected.intersects.end(), 1) > 200);
  const auto check = [&](const opencl::Tuning& tuning) {
    INFO("small " << tuning.smallHits << " medium " << tuning.mediumHits << " pieces " << tuning.pieces);
    const auto backend = openBackend(tuning);
    REQUIRE(backend);
    if (!backend->device().doubles) return;
    for (int round = 0; round < 3; ++round) {
      checkBatch(*backend, queries, expected);
      opencl::BatchAnswer answer;
      CHECK(backend->collideBatch(queries, answer));
      CHECK(answer.leftToHost == 0);
      CHECK(answer.stats.decidedExactly > 4000);
    }
  };
  opencl::Tuning tuning;
  tuning.hitPlaces = 1u << 18;
  tuning.batchKeptPlaces = 1024;  // without binning some have more contacts than usual
  check(tuning);
  tuning.smallHits = 4;  // some pairs are done by one work-group of either size, and some in a second submission
  tuning.mediumHits = 32;
  tuning.recordGroup = 64;
  check(tuning);
  tuning.pieces = 3;
  tuning.leastPiece = 50;
  tuning.hitPlaces = 1;
  check(tuning);
}

TEST_CASE("what a device cannot decide is the host's") {
  const MeshList boxes = boxesOfManySizes();
  // Plates whose planes are so near each other that products of coordinates may underflow, among others.
  const auto plate = collisionMesh(makeGround(1, 0, 2));
  std::vector<Query> queries = touchingBoxes(boxes, 2);
  const std::size_t boxQueries = queries.size();
  for (const double gap : {1e-100, 0.0, 1e-95, 1e-20}) {
    queries.push_back(makeQuery(*plate, *plate, makeMove({0.1, 0.2, gap})));
  }
  const Expected expected = onHost(queries);
  opencl::Tuning tuning;
  for (const bool doubles : {true, false}) {
    tuning.doubles = doubles;
    tuning.mediumHits = 32;
    const auto backend = openBackend(tuning);
    REQUIRE(backend);
    for (int round = 0; round < 2; ++round) {
      opencl::BatchAnswer answer;
      CHECK(backend->collideBatch(queries, answer));
      std::size_t wrong = 0;
      for (std::size_t i = 0; i < queries.size(); ++i) wrong += sameBytes(answer.of(i), expected.contacts[i]) ? 0 : 1;
      CHECK(wrong == 0);
      if (backend->device().doubles) {
        CHECK(answer.leftToHost == 2);
      } else {
        CHECK(answer.leftToHost > boxQueries / 2);
      }
    }
  }
}

TEST_CASE("pairs with too many hits are the host's") {
  const MeshList meshes = mixedMeshes();
  const std::vector<Query> queries = randomQueries(meshes, 3, 300);
  const Expected expected = onHost(queries);
  std::uint64_t left = 0;
  for (const std::uint32_t most : {1000u, 200u, 20u, 1u}) {
    INFO("most " << most);
    opencl::Tuning tuning;
    tuning.mostHits = tuning.batchHits = most;
    const auto backend = openBackend(tuning);
    REQUIRE(backend);
    checkBatch(*backend, queries, expected);
    CHECK(backend->counts().onHost == 0);
    for (std::size_t i = 0; i < queries.size(); ++i) {
      if (std::binary_search(expected.refused.begin(), expected.refused.end(), i)) continue;
      Workspace device;
      CHECK(backend->collide(queries[i], device));
      CHECK(sameBytes(device.reduced, expected.contacts[i]));
      opencl::BatchAnswer alone;
      CHECK(backend->collideBatch(std::span<const Query>(&queries[i], 1), alone));
      CHECK(sameBytes(alone.of(0), expected.contacts[i]));
      CHECK(backend->findIntersectingPairs(queries[i], device));
      CHECK(device.intersecting.empty() == (expected.intersects[i] == 0));
    }
    CHECK(backend->counts().onHost == 0);
    CHECK(backend->counts().leftToHost > left);
    left = backend->counts().leftToHost;
  }
}

TEST_CASE("a hundred thousand tiny pairs in one batch") {
  const MeshList meshes = {collisionMesh(makeTetrahedron({0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1})),
                           collisionMesh(makeBox({1, 1.5, 0.8}, 1))};
  const std::vector<Query> queries = [&] {
    Draw draw(3);
    std::vector<Query> all;
    for (int i = 0; i < 100000; ++i) {
      all.push_back(makeQuery(*meshes[draw.below(2)], *meshes[draw.below(2)],
                              makePose(draw.direction(), draw.uniform(0, 3), draw.inBox(1.2))));
      all.back().options.maxContacts = 4;
    }
    return all;
  }();
  opencl::Tuning tuning;
  tuning.batchGroup = 32;
  const auto backend = openBackend(tuning);
  REQUIRE(backend);
  const Expected expected = onHost(queries);
  CHECK(expected.intersectingPairs > 300000);
  checkBatch(*backend, queries, expected);
}

TEST_CASE("whichever call of a batch fails, the contacts are the same") {
  const MeshList meshes = mixedMeshes();
  const std::vector<Query> queries = randomQueries(meshes, 4, 60);
  const Expected expected = onHost(queries);
  opencl::setLogSink([](const std::string&) {});
  const auto backend = openBackend();
  REQUIRE(backend);
  const std::uint64_t before = opencl::FaultInjection::callCount();
  checkBatch(*backend, queries, expected);
  const std::uint64_t calls = opencl::FaultInjection::callCount() - before;
  CHECK(calls > 30);
  for (const cl_int code : {CL_OUT_OF_RESOURCES, CL_MEM_OBJECT_ALLOCATION_FAILURE}) {
    for (std::uint64_t n = 1; n <= calls + 40; ++n) {  // a lane that failed is made anew, which takes more calls
      if (!isInPart(n + (code == CL_OUT_OF_RESOURCES))) continue;
      opencl::FaultInjection::failAt(n, code);
      opencl::BatchAnswer answer;
      backend->collideBatch(queries, answer);
      opencl::FaultInjection::failAt(0);
      std::size_t wrong = 0;
      for (std::size_t i = 0; i < queries.size(); ++i) wrong += sameBytes(answer.of(i), expected.contacts[i]) ? 0 : 1;
      REQUIRE(wrong == 0);
    }
  }
  checkBatch(*backend, queries, expected);
  CHECK(backend->counts().onHost > 0);
  opencl::setLogSink({});
}

TEST_CASE("whichever call of a batch of boxes that touch fails, the contacts are the same") {
  const MeshList boxes = boxesOfManySizes();
  const std::vector<Query> queries = touchingBoxes(boxes, 2);
  const Expected expected = onHost(queries);
  opencl::setLogSink([](const std::string&) {});
  opencl::Tuning tuning;
  tuning.mediumHits = 32;
  const auto backend = openBackend(tuning);
  REQUIRE(backend);
  opencl::BatchAnswer answer;
  const auto wrong = [&] {
    std::size_t count = 0;
    for (std::size_t i = 0; i < queries.size(); ++i) count += sameBytes(answer.of(i), expected.contacts[i]) ? 0 : 1;
    return count;
  };
  const std::uint64_t before = opencl::FaultInjection::callCount();
  CHECK(backend->collideBatch(queries, answer));
  const std::uint64_t calls = opencl::FaultInjection::callCount() - before;
  for (std::uint64_t n = 1; n <= calls + 60; ++n) {  // a lane that failed is made anew
    opencl::FaultInjection::failAt(n, CL_OUT_OF_RESOURCES);
    backend->collideBatch(queries, answer);
    opencl::FaultInjection::failAt(0);
    REQUIRE(wrong() == 0);
  }
  CHECK(backend->collideBatch(queries, answer));
  CHECK(wrong() == 0);
  CHECK(backend->counts().onHost > 0);
  opencl::setLogSink({});
}

TEST_CASE("several threads submit batches at once") {
  const MeshList meshes = mixedMeshes();
  const auto backend = openBackend();
  REQUIRE(backend);
  std::vector<std::thread> threads;
  std::atomic<std::size_t> wrong{0};
  for (std::uint32_t t = 0; t < 3; ++t) {
    threads.emplace_back([&, t] {
      for (std::uint32_t round = 0; round < 3; ++round) {
        const std::vector<Query> queries = randomQueries(meshes, 100 + 10 * t + round, 120);
        const Expected expected = onHost(queries);
        opencl::BatchAnswer answer;
        backend->collideBatch(queries, answer);
        for (std::size_t i = 0; i < queries.size(); ++i) wrong += sameBytes(answer.of(i), expected.contacts[i]) ? 0 : 1;
      }
    });
  }
  for (std::thread& thread : threads) thread.join();
  CHECK(wrong == 0);
}
