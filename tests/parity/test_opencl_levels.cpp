// SPDX-License-Identifier: BSD-3-Clause
// The traversal `levels`: the same pairs and contacts as the host's, whatever the start depth, the sizes of lists and
// the lengths of prefix sums.
#include <set>

#include "opencl/published/prefix_sum.h"
#include "opencl/published/published_design.h"
#include "opencl/runtime/call.h"
#include "opencl/runtime/context.h"
#include "opencl/runtime/log.h"
#include "support/mesh_samples.h"
#include "support/opencl.h"
#include "support/opencl_scenes.h"

using namespace otg;
using namespace otg::scenes;
using namespace otg::test;
using opencl::LevelsOptions;
using opencl::LevelsReport;
using opencl::PrefixSums;

namespace {

opencl::Backend& shared() {
  static const std::shared_ptr<opencl::Backend> backend = openBackend();
  REQUIRE(backend);
  return *backend;
}

/// What the iterations have to do with each other, and with the trees.
void checkSteps(const LevelsReport& report, const CollideStats& stats, std::uint32_t startDepth) {
  std::uint64_t tests = 0, leafPairs = 0;
  for (std::size_t i = 0; i < report.steps.size(); ++i) {
    const opencl::LevelsStep& step = report.steps[i];
    CHECK(step.depth == startDepth + i);
    CHECK(step.leafPairs <= step.overlapping);
    CHECK(step.overlapping <= step.tests);
    CHECK(step.spawned >= 2 * (step.overlapping - step.leafPairs));
    CHECK(step.spawned <= 4 * (step.overlapping - step.leafPairs));
    CHECK(step.spawned == (i + 1 < report.steps.size() ? report.steps[i + 1].tests : 0));
    tests += step.tests;
    leafPairs += step.leafPairs;
  }
  CHECK(stats.boxTests == tests);
  CHECK(stats.candidatePairs == leafPairs);
}

/// Contacts and pairs are the host's.
void check(opencl::Backend& backend, const Query& query, const LevelsOptions& how, const Workspace& host) {
  INFO("start depth " << how.startDepth << (how.sendTrees ? " sent" : "") << (how.fusedNear ? " fused" : ""));
  Workspace device;
  LevelsReport report;
  CHECK(backend.published().collideByLevels(query, device, how, &report));
  checkSame(device, host);
  checkSteps(report, device.stats, how.startDepth);
  CHECK(backend.published().findPairsByLevels(query, device, how, &report));
  CHECK((device.intersecting == host.intersecting));
  checkSteps(report, device.stats, how.startDepth);
}

LevelsOptions optionsNumber(std::size_t i) {
  constexpr std::uint32_t kDepths[] = {0, 1, 6, 12, 3};
  return {kDepths[i % 5], i % 2 == 1, i % 3 != 2, static_cast<PrefixSums>(i % 3)};
}

}  // namespace

TEST_CASE("scaled images that share their mesh's trees have the host's pairs and contacts by every traversal") {
  const CollisionMesh lump(build(makeLump(1, 3, 0.2, 1)), BuildStrategy::kSah);
  const CollisionMesh torus(build(makeTorus(1, 0.3, 31, 17)), BuildStrategy::kSah);
  std::size_t i = 0, contacts = 0;
  for (const Vec3f by : {Vec3f{1.4f, 0.7f, 1}, Vec3f{-1, 1.1f, 0.6f}, Vec3f{0.9f, 0.9f, 3}}) {
    INFO("times " << by.x << " " << by.y << " " << by.z);
    const CollisionMesh image(samples::scaledMesh(lump.mesh(), by), lump, by);
    REQUIRE(image.boxScale() != nullptr);
    for (const auto& [a, b] : {std::pair{&image, &torus}, {&torus, &image}, {&image, &image}}) {
      const Query query = makeQuery(*a, *b, makePose({0.48, 0.6, 0.64}, 0.7, {0.9, 0.4, 0.1}));
      checkParity(shared(), query);
      Workspace host;
      collide(query, host);
      for (int k = 0; k < 3; ++k) check(shared(), query, optionsNumber(i++), host);
      contacts += host.reduced.size();
    }
  }
  CHECK(contacts > 50);
}

