// SPDX-License-Identifier: BSD-3-Clause
// Batches dealt out between the CPU and several devices: the results are those of the CPU, whoever computes, also when
// devices fail.
#include <atomic>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <thread>

#include "dispatch/cost/calibration.h"
#include "dispatch/dispatcher.h"
#include "dispatch/host_batch.h"
#include "opencl/runtime/call.h"
#include "opencl/runtime/log.h"
#include "support/mesh_samples.h"
#include "support/opencl.h"

using namespace otg;
using namespace otg::scenes;
using namespace otg::test;

namespace {

using MeshList = std::vector<std::shared_ptr<const CollisionMesh>>;

/// From one triangle to thousands, closed and open.
MeshList mixedMeshes() {
  MeshList meshes;
  samples::Soup one;
  one.add({-1, -0.5f, 0}, {1, -0.5f, 0.1f}, {0, 1, 0});
  meshes.push_back(std::make_shared<CollisionMesh>(one.build(), BuildStrategy::kSah));
  for (const MeshArrays& arrays :
       {makeTetrahedron({0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}), makeBox({1, 1.5, 0.8}, 1), makeBox({1, 1, 1}, 7),
        makeSphere(0.8, 2), makeTorus(0.7, 0.25, 31, 13), makeLump(0.9, 4, 0.2, 5), makeLump(0.9, 5, 0.2, 6)}) {
    meshes.push_back(collisionMesh(arrays));
  }
  meshes.push_back(std::make_shared<CollisionMesh>(samples::randomSoup(3, 300, 0.5f, 0.4f), BuildStrategy::kMeanSplit));
  return meshes;
}

constexpr Placement kPlacements[] = {{Place::kOpencl, Place::kOpencl}, {Place::kCpu, Place::kCpu},
                                     {Place::kAuto, Place::kAuto},     {Place::kCpu, Place::kOpencl},
                                     {Place::kOpencl, Place::kCpu},    {Place::kAuto, Place::kOpencl},
                                     {Place::kCpu, Place::kAuto}};

/// A batch with all that a job may ask for, and what otg::collide says of each.
struct Batch {
  std::vector<PairJob> jobs;
  std::vector<SolidHistory> before, histories;
  std::vector<PairResult> expected;
  std::vector<SolidHistory> expectedHistories;

  Batch(const MeshList& meshes, std::uint32_t seed, std::size_t count, bool onePlacement = false,
        Placement placement = {}) {
    Draw draw(seed);
    for (std::size_t i = 0; i < count; ++i) {
      const auto any = [&]() -> const CollisionMesh& {
        return *meshes[draw.below(static_cast<std::uint32_t>(meshes.size()))];
      };
      PairJob job;
      const CollisionMesh& a = any();
      job.query = makeQuery(a, any(), makePose(draw.direction(), draw.uniform(0, 3), draw.inBox(0.9)));
      job.query.options.maxContacts = i % 3 == 0 ? 5 : 200;
      job.query.options.contacts = i % 2 == 0 ? ContactModel::kSolid : ContactModel::kPairwise;
      if (i % 7 == 0) job.query.options.reduction.method = Reduction::kNone;
      if (i % 31 == 0) job.query.bInA.t.x = NAN;
      job.any = i % 13 == 0;
      job.place = onePlacement ? placement : kPlacements[i % std::size(kPlacements)];
      jobs.push_back(job);
    }
    before.resize(count);
    for (std::size_t i = 0; i < count; i += 2) {  // of queries at another pose
      Query query = jobs[i].query;
      query.bInA.t.y += 0.001;
      query.history = &before[i];
      Workspace workspace;
      if (std::isfinite(query.bInA.t.x)) collide(query, workspace);
    }
    histories = before;
    expected.resize(count);
    for (std::size_t i = 0; i < count; ++i) {
      PairJob job = jobs[i];
      if (i % 2 == 0) job.query.history = &histories[i];
      Workspace workspace;
      keepOutcome(expected[i], workspace, [&] { return collideOnHost(job, workspace); });
    }
    expectedHistories = histories;
  }

  std::vector<const PairJob*> start() {
    histories = before;
    std::vector<const PairJob*> list;
    for (std::size_t i = 0; i < jobs.size(); ++i) {
      jobs[i].query.history = i % 2 == 0 ? &histories[i] : nullptr;
      list.push_back(&jobs[i]);
    }
    return list;
  }

