// SPDX-License-Identifier: BSD-3-Clause
// Pairs of solids whose overlap the device describes: the contacts are the host's, to the last bit.
#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <thread>

#include "opencl/runtime/call.h"
#include "opencl/runtime/log.h"
#include "support/large_overlaps.h"
#include "support/posts.h"

using namespace otg;
using namespace otg::scenes;
using namespace otg::test;

TEST_CASE("contacts from the device's description of an overlap are the host's") {
  const MeshList meshes = bodies();
  const auto backend = openBackend(always());
  REQUIRE(backend);
  if (!canDescribe(*backend)) return;
  const std::vector<Query> queries = overlaps(meshes, 1, 90);
  const std::vector<Workspace> expected = answersOnHost(queries);
  const std::size_t uneven = unevenPairs(expected);  // which are the host's
  CHECK(uneven < 20);
  CHECK(checkAll(*backend, queries, expected) + uneven >= 60);
  CHECK(backend->counts().contactsMade + uneven >= 50);
  CHECK(backend->counts().contactsLeft <= 2 + uneven);
  // Again, and pairs alone and contacts of the other model in between: a query leaves nothing behind.
  std::vector<Query> mixed = queries;
  for (std::size_t i = 0; i < mixed.size(); i += 3) mixed[i].options.contacts = ContactModel::kPairwise;
  checkAll(*backend, mixed, answersOnHost(mixed));
  CHECK(checkAll(*backend, queries, expected) + uneven >= 60);
}

TEST_CASE("contacts of large regions are made on the device as on the host") {
  const MeshList meshes = bodies();
  std::vector<Query> queries = overlaps(meshes, 21, 40);
  for (std::size_t i = 0; i < queries.size(); ++i) {
    SolidOptions& solid = queries[i].options.solid;
    solid.contactsPerRegion = std::array{1, 3, 16, 64, 2}[i % 5];
    if (i % 4 == 3) solid.regionMerge = 0.2;
    if (i % 3 == 0) queries[i].relativeVelocity = {0.3, -0.5, 0.1 * static_cast<double>(i % 7)};
  }
  const std::vector<Workspace> expected = answersOnHost(queries);
  opencl::Tuning tuning = always();
  SECTION("by the host") {
    tuning.overlapContacts = 0;
  }
  SECTION("with much room") {
    tuning.overlapArena = 1u << 22;
  }
  SECTION("with the usual room") {}
  SECTION("with too little room") {
    tuning.overlapArena = 1;
  }
  SECTION("by few lanes") {
    tuning.overlapLanes = 8;
  }
  const auto backend = openBackend(tuning);
  REQUIRE(backend);
  if (!canDescribe(*backend)) return;
  // PoCL takes minutes to compile these kernels for work-groups of more than one lane.
  if (tuning.overlapLanes != 0 && backend->device().kind == opencl::DeviceKind::kCpu) return;
  const std::size_t uneven = unevenPairs(expected);  // which are the host's
  CHECK(3 * uneven < queries.size());
  CHECK(checkAll(*backend, queries, expected) + uneven >= 25);
  const opencl::BackendCounts counts = backend->counts();
  CHECK((tuning.overlapContacts == 0 ? counts.contactsMade == 0 : counts.contactsMade + uneven >= 25));
  CHECK(counts.contactsLeft <= 1 + uneven);
  if (tuning.overlapArena == 1) CHECK(counts.repeats > 0);
}

TEST_CASE("thin contacts with a wedge beside them are the host's") {
  // Boxes that slide over a concave kink. Of small regions the host makes the contacts, and gives the wedge its own way
  // out; of large ones pieces are gathered, on either side, and there is no wedge.
  const MeshList meshes = {collisionMesh(samples::makeValley(0.5, 0.5, 8, 4)),
                           collisionMesh(samples::makeValley(1, 0.3, 8, 4)), collisionMesh(makeBox({0.6, 0.6, 0.6}, 3)),
                           collisionMesh(makeBox({0.6, 0.6, 0.6}, 20))};
  Draw draw(9);
  std::vector<Query> queries;
  for (int i = 0; i < 40; ++i) {
    const double angle = std::atan(i % 2 == 0 ? 0.5 : 0.3), sine = std::sin(angle), cosine = std::cos(angle);
    const double along = 0.3 - std::pow(10, draw.uniform(-7, -1)), up = 0.3 - std::pow(10, draw.uniform(-6, -2));
    const Vec3d place = {along * cosine - up * sine, draw.uniform(-1, 1), along * sine + up * cosine};
    queries.push_back(makeQuery(*meshes[i % 2], *meshes[2 + i / 2 % 2], makePose({0, -1, 0}, angle, place)));
    queries.back().options.contacts = ContactModel::kSolid;
    queries.back().options.maxContacts = 16;
  }
  const auto backend = openBackend(always());
  REQUIRE(backend);
  if (!canDescribe(*backend)) return;
  CHECK(checkAll(*backend, queries, answersOnHost(queries)) >= 20);
  CHECK(backend->counts().contactsMade >= 20);
}