TEST_CASE("prefix sums of any length are those of a loop") {
  opencl::Context context(opencl::findDevices().at(0), opencl::ProgramCache::standard());
  const opencl::QueueHandle queue = context.makeQueue(false);
  opencl::Profile profile(false);
  Draw draw(5);
  for (const std::uint32_t group : {2u, 7u, 64u, 100u}) {
    if (group > context.info().largestWorkGroup) continue;
    opencl::PrefixSum<otg_one_sum> one(context, group);
    opencl::PrefixSum<otg_two_sums> two(context, group);
    for (const std::uint32_t count : {1u, 2u, group - 1, group, group + 1, 3 * group, group * group - 1, group * group,
                                      group * group + 1, group * group * group + 1}) {
      if (count > 500000) continue;
      INFO("group " << group << " count " << count);
      std::vector<cl_uint2> values(count), expected(count);
      cl_uint2 sum{};
      for (std::uint32_t i = 0; i < count; ++i) {
        values[i] = {{static_cast<cl_uint>(draw.below(3)), static_cast<cl_uint>(draw.below(1u << 30))}};
        expected[i] = sum;
        sum.s[0] += values[i].s[0];
        sum.s[1] += values[i].s[1];  // wraps
      }
      for (const bool both : {false, true}) {
        std::vector<cl_uint> plain;
        for (const cl_uint2& v : values) plain.push_back(v.s[0]);
        const std::size_t bytes = count * (both ? sizeof(cl_uint2) : sizeof(cl_uint));
        const opencl::BufferHandle in = context.makeBuffer(CL_MEM_READ_WRITE, bytes);
        const opencl::BufferHandle out = context.makeBuffer(CL_MEM_READ_WRITE, bytes);
        const opencl::BufferHandle total = context.makeBuffer(CL_MEM_READ_WRITE, 6 * sizeof(cl_uint));
        for (const auto& [way, inPlace] : {std::pair{PrefixSums::kPublished, false},
                                           {PrefixSums::kPublished, true},
                                           {PrefixSums::kWorkEfficient, false},
                                           {PrefixSums::kWorkEfficient, true},
                                           {PrefixSums::kSinglePass, false},
                                           {PrefixSums::kSinglePass, true}}) {
          INFO("way " << static_cast<int>(way) << (inPlace ? " in place" : ""));
          opencl::writeLater(queue.get(), in.get(), bytes,
                             both ? static_cast<const void*>(values.data()) : plain.data());
          const cl_mem places = inPlace ? in.get() : out.get();
          const auto scan = [&, how = way]<class Sum>(opencl::PrefixSum<Sum>& sums) {
            sums.enqueue(queue.get(), BufferOf<Sum>(in.get()), BufferOf<Sum>(places), count, BufferOf<Sum>(total.get()),
                         2, profile, how);
          };
          if (both) {
            scan(two);
          } else {
            scan(one);
          }
          cl_uint found[6] = {};
          opencl::readBlocking(queue.get(), total.get(), sizeof found, found);
          bool same = both ? found[4] == sum.s[0] && found[5] == sum.s[1] : found[2] == sum.s[0];
          if (both) {
            std::vector<cl_uint2> result(count);
            opencl::readBlocking(queue.get(), places, bytes, result.data());
            for (std::uint32_t i = 0; i < count; ++i) {
              same = same && result[i].s[0] == expected[i].s[0] && result[i].s[1] == expected[i].s[1];
            }
          } else {
            std::vector<cl_uint> result(count);
            opencl::readBlocking(queue.get(), places, bytes, result.data());
            for (std::uint32_t i = 0; i < count; ++i) same = same && result[i] == expected[i].s[0];
          }
          CHECK(same);
        }
      }
    }
  }
}