  void check(const std::vector<PairResult>& found) const {
    std::size_t wrong = 0, wrongHistories = 0;
    for (std::size_t i = 0; i < jobs.size(); ++i) {
      const bool same = found[i].outcome == expected[i].outcome && sameBytes(found[i].contacts, expected[i].contacts);
      wrong += same ? 0 : 1;
      const SolidHistory &x = histories[i], &y = expectedHistories[i];
      wrongHistories += x.used == y.used && x.current.escapeLeft == y.current.escapeLeft &&
                                x.current.clampLeft == y.current.clampLeft &&
                                std::equal(std::begin(x.current.pose.r), std::end(x.current.pose.r), y.current.pose.r)
                            ? 0
                            : 1;
    }
    CHECK(wrong == 0);
    CHECK(wrongHistories == 0);
  }
  std::vector<PairResult> run(Dispatcher& dispatcher) {
    std::vector<PairResult> found(jobs.size());
    end = dispatcher.collideBatch(start(), found);
    check(found);
    return found;
  }
  BatchEnd end;  ///< of the last run: what contacts lie in
};

std::size_t open(Dispatcher& dispatcher, std::size_t count, const opencl::Tuning& tuning = {}) {
  const std::vector<int> indices(count, opencl::defaultDevice(opencl::listDevices()));
  return dispatcher.open(indices, tuning);
}

/// Costs by which a device takes about `share` of what is open.
CostModel costsFor(double share) {
  CostModel costs;
  costs.hostPairs = costs.hostPairwise = costs.hostSolid = {10, 0.01};
  costs.devicePairs = costs.devicePairwise = costs.batchPair = {10 * (1 - share) / share, 0.01 * (1 - share) / share};
  costs.batchSolid = costs.batchPair;
  return costs;
}

class LogCapture {
 public:
  LogCapture() {
    opencl::forgetFailures();
    opencl::setLogSink([this](const std::string& line) { lines.push_back(line); });
  }
  ~LogCapture() { opencl::setLogSink({}); }
  std::vector<std::string> lines;
};

}  // namespace

TEST_CASE("one to four devices give what the CPU gives, for every placement") {
  const MeshList meshes = mixedMeshes();
  Batch mixed(meshes, 1, 170);
  std::size_t contacts = 0;
  for (const PairResult& result : mixed.expected) contacts += result.contacts.size();
  REQUIRE(contacts > 1500);
  for (std::size_t count = 1; count <= 4; ++count) {
    Dispatcher dispatcher;
    REQUIRE(open(dispatcher, count) == count);
    for (const unsigned threads : {1u, 3u}) {
      dispatcher.setThreadCount(threads);
      mixed.run(dispatcher);
      for (const Placement& placement : kPlacements) {
        Batch(meshes, 2 + threads, 30, true, placement).run(dispatcher);
      }
    }
    for (const auto& slot : dispatcher.devices()) {
      CHECK(slot->queries > 25);
      CHECK(slot->failedQueries == 0);
      CHECK(!slot->isOff);
      CHECK(slot->backend->counts().onHost == 0);
    }
  }
}

namespace {

/// 600 pairs of two lumps. They live as long as this.
struct Lumps {
  const MeshList meshes = {collisionMesh(makeLump(0.9, 3, 0.2, 1)), collisionMesh(makeLump(0.9, 2, 0.2, 2))};
  std::vector<PairJob> jobs = std::vector<PairJob>(600);
  std::vector<const PairJob*> list;