TEST_CASE("a mesh that overlaps itself is described") {
  const auto backend = openBackend(always());
  REQUIRE(backend);
  if (!canDescribe(*backend)) return;
  Draw draw(4);
  const auto lump = collisionMesh(makeLump(1, 5, 0.3, 8)), box = collisionMesh(makeBox({1, 1, 1}, 20));
  std::vector<Query> queries;
  for (int i = 0; i < 24; ++i) {
    const CollisionMesh& mesh = i % 2 != 0 ? *lump : *box;
    // From all but the same place to a touch; boxes aligned now and then, so that crossings lie in one point.
    const double angle = i % 6 == 0 ? 0 : draw.uniform(0, 0.4);
    queries.push_back(makeQuery(mesh, mesh, makePose({0.36, 0.48, 0.8}, angle, otgScale(draw.direction(), 0.08 * i))));
    if (i % 8 == 0) queries.back().bInA.t = {0, 0.25 * (i % 3), 0.999};
    queries.back().options.contacts = ContactModel::kSolid;
  }
  CHECK(checkAll(*backend, queries, answersOnHost(queries)) >= 8);
}

namespace {

/// Closed surfaces that go through themselves: in a lens about the axis, and here and there.
MeshList tangled() {
  MeshList meshes;
  for (const MeshArrays& arrays :
       {makeTorus(0.4, 0.5, 60, 40), crumpled(makeSphere(0.9, 4), 0.06f, 1), crumpled(makeLump(1, 5, 0.3, 8), 0.05f, 2),
        crumpled(makeBox({1, 1.2, 0.9}, 16), 0.04f, 3)}) {
    meshes.push_back(collisionMesh(arrays));
  }
  return meshes;
}

}  // namespace

TEST_CASE("overlaps of meshes that intersect themselves are described") {
  const MeshList meshes = tangled();
  const auto backend = openBackend(always());
  REQUIRE(backend);
  if (!canDescribe(*backend)) return;
  std::vector<Query> queries;
  for (const auto& mesh : meshes) {
    const std::vector<Query> own = overlaps({mesh}, 31, 50, 1.3);
    queries.insert(queries.end(), own.begin(), own.end());
  }
  const std::vector<Workspace> expected = answersOnHost(queries);
  std::size_t described = 0, crossings = 0, votes = 0, stretches = 0, inVain = 0;
  for (std::size_t i = 0; i < queries.size(); ++i) {
    const AtOdds odds = atOdds(queries[i]);
    const std::uint64_t now = checkAll(*backend, {&queries[i], 1}, {&expected[i], 1});
    described += now;
    crossings += now * (odds.crossings ? 1 : 0);
    votes += now * (odds.votes ? 1 : 0);
    stretches += now * (odds.stretches ? 1 : 0);
    inVain += (1 - now) * (odds.any() ? 1 : 0);
  }
  // The host takes those in which an edge of an inner corner ends, and crumpled bodies have many.
  CHECK(described >= 90);
  CHECK(crossings >= 25);
  CHECK(votes >= 20);
  CHECK(stretches >= 30);
  CHECK(backend->counts().contactsMade >= 90);
  // As many votes for inside as for outside in one place, say.
  CHECK(inVain > 0);
  // In a batch, too.
  opencl::Tuning tuning = always();
  tuning.leastOverlaps = 1;
  const auto other = openBackend(tuning);
  opencl::BatchAnswer answer;
  CHECK(other->collideBatch(queries, answer));
  std::size_t wrong = 0;
  for (std::size_t i = 0; i < queries.size(); ++i) wrong += sameBytes(answer.of(i), expected[i].reduced) ? 0 : 1;
  CHECK(wrong == 0);
  CHECK(other->counts().described >= 90);
}