TEST_CASE("named scenes have the same pairs and contacts by levels, from every start depth") {
  std::size_t pairs = 0, turn = 0;
  for (const Scene& scene : makeScenes()) {
    INFO(scene.name);
    const auto a = collisionMesh(scene.a), b = collisionMesh(scene.b);
    for (const bool swapped : {false, true}) {
      Query query = makeQuery(swapped ? *b : *a, swapped ? *a : *b, scene.bInA);
      query.options.reduction.method = swapped ? Reduction::kNone : Reduction::kBinning;
      query.options.maxContacts = 20;
      Workspace host;
      collide(query, host);
      pairs += host.intersecting.size();
      if (!swapped) {
        for (const std::uint32_t depth : {0u, 1u, 6u, 12u}) {
          if (depth == 12 && scene.a.triangles.size() > 4000) continue;  // 16 million pairs to start from
          const bool isEven = depth % 4 == 0;
          check(shared(), query, {depth, isEven, !isEven}, host);
        }
      } else {
        check(shared(), query, optionsNumber(turn++), host);
      }
    }
    Query query = makeQuery(*a, *b, scene.bInA);
    query.options.contacts = ContactModel::kSolid;
    Workspace device, host;
    CHECK(shared().published().collideByLevels(query, device, optionsNumber(turn++)));
    collide(query, host);
    CHECK(sameBytes(device.reduced, host.reduced));
  }
  CHECK(pairs > 3000);
  CHECK(shared().counts().onHost == 0);
}

TEST_CASE("levels test the same boxes as the host that goes down both trees at once") {
  std::uint64_t tests = 0;
  for (const Scene& scene : makeScenes()) {
    for (const BuildStrategy build : {BuildStrategy::kSah, BuildStrategy::kMeanSplit}) {
      INFO(scene.name);
      const CollisionMesh a(scenes::build(scene.a), build), b(scenes::build(scene.b), build);
      Query query = makeQuery(a, b, scene.bInA);
      query.options.middle = {Traversal::kStandard, DescentRule::kBoth, 6};
      Workspace host, device;
      findIntersectingPairs(query, host);
      LevelsReport fromRoots, fromSix;
      CHECK(shared().published().findPairsByLevels(query, device, {0, false, true}, &fromRoots));
      // Where one tree ends, the host takes the larger box of what is left, which is the other tree's: the same pairs.
      CHECK(device.stats.boxTests == host.stats.boxTests);
      CHECK(device.stats.candidatePairs == host.stats.candidatePairs);
      CHECK((device.intersecting == host.intersecting));
      // From depth six on the iterations are those that come to it from the roots. The exception is pairs of parents
      // that do not overlap: their children are tested all the same.
      CHECK(shared().published().findPairsByLevels(query, device, {6, false, true}, &fromSix));
      CHECK(device.stats.candidatePairs == host.stats.candidatePairs);
      if (fromRoots.steps.size() > 7) {
        REQUIRE(fromSix.steps.size() == fromRoots.steps.size() - 6);
        for (std::size_t i = 1; i < fromSix.steps.size(); ++i) {
          CHECK(fromSix.steps[i].tests == fromRoots.steps[i + 6].tests);
        }
      }
      tests += host.stats.boxTests;
    }
  }
  CHECK(tests > 100000);
}