  explicit Lumps(ContactModel model) {
    Draw draw(5);
    for (PairJob& job : jobs) {
      job.query = makeQuery(*meshes[draw.below(2)], *meshes[draw.below(2)],
                            makePose(draw.direction(), draw.uniform(0, 3), draw.inBox(1)));
      job.query.options.maxContacts = 8;
      job.query.options.contacts = model;
      list.push_back(&job);
    }
  }
};

void checkDivision(ContactModel model) {
  const Lumps lumps(model);
  const std::vector<PairJob>& jobs = lumps.jobs;
  const std::vector<const PairJob*>& list = lumps.list;
  std::vector<PairResult> expected(jobs.size());
  Dispatcher host;
  const BatchEnd ofHost = host.collideBatch(list, expected);
  for (std::size_t count = 1; count <= 4; ++count) {
    Dispatcher dispatcher;
    REQUIRE(open(dispatcher, count) == count);
    dispatcher.setTakeOver(false);  // as planned
    dispatcher.setThreadCount(1);
    for (const auto& slot : dispatcher.devices()) slot->costs = costsFor(0.5);
    std::vector<PairResult> found(jobs.size());
    const BatchEnd end = dispatcher.collideBatch(list, found);
    std::size_t wrong = 0, onDevice = 0;
    for (std::size_t i = 0; i < jobs.size(); ++i) {
      wrong += sameBytes(found[i].contacts, expected[i].contacts) ? 0 : 1;
      onDevice += found[i].onDevice ? 1 : 0;
      // Contiguous: devices first. Of solids some are left to the CPU.
      if (i > 0 && model == ContactModel::kPairwise) CHECK((found[i - 1].onDevice || !found[i].onDevice));
    }
    CHECK(wrong == 0);
    const double share = 600.0 / static_cast<double>(count + 1);
    if (model == ContactModel::kPairwise) {
      CHECK(std::abs(static_cast<double>(jobs.size() - onDevice) - share) < 0.15 * share);
    }
    for (const auto& slot : dispatcher.devices()) {
      CHECK(slot->calls == 1);
      CHECK(std::abs(static_cast<double>(slot->queries.load()) - share) < 0.15 * share);
    }
  }
}

}  // namespace

TEST_CASE("devices get blocks of equal cost, and a batch is divided between them and the CPU") {
  checkDivision(ContactModel::kPairwise);
}

TEST_CASE("batches of solids are divided, too, where their costs are known") {
  checkDivision(ContactModel::kSolid);
}

TEST_CASE("large overlaps of solids all go to devices where these are faster with them") {
  const Lumps lumps(ContactModel::kSolid);
  Dispatcher dispatcher;
  REQUIRE(open(dispatcher, 1) == 1);
  dispatcher.setTakeOver(false);
  dispatcher.setThreadCount(1);
  DeviceSlot& slot = *dispatcher.devices()[0];
  for (const double dearer : {1.5, 0.5}) {  // on the CPU than on the device
    CostModel costs = costsFor(0.5);
    costs.batchLarge = costs.batchSolid;
    costs.hostLarge = {dearer * costs.batchLarge.fixed, dearer * costs.batchLarge.perTriangle};
    costs.largeWork = 1e-9;  // all of them
    slot.costs = costs;
    std::vector<PairResult> found(lumps.jobs.size());
    const BatchEnd end = dispatcher.collideBatch(lumps.list, found);
    INFO(slot.blockPairs);
    CHECK((slot.blockPairs > 590) == (dearer > 1));
    CHECK(slot.blockPairs > 100);
  }
}

TEST_CASE("single queries run where they are requested, or where they are faster") {
  const auto a = collisionMesh(makeLump(0.9, 4, 0.2, 1)), b = collisionMesh(makeTorus(0.7, 0.25, 31, 13));
  Dispatcher dispatcher;
  REQUIRE(open(dispatcher, 2) == 2);
  for (const bool solid : {false, true}) {
    for (const bool any : {false, true}) {
      for (const Placement& placement : kPlacements) {
        for (const double share : {0.01, 0.99}) {
          for (const auto& slot : dispatcher.devices()) slot->costs = costsFor(share);
          PairJob job;
          job.query = makeQuery(*a, *b, makePose({0.48, 0.6, 0.64}, 0.7, {0.5, 0.4, 0.1}));
          job.query.options.contacts = solid ? ContactModel::kSolid : ContactModel::kPairwise;
          job.query.options.maxContacts = 50;
          job.any = any;
          job.place = placement;
          Workspace here, there;
          const std::span<const Contact> expected = collideOnHost(job, here);
          REQUIRE(!expected.empty());
          Dispatcher::Ran ran;
          CHECK(sameBytes(dispatcher.collide(job, there, ran), expected));
          const bool isOpen = placement == Placement{};
          const bool asked = placement.middle == Place::kOpencl || placement.near == Place::kOpencl;
          CHECK(ran.onDevice == (isOpen ? share > 0.5 : asked));
          CHECK(!ran.deviceFailed);
        }
      }
    }
  }
}