TEST_CASE("small regions on triangles and edges that large ones cross, too, come out as with these") {
  // A coarse box, a little aslant, on hills of different heights.
  const auto hills = [](double x, double y) { return (0.3 + 0.08 * x) * std::sin(3 * x) * std::cos(2.5 * y); };
  const auto ground = collisionMesh(makeGround(4, 1, 64, hills)), box = collisionMesh(makeBox({1.8, 1.8, 0.5}, 2));
  const auto backend = openBackend(always());
  REQUIRE(backend);
  if (!canDescribe(*backend)) return;
  Draw draw(3);
  std::vector<Query> queries;
  for (int i = 0; i < 500; ++i) {
    // One by one: compilers differ in which argument they make first.
    const Vec3d place{draw.uniform(-1, 1), draw.uniform(-1, 1), draw.uniform(0.3, 0.55)};
    const double angle = draw.uniform(0, 0.2);
    const Transformd pose = makePose(draw.direction(), angle, place);
    queries.push_back(makeQuery(*ground, *box, pose));
    if (i % 2 != 0) {
      const Transformd back{
          {pose.r[0], pose.r[3], pose.r[6], pose.r[1], pose.r[4], pose.r[7], pose.r[2], pose.r[5], pose.r[8]},
          otgScale(otgRotateBack(pose, pose.t), -1.0)};
      queries.back() = makeQuery(*box, *ground, back);
    }
    queries.back().options.contacts = ContactModel::kSolid;
    queries.back().options.maxContacts = 200;
    queries.back().options.solid.contactsPerRegion = 64;
  }
  CHECK(checkAll(*backend, queries, answersOnHost(queries)) >= 300);
}

TEST_CASE("corners of a face that are in different posts are described as regions of their own") {
  const auto posts = collisionMesh(makePosts(5)), plate = collisionMesh(makePlate());
  const auto backend = openBackend(always());
  REQUIRE(backend);
  if (!canDescribe(*backend)) return;
  Draw draw(2);
  std::vector<Query> queries;
  for (int i = 0; i < 40; ++i) {
    queries.push_back(makeQuery(*posts, *plate, drawPlatePose(draw)));
    queries.back().options.contacts = ContactModel::kSolid;
    queries.back().options.maxContacts = 200;
  }
  CHECK(checkAll(*backend, queries, answersOnHost(queries)) > 15);
}

TEST_CASE("overlaps of aligned boxes are described, whose crossings lie in one point") {
  const auto backend = openBackend(always());
  REQUIRE(backend);
  if (!canDescribe(*backend)) return;
  const auto box = collisionMesh(makeBox({1, 1, 1}, 20)), other = collisionMesh(makeBox({0.8, 1, 0.6}, 16));
  Draw draw(6);
  std::vector<Query> queries;
  for (int i = 0; i < 60; ++i) {
    const auto along = [&] {
      return i % 3 == 0 ? draw.uniform(-0.5, 0.5) : 0.05 * (static_cast<int>(draw.below(20)) - 10);
    };
    Transformd bInA{{1, 0, 0, 0, 1, 0, 0, 0, 1}, {along(), along(), i % 2 != 0 ? 0.9 : 0.7}};
    if (i % 4 == 1) bInA = {{0, -1, 0, 1, 0, 0, 0, 0, 1}, bInA.t};
    if (i % 5 == 0) bInA.t.z += 0.099;
    queries.push_back(makeQuery(*box, i % 2 != 0 ? *box : *other, bInA));
    queries.back().options.contacts = ContactModel::kSolid;
  }
  CHECK(checkAll(*backend, queries, answersOnHost(queries)) == queries.size());
}

TEST_CASE("the description does not depend on the sizes of launches and lists") {
  const MeshList meshes = bodies();
  const std::vector<Query> queries = overlaps(meshes, 2, 12, 0.9);
  const std::vector<Workspace> expected = answersOnHost(queries);
  std::vector<opencl::Tuning> tunings(5, always());
  tunings[0].overlapGroup = 64;
  tunings[0].leafTriangles = 4;
  tunings[1].hitPlaces = 8;
  tunings[1].pairPlaces = 4;
  tunings[1].leafPlaces = 4;
  tunings[2].overlapUnits = 1;
  tunings[3].cutOrder = 7;
  tunings[3].overlapGroupsPerUnit = 1;
  tunings[3].overlapGroup = 256;
  tunings[4].profile = true;
  for (const opencl::Tuning& tuning : tunings) {
    const auto backend = openBackend(tuning);
    REQUIRE(backend);
    if (!canDescribe(*backend)) return;
    CHECK(checkAll(*backend, queries, expected) >= 6);
    if (tuning.hitPlaces == 8 || tuning.overlapUnits == 1) CHECK(backend->counts().repeats > 0);
    opencl::StageTimes times;
    Workspace workspace;
    CHECK(backend->collideProfiled(queries[0], workspace, times));
    checkSame(workspace, expected[0]);
    CHECK(times.total > 0);
  }
}