TEST_CASE("meshes of every kind have the same intersecting pairs by levels") {
  std::vector<samples::NamedMesh> meshes = samples::ordinaryMeshes();
  for (samples::NamedMesh& mesh : samples::pathologicalMeshes()) {
    if (mesh.mesh->triangleCount() <= 1100) meshes.push_back(std::move(mesh));
  }
  samples::Soup one;  // both roots are leaves, or one of them
  one.add({-1, -0.5f, 0}, {1, -0.5f, 0.1f}, {0, 1, 0});
  meshes.push_back({"one triangle", one.build()});
  std::vector<std::shared_ptr<CollisionMesh>> trees;
  for (std::size_t i = 0; i < meshes.size(); ++i) {
    trees.push_back(
        std::make_shared<CollisionMesh>(meshes[i].mesh, i % 2 ? BuildStrategy::kSah : BuildStrategy::kMeanSplit));
  }
  Draw draw(1);
  std::size_t pairs = 0, turn = 0;
  for (std::size_t i = 0; i < trees.size(); ++i) {
    for (std::size_t j = 0; j < trees.size(); ++j) {
      INFO(meshes[i].name << " and " << meshes[j].name);
      const Vec3f ca = trees[i]->mesh().center(), cb = trees[j]->mesh().center();
      const double reach = std::min({trees[i]->mesh().radius(), trees[j]->mesh().radius(), 1e30f});  // may be infinite
      const Transformd pose = makeQuarterTurn(draw.below(24), {0, 0, 0});
      const Vec3d moved = otgTransform(pose, Vec3d{cb.x, cb.y, cb.z});
      const Vec3d jitter = draw.inBox(0.3 * reach);
      // Hundreds of copies of one triangle against the same make all pairs intersect: seconds on the host.
      if (trees[i]->mesh().triangleCount() * trees[j]->mesh().triangleCount() > 1000000) continue;
      Query query = makeQuery(*trees[i], *trees[j], pose);
      query.bInA.t = {ca.x - moved.x + jitter.x, ca.y - moved.y + jitter.y, ca.z - moved.z + jitter.z};
      query.options.maxContacts = 20;
      const LevelsOptions how = optionsNumber(turn++);
      Workspace device, host;
      collide(query, host);
      CHECK(shared().published().findPairsByLevels(query, device, how));
      CHECK((device.intersecting == host.intersecting));
      CHECK(shared().published().collideByLevels(query, device, how));
      checkSame(device, host);
      pairs += host.intersecting.size();
    }
  }
  CHECK(pairs > 5000);
  CHECK(shared().counts().onHost == 0);
}

TEST_CASE("levels give the same with lists that are too short, and with any size of work-groups") {
  const auto lump = collisionMesh(makeLump(1, 4, 0.2, 3)), torus = collisionMesh(makeTorus(0.9, 0.4, 61, 29));
  std::vector<Query> queries;
  std::vector<Workspace> expected(3);
  Draw draw(2);
  for (Workspace& host : expected) {
    queries.push_back(makeQuery(*lump, *torus, makePose(draw.direction(), draw.uniform(0, 3), draw.inBox(0.7))));
    collide(queries.back(), host);
    REQUIRE(host.intersecting.size() > 50);
  }
  const auto checkWith = [&](const opencl::Tuning& tuning, bool repeats) {
    INFO("group " << tuning.levelsGroup << " places " << tuning.pairPlaces << " " << tuning.leafPlaces << " "
                  << tuning.hitPlaces << " record group " << tuning.recordGroup);
    const auto backend = openBackend(tuning);
    REQUIRE(backend);
    for (std::size_t i = 0; i < queries.size(); ++i) {
      check(*backend, queries[i], optionsNumber(i), expected[i]);
      check(*backend, queries[i], {6, false, i % 2 == 0}, expected[i]);
    }
    CHECK((backend->counts().repeats > 0) == repeats);
    CHECK(backend->counts().onHost == 0);
  };
  opencl::Tuning roomy;
  roomy.pairPlaces = roomy.leafPlaces = 1u << 21;
  roomy.hitPlaces = 1u << 16;
  for (const std::uint32_t group : {4u, 50u, 64u, 4096u}) {  // the last one: what the device takes
    opencl::Tuning tuning = roomy;
    tuning.levelsGroup = group;
    checkWith(tuning, false);
  }
  for (int list = 0; list < 3; ++list) {  // every list too short, one after the other, down to one place
    for (const std::uint32_t places : {1u, 37u}) {
      opencl::Tuning tuning;
      (list == 0 ? tuning.pairPlaces : list == 1 ? tuning.leafPlaces : tuning.hitPlaces) = places;
      tuning.levelsGroup = places == 1 ? 64 : 256;
      checkWith(tuning, true);
    }
  }
  opencl::Tuning tuning = roomy;
  tuning.reduce = false;
  tuning.recordsExpected = 1;
  checkWith(tuning, false);
  tuning.doubles = false;
  checkWith(tuning, false);
  opencl::Tuning kept = roomy;  // more contacts than that go to the host
  kept.keptPlaces = 1;
  checkWith(kept, false);
}