TEST_CASE("a pair of convex meshes never goes to a device, and one on a surface in no batch") {
  const auto box = collisionMesh(makeBox({1, 1, 1}, 3)), ball = collisionMesh(makeSphere(0.5, 3)),
             torus = collisionMesh(makeTorus(0.7, 0.25, 31, 13));
  Dispatcher dispatcher;
  REQUIRE(open(dispatcher, 1) == 1);
  for (const Placement& placement : kPlacements) {
    std::vector<PairJob> jobs;
    for (const auto& [a, b] : {std::pair{&box, &box}, {&box, &ball}, {&ball, &torus}, {&ball, &ball}, {&torus, &box}}) {
      PairJob job;
      job.query = makeQuery(**a, **b,
                            makePose({0, 0, 1}, 0.3,
                                     {0.1, 0.2,
                                      b == &torus   ? 0.3
                                      : a == &torus ? 0.73
                                                    : 0.95}));
      job.query.options.contacts = ContactModel::kSolid;
      job.query.options.solid.convexPath = true;
      job.place = placement;
      jobs.push_back(job);
    }
    std::vector<PairWork> work;
    std::vector<PairResult> results(jobs.size());
    for (std::size_t i = 0; i < jobs.size(); ++i) work.push_back({&jobs[i], &results[i]});
    const BatchEnd end = dispatcher.collideBatch(work);
    for (std::size_t i = 0; i < jobs.size(); ++i) {
      Workspace here, there;
      const std::span<const Contact> expected = collideOnHost(jobs[i], here);
      CHECK(!expected.empty());
      Dispatcher::Ran ran;
      CHECK(sameBytes(dispatcher.collide(jobs[i], there, ran), expected));
      CHECK(sameBytes(results[i].contacts, expected));
      if (i == 2) continue;
      if (i < 4) CHECK_FALSE(ran.onDevice);
      CHECK_FALSE(results[i].onDevice);
    }
  }
}

TEST_CASE("work that may be done anywhere does not go to a device of type CPU, however cheap it looks") {
  if (opencl::listDevices()[static_cast<std::size_t>(opencl::defaultDevice(opencl::listDevices()))].kind !=
      opencl::DeviceKind::kCpu) {
    return;
  }
  const bool before = letCpusTakeAuto(false);
  Dispatcher dispatcher;
  const std::size_t count = open(dispatcher, 1);
  letCpusTakeAuto(before);
  REQUIRE(count == 1);
  const auto slot = dispatcher.devices().front();
  CHECK_FALSE(slot->isForAuto);
  slot->costs = costsFor(1 - 1e-6);
  slot->costs.hostOverlap = slot->costs.hostDistance = {10, 0.01};
  slot->costs.batchOverlap = slot->costs.batchDistance = {1e-6, 0};
  slot->costs.overlapLaunch = slot->costs.distanceLaunch = 1e-6;
  const MeshList meshes = mixedMeshes();
  const auto onDevice = [&](Placement placement) {
    Batch batch(meshes, 3, 60, true, placement);
    std::size_t those = 0;
    for (const PairResult& result : batch.run(dispatcher)) those += result.onDevice ? 1 : 0;
    return those;
  };
  CHECK(onDevice({Place::kAuto, Place::kAuto}) == 0);
  CHECK(onDevice({Place::kAuto, Place::kOpencl}) > 20);
  CHECK(onDevice({Place::kOpencl, Place::kOpencl}) > 20);
  Batch mixed(meshes, 5, 140);  // jobs of either kind in one call
  const std::vector<PairResult> found = mixed.run(dispatcher);
  std::size_t wrong = 0;
  for (std::size_t i = 0; i < found.size(); ++i) {
    wrong += isOpenToAll(mixed.jobs[i].place) && (found[i].onDevice || found[i].deviceFailed) ? 1 : 0;
  }
  CHECK(wrong == 0);
  // Single pairs, and arrays of pairs.
  Workspace workspace;
  Dispatcher::Ran ran;
  const std::uint64_t queries = slot->queries;
  std::vector<OverlapJob> jobs(100);
  for (OverlapJob& job : jobs) job.pair = {meshes[3].get(), meshes[4].get(), makeMove({0.9, 0, 0})};
  std::vector<std::uint8_t> answers(jobs.size());
  std::vector<MeshDistance> distances(jobs.size());
  for (const Place place : {Place::kAuto, Place::kOpencl}) {
    PairJob one;
    one.query = makeQuery(*meshes[6], *meshes[7], makeMove({0.9, 0, 0}));
    one.place = {place, place};
    dispatcher.collide(one, workspace, ran);
    CHECK(ran.onDevice == (place == Place::kOpencl));
    for (OverlapJob& job : jobs) job.place = place;
    dispatcher.askOverlaps(jobs, answers);
    dispatcher.askDistances(jobs, 1e9, distances);
    if (place == Place::kAuto) CHECK(slot->queries == queries);
  }
  CHECK(slot->queries >= queries + 101);
}