TEST_CASE("what the device cannot describe the host does") {
  MeshList meshes = bodies();
  // A sheet, several components, an empty mesh, a tiny body inside the others.
  meshes.push_back(collisionMesh(MeshArrays{}));
  samples::Soup sheet;
  for (int i = 0; i < 20; ++i) {
    const float x = -1 + 0.1f * static_cast<float>(i);
    sheet.add({x, -1, 0}, {x + 0.1f, -1, 0}, {x, 1, 0.1f});
  }
  meshes.push_back(std::make_shared<CollisionMesh>(sheet.build(), BuildStrategy::kSah));
  MeshArrays two = makeBox({0.4, 0.4, 0.4}, 6);
  const auto moved = static_cast<std::uint32_t>(two.vertices.size());
  const MeshArrays box = two;
  for (Vec3f v : box.vertices) two.vertices.push_back({v.x + 0.7f, v.y, v.z});
  for (const Triangle& t : box.triangles) two.triangles.push_back({t.v[0] + moved, t.v[1] + moved, t.v[2] + moved});
  meshes.push_back(collisionMesh(two));
  meshes.push_back(collisionMesh(makeSphere(0.05, 1)));
  std::vector<Query> queries;
  for (std::size_t a = 0; a < meshes.size(); ++a) {
    for (std::size_t b = 7; b < meshes.size(); ++b) {
      queries.push_back(makeQuery(*meshes[a], *meshes[b], makePose({0.36, 0.48, 0.8}, 0.4, {0.3, 0.1, 0.2})));
      queries.back().options.contacts = ContactModel::kSolid;
    }
  }
  const auto backend = openBackend(always());
  REQUIRE(backend);
  const std::vector<Workspace> expected = answersOnHost(queries);
  checkAll(*backend, queries, expected);
  opencl::Tuning without = always();
  without.doubles = false;
  CHECK(checkAll(*openBackend(without), queries, expected) == 0);
  meshes = bodies();
  const std::vector<Query> plain = overlaps(meshes, 3, 8);
  CHECK(checkAll(*openBackend(without), plain, answersOnHost(plain)) == 0);
  if (backend->device().kind == opencl::DeviceKind::kCpu) {
    CHECK(checkAll(*openBackend(), plain, answersOnHost(plain)) == 0);
  }
}

TEST_CASE("pairs with a history are described as the host does them") {
  const MeshList meshes = bodies();
  const auto backend = openBackend(always());
  REQUIRE(backend);
  if (!canDescribe(*backend)) return;
  checkHistories(overlaps(meshes, 6, 10, 0.8), 7, 6, [&](const auto& queries, const auto& forHost) {
    checkAll(*backend, queries, answersOnHost(forHost));
  });
}

TEST_CASE("threads describe overlaps at once") {
  const MeshList meshes = bodies();
  const auto backend = openBackend(always());
  REQUIRE(backend);
  if (!canDescribe(*backend)) return;
  const std::vector<Query> queries = overlaps(meshes, 9, 16);
  const std::vector<Workspace> expected = answersOnHost(queries);
  std::vector<std::thread> team;
  std::atomic<int> wrong{0};
  for (std::size_t t = 0; t < 4; ++t) {
    team.emplace_back([&, t] {
      Workspace workspace;
      for (std::size_t i = 0; i < queries.size(); ++i) {
        const std::size_t k = (i + 5 * t) % queries.size();
        backend->collide(queries[k], workspace);
        if (!sameBytes(workspace.reduced, expected[k].reduced)) ++wrong;
      }
    });
  }
  for (std::thread& thread : team) thread.join();
  CHECK(wrong == 0);
  CHECK(backend->counts().onHost == 0);
}

TEST_CASE("a described pair comes out the same whatever call fails") {
  const MeshList meshes = bodies();
  const std::vector<Query> queries = overlaps(meshes, 5, 2, 0.6);
  const std::vector<Workspace> expected = answersOnHost(queries);
  opencl::setLogSink([](const std::string&) {});
  const auto backend = openBackend(always());
  REQUIRE(backend);
  checkAll(*backend, queries, expected);
  const std::uint64_t before = opencl::FaultInjection::callCount();
  checkAll(*backend, queries, expected);
  const std::uint64_t calls = opencl::FaultInjection::callCount() - before;
  CHECK(calls > 20);
  Workspace workspace;
  for (std::uint64_t n = 1; n <= calls + 60; ++n) {  // a lane that failed is made anew, which takes more calls
    opencl::FaultInjection::failAt(n, CL_OUT_OF_RESOURCES);
    for (std::size_t i = 0; i < queries.size(); ++i) {
      backend->collide(queries[i], workspace);
      REQUIRE(sameBytes(workspace.reduced, expected[i].reduced));
    }
    opencl::FaultInjection::failAt(0);
  }
  CHECK(backend->counts().onHost > 0);
  opencl::setLogSink({});
}