TEST_CASE("trees are sent with every query, or once") {
  const auto lump = collisionMesh(makeLump(1, 4, 0.2, 3)), torus = collisionMesh(makeTorus(0.9, 0.4, 61, 29));
  const auto backend = openBackend();
  REQUIRE(backend);
  const Query two = makeQuery(*lump, *torus, makeMove({0.7, 0.1, 0})), one = makeQuery(*lump, *lump, two.bInA);
  const std::uint64_t starts = 2 * 64 * 4;
  Workspace workspace;
  LevelsReport report;
  for (int round = 0; round < 2; ++round) {
    CHECK(backend->published().collideByLevels(two, workspace, {6, true, true}, &report));
    // 2 F - 1 nodes of 32 bytes, F triangles of 48, F rings of 16.
    const std::uint64_t both = lump->mesh().triangleCount() + torus->mesh().triangleCount();
    CHECK(report.bytesSent == both * 128 - 2 * 32 + starts);
    CHECK(backend->counts().meshUploads == 0);
    CHECK(backend->published().collideByLevels(one, workspace, {6, true, true}, &report));
    CHECK(report.bytesSent == lump->mesh().triangleCount() * 128 - 32 + starts);
  }
  for (int round = 0; round < 2; ++round) {
    CHECK(backend->published().collideByLevels(two, workspace, {6, false, true}, &report));
    CHECK(report.bytesSent == starts);
    CHECK(backend->counts().meshUploads == 2);
  }
}

TEST_CASE("meshes for levels count against the budget, and either way makes room for the other") {
  const auto lump = collisionMesh(makeLump(1, 4, 0.2, 3)), torus = collisionMesh(makeTorus(0.9, 0.4, 61, 29));
  const Query query = makeQuery(*lump, *torus, makeMove({0.7, 0.1, 0}));
  opencl::Tuning tuning;
  tuning.meshBudget = 4 << 20;  // what one store takes to begin with
  const auto backend = openBackend(tuning);
  REQUIRE(backend);
  CHECK(backend->published().meshCounts().bytesHeld == 0);
  Workspace device, host;
  collide(query, host);
  for (int round = 0; round < 3; ++round) {
    CHECK(backend->collide(query, device));
    checkSame(device, host);
    CHECK(backend->published().meshCounts().bytesHeld == 0);
    CHECK(backend->counts().meshBytes > 0);
    CHECK(backend->collideByLevels(query, device));
    checkSame(device, host);
    const auto levels = backend->published().meshCounts();
    CHECK(levels.bytesHeld > 0);
    CHECK(backend->counts().meshBytes == levels.bytesUsed);
  }
  CHECK(backend->counts().onHost == 0);
  CHECK(backend->counts().meshEvictions == 2 * 5);
  CHECK(backend->counts().meshUploads == 2 * 6);
  tuning.meshBudget = 64 << 20;  // room for both
  const auto roomy = openBackend(tuning);
  for (int round = 0; round < 3; ++round) {
    CHECK(roomy->collide(query, device));
    CHECK(roomy->collideByLevels(query, device));
    checkSame(device, host);
  }
  CHECK(roomy->counts().meshUploads == 4);
  CHECK(roomy->counts().meshEvictions == 0);
}