TEST_CASE("a device that fails for good is switched off, reported once, and the contacts are the same") {
  const MeshList meshes = mixedMeshes();
  Batch batch(meshes, 9, 90, true, {Place::kOpencl, Place::kOpencl});
  LogCapture log;
  Dispatcher dispatcher;
  REQUIRE(open(dispatcher, 2) == 2);
  dispatcher.setThreadCount(2);
  batch.run(dispatcher);
  CHECK(log.lines.empty());
  opencl::FaultInjection::failAt(1, CL_OUT_OF_RESOURCES, 1u << 30);
  for (int round = 0; round < 6; ++round) {
    const std::vector<PairResult> found = batch.run(dispatcher);
    for (const PairResult& result : found) CHECK_FALSE((result.onDevice && result.deviceFailed));
  }
  const auto slots = dispatcher.devices();
  std::size_t reported = 0;
  for (const std::string& line : log.lines) reported += line.find("switched off") != std::string::npos ? 1 : 0;
  CHECK(reported == 2);
  for (const auto& slot : slots) {
    CHECK(slot->isOff);
    CHECK(slot->failedCalls >= DeviceSlot::kMostFailures);
    CHECK(slot->failedQueries >= DeviceSlot::kMostFailures);
  }
  // From here on nothing is tried any more.
  const std::uint64_t calls = opencl::FaultInjection::callCount();
  batch.run(dispatcher);
  PairJob job = batch.jobs[1];
  job.query.history = nullptr;
  Workspace workspace;
  Dispatcher::Ran ran;
  dispatcher.collide(job, workspace, ran);
  CHECK(opencl::FaultInjection::callCount() == calls);
  CHECK_FALSE((ran.onDevice || ran.deviceFailed));
  opencl::FaultInjection::failAt(0);
  // Opened again, it works.
  REQUIRE(open(dispatcher, 1) == 1);
  batch.run(dispatcher);
  CHECK(dispatcher.devices()[0]->failedCalls == 0);
}

TEST_CASE("failures now and then do not switch a device off") {
  const LogCapture log;
  const MeshList meshes = mixedMeshes();
  Batch batch(meshes, 12, 60, true, {Place::kOpencl, Place::kOpencl});
  Dispatcher dispatcher;
  REQUIRE(open(dispatcher, 1) == 1);
  dispatcher.setThreadCount(1);
  batch.run(dispatcher);  // uploads
  const std::uint64_t before = opencl::FaultInjection::callCount();
  batch.run(dispatcher);
  const std::uint64_t calls = opencl::FaultInjection::callCount() - before;
  REQUIRE(calls > 80);
  // A run has 100 calls or more, by the lanes that it gets and what they have room for.
  constexpr int kRounds = 5;
  for (int round = 0; round < kRounds; ++round) {
    opencl::FaultInjection::failAt(static_cast<std::uint64_t>(1 + 16 * round));
    batch.run(dispatcher);
    opencl::FaultInjection::failAt(0);
    batch.run(dispatcher);
  }
  CHECK(dispatcher.devices()[0]->failedCalls >= kRounds);
  CHECK(!dispatcher.devices()[0]->isOff);
}

TEST_CASE("whichever call fails while devices are opened and used, the contacts are the same") {
  const LogCapture log;
  const MeshList meshes = {collisionMesh(makeLump(0.9, 2, 0.2, 1)), collisionMesh(makeTorus(0.7, 0.25, 15, 9))};
  Batch batch(meshes, 3, 24);
  const std::uint64_t before = opencl::FaultInjection::callCount();
  {
    Dispatcher dispatcher;
    REQUIRE(open(dispatcher, 2) == 2);
    batch.run(dispatcher);
  }
  const std::uint64_t calls = opencl::FaultInjection::callCount() - before;
  for (std::uint64_t n = 1; n < calls; n += 1 + calls / 25) {
    for (const std::uint64_t more : {0u, 1u << 30}) {
      opencl::FaultInjection::failAt(n, CL_OUT_OF_HOST_MEMORY, more);
      Dispatcher dispatcher;
      CHECK(open(dispatcher, 2) <= 2);
      batch.run(dispatcher);
      opencl::FaultInjection::failAt(0);
    }
  }
}