TEST_CASE("levels with nothing to do, and a pose that is refused") {
  const auto box = collisionMesh(makeBox({1, 1, 1}, 1)), empty = collisionMesh({});
  Workspace workspace;
  LevelsReport report;
  CHECK(shared().published().collideByLevels(makeQuery(*empty, *box, makeMove({0, 0, 0})), workspace, {}, &report));
  CHECK(workspace.reduced.empty());
  CHECK(report.steps.empty());
  CHECK(shared().published().collideByLevels(makeQuery(*box, *box, makeMove({5, 0, 0})), workspace, {}, &report));
  CHECK(workspace.reduced.empty());
  CHECK(report.steps.size() == 1);
  Query query = makeQuery(*box, *box, makeMove({0.9, 0, 0}));
  query.bInA.r[0] = 1.5;
  CHECK_THROWS_AS(shared().published().collideByLevels(query, workspace, {}), std::invalid_argument);
  CHECK_THROWS_AS(shared().published().findPairsByLevels(query, workspace, {}), std::invalid_argument);
}

TEST_CASE("taking times of levels changes nothing") {
  const auto a = collisionMesh(makeLump(1, 5, 0.2, 3)), b = collisionMesh(makeTorus(0.9, 0.4, 61, 29));
  const Query query = makeQuery(*a, *b, makePose({0, 0, 1}, 1, {0.3, 0.2, 0.1}));
  Workspace device, host;
  collide(query, host);
  for (const bool sent : {false, true}) {
    for (const bool fused : {false, true}) {
      LevelsReport report;
      CHECK(shared().published().collideByLevels(query, device, {6, sent, fused}, &report, true));
      checkSame(device, host);
      const opencl::LevelsTimes& t = report.times;
      for (const double ms : {t.upload, t.start, t.test, t.scan, t.compaction, t.split, t.spawn, t.near, t.regions}) {
        CHECK(ms > 0);
      }
      CHECK((t.contacts > 0) == !fused);
      CHECK(t.total > 0);
    }
  }
}

TEST_CASE("whichever call of levels fails, the contacts are the same") {
  const auto a = collisionMesh(makeLump(1, 3, 0.2, 1)), b = collisionMesh(makeTorus(1, 0.3, 31, 17));
  const Query query = makeQuery(*a, *b, makePose({0.48, 0.6, 0.64}, 0.7, {1.1, 0.4, 0.1}));
  opencl::Tuning tuning;
  tuning.pairPlaces = tuning.leafPlaces = tuning.hitPlaces = 100;  // lists grow on the way
  Workspace host;
  collide(query, host);
  REQUIRE(host.reduced.size() > 10);
  opencl::forgetFailures();
  std::set<std::string> lines;
  opencl::setLogSink([&](const std::string& line) { lines.insert(line); });
  for (const LevelsOptions& how : {LevelsOptions{6, false, true}, LevelsOptions{3, true, false}}) {
    const std::shared_ptr<opencl::Backend> backend = openBackend(tuning);
    REQUIRE(backend);
    int failed = 0;
    // A lane in which a call failed is dropped, so that every query that fails begins with making one.
    const auto run = [&](std::uint64_t nth, std::uint64_t more) {
      const std::uint64_t before = opencl::FaultInjection::callCount();
      opencl::FaultInjection::failAt(nth, CL_OUT_OF_RESOURCES, more);
      Workspace device;
      const bool ran = backend->published().collideByLevels(query, device, how);
      opencl::FaultInjection::failAt(0);
      REQUIRE(sameBytes(device.reduced, host.reduced));
      failed += ran ? 0 : 1;
      return opencl::FaultInjection::callCount() - before;
    };
    std::uint64_t calls = 0;
    {
      const std::shared_ptr<opencl::Backend> other = openBackend(tuning);
      const std::uint64_t before = opencl::FaultInjection::callCount();
      Workspace device;
      REQUIRE(other->published().collideByLevels(query, device, how));
      calls = opencl::FaultInjection::callCount() - before;
    }
    CHECK(calls > 150);
    for (std::uint64_t n = 1; n <= calls; ++n) run(n, n % 3 == 0 ? 1000000 : 0);
    CHECK(failed > 100);
    failed = 0;
    run(0, 0);  // the backend is as good as new
    run(0, 0);
    CHECK(failed == 0);
  }
  opencl::setLogSink({});
  CHECK(lines.size() > 5);
}