TEST_CASE("several threads submit batches and single queries at once") {
  const MeshList meshes = mixedMeshes();
  Dispatcher dispatcher;
  REQUIRE(open(dispatcher, 2) == 2);
  dispatcher.setThreadCount(2);
  std::atomic<int> wrong{0};
  std::vector<Batch> batches;
  for (std::uint32_t t = 0; t < 4; ++t) batches.emplace_back(meshes, 40 + t, 80);
  std::vector<std::thread> threads;
  for (std::size_t t = 0; t < 4; ++t) {
    threads.emplace_back([&, t] {
      Batch& batch = batches[t];
      for (int round = 0; round < 2; ++round) {
        std::vector<PairResult> found(batch.jobs.size());
        const BatchEnd end = dispatcher.collideBatch(batch.start(), found);
        for (std::size_t i = 0; i < found.size(); ++i) {
          if (!sameBytes(found[i].contacts, batch.expected[i].contacts)) ++wrong;
        }
        for (std::size_t i = 1; i < 20; i += 2) {
          if (i == 31 || batch.expected[i].outcome != PairResult::Outcome::kDone) continue;
          Workspace workspace;
          Dispatcher::Ran ran;
          if (!sameBytes(dispatcher.collide(batch.jobs[i], workspace, ran), batch.expected[i].contacts)) ++wrong;
        }
        if (t == 0) dispatcher.setThreadCount(3);
      }
    });
  }
  for (std::thread& thread : threads) thread.join();
  CHECK(wrong == 0);
}

TEST_CASE("costs are measured once, stored, and measured again when the file is damaged") {
  namespace fs = std::filesystem;
  const fs::path folder = fs::path(std::getenv("OTG_CACHE_DIR")) / "costs";
  const opencl::ProgramCache cache(folder.string());
  const auto backend = openBackend();
  REQUIRE(backend);
  const std::optional<CostModel> first = costsOf(*backend, cache);
  REQUIRE(first.has_value());
  CHECK(first->isSane());
  CHECK(first->hostPairs.of(1e5) > first->hostPairs.of(10));
  const std::uint64_t calls = opencl::FaultInjection::callCount();
  CHECK(costsOf(*backend, cache) == first);
  CHECK(opencl::FaultInjection::callCount() == calls);  // not measured
  const fs::path path = cache.pathOf(costKey(backend->device()));
  REQUIRE(fs::exists(path));
  const auto bytesOf = [&] {
    std::ifstream in(path, std::ios::binary);
    return std::vector<char>(std::istreambuf_iterator<char>(in), {});
  };
  const std::vector<char> good = bytesOf();
  for (const std::size_t at : {std::size_t{0}, std::size_t{20}, std::size_t{50}, good.size() / 2, good.size() - 1}) {
    std::vector<char> bad = good;
    bad[at] ^= 0x20;
    std::ofstream(path, std::ios::binary).write(bad.data(), static_cast<std::streamsize>(bad.size()));
    const std::uint64_t count = opencl::FaultInjection::callCount();
    const std::optional<CostModel> again = costsOf(*backend, cache);
    REQUIRE(again.has_value());
    CHECK(again->isSane());
    CHECK(opencl::FaultInjection::callCount() > count);
    CHECK(costsOf(*backend, cache) == again);
  }
  // A sound file with numbers that make no sense.
  CostModel nonsense = *first;
  nonsense.batchPair = {-1, NAN};
  REQUIRE(cache.store(costKey(backend->device()), toBytes(nonsense)));
  CHECK(costsOf(*backend, cache)->isSane());
  // A device that fails has no costs, and nothing is stored.
  fs::remove(path);
  const LogCapture log;
  opencl::FaultInjection::failAt(5, CL_OUT_OF_RESOURCES, 1u << 30);
  CHECK(!costsOf(*backend, cache).has_value());
  opencl::FaultInjection::failAt(0);
  CHECK(!fs::exists(path));
}
