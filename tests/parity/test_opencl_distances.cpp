// SPDX-License-Identifier: BSD-3-Clause
// Distances of many pairs of meshes on a device against the same pairs on the CPU, one by one: byte for byte.
#include <atomic>
#include <limits>
#include <thread>

#include "dispatch/dispatcher.h"
#include "support/distance_samples.h"
#include "support/failing_calls.h"
#include "support/opencl.h"

using namespace otg;
using namespace otg::test;

namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// All that is said of a pair, as bits: 0 is not -0.
struct Bits {
  std::array<std::uint64_t, 3> pointA, pointB;
  std::uint64_t distance;
  std::uint32_t triangleA, triangleB;
  bool found;
  bool operator==(const Bits&) const = default;
};

Bits bitsOf(const MeshDistance& d) {
  return {std::bit_cast<std::array<std::uint64_t, 3>>(d.pointA),
          std::bit_cast<std::array<std::uint64_t, 3>>(d.pointB),
          std::bit_cast<std::uint64_t>(d.distance),
          d.triangleA,
          d.triangleB,
          d.found};
}

/// Trees are kept as long as this lives.
struct Pairs {
  std::vector<std::shared_ptr<const CollisionMesh>> meshes;
  std::vector<OverlapJob> jobs;
};

/// Every mesh with every one, in some poses each.
Pairs allPairs(const std::vector<samples::NamedMesh>& meshes, int poses, BuildStrategy strategy = BuildStrategy::kSah) {
  Pairs all;
  Draw draw(4);
  for (const auto& [name, mesh] : meshes) all.meshes.push_back(std::make_shared<CollisionMesh>(mesh, strategy));
  for (const auto& a : all.meshes) {
    for (const auto& b : all.meshes) {
      for (int i = 0; i < poses; ++i) {
        const Transformd pose = samples::poseForDistance(a->mesh(), b->mesh(), draw, i);
        all.jobs.push_back({{a.get(), b.get(), pose}, Place::kOpencl});
      }
    }
  }
  return all;
}

std::vector<std::size_t> everyone(std::size_t count) {
  std::vector<std::size_t> which(count);
  for (std::size_t i = 0; i < count; ++i) which[i] = i;
  return which;
}

std::vector<Bits> onDevice(DeviceSlot& slot, ThreadPool& pool, const Pairs& pairs, double limit) {
  std::vector<MeshDistance> answers(pairs.jobs.size());
  measureOnDevice(slot, pool, pairs.jobs, everyone(pairs.jobs.size()), limit, answers);
  std::vector<Bits> bits;
  for (const MeshDistance& one : answers) bits.push_back(bitsOf(one));
  return bits;
}

std::vector<Bits> oneByOne(const Pairs& pairs, double limit) {
  std::vector<Bits> bits;
  for (const OverlapJob& job : pairs.jobs) bits.push_back(bitsOf(meshDistance(opencl::queryOf(job.pair), limit)));
  return bits;
}

std::size_t differences(const std::vector<Bits>& x, const std::vector<Bits>& y) {
  REQUIRE(x.size() == y.size());
  std::size_t count = 0;
  for (std::size_t i = 0; i < x.size(); ++i) count += x[i] == y[i] ? 0 : 1;
  return count;
}

}  // namespace

TEST_CASE("meshes have the same distance on the device, byte for byte") {
  const auto slot = openSlot();
  ThreadPool pool(3);
  std::vector<samples::NamedMesh> meshes = samples::meshesForDistances();
  meshes.push_back({"fine lump", scenes::build(scenes::makeLump(1, 4, 0.3, 3))});
  const Pairs pairs = allPairs(meshes, 8);
  std::size_t all = 0, none = 0, zero = 0;
  for (const double limit : {kInfinity, 1.5, 0.1, 0.0}) {
    INFO("limit " << limit);
    const std::vector<Bits> host = oneByOne(pairs, limit);
    CHECK(differences(onDevice(*slot, pool, pairs, limit), host) == 0);
    for (const Bits& bits : host) {
      none += bits.found ? 0 : 1;
      zero += bits.found && bits.distance == 0 ? 1 : 0;
    }
    all += host.size();
  }
  CHECK(slot->failedCalls == 0);
  CHECK(slot->backend->counts().distances > all / 3);
  CHECK(slot->backend->counts().distancesOnHost == 0);
  CHECK(none > 500);
  CHECK(zero > 100);
  CHECK(all - none - zero > 700);
}

TEST_CASE("the distance does not depend on the tree, the sizes of launches or the number of threads") {
  const std::vector<samples::NamedMesh> meshes = samples::meshesForDistances();
  const Pairs pairs = allPairs(meshes, 2), others = allPairs(meshes, 2, BuildStrategy::kMeanSplit);
  std::vector<Bits> expected = oneByOne(pairs, kInfinity);
  for (const unsigned threads : {1u, 4u}) {
    ThreadPool pool(threads);
    for (const auto& [piece, group, leaf, room] :
         {std::tuple{1u << 14, 128u, 2u, 512u}, {7u, 64u, 8u, 16u}, {1u, 32u, 1u, 16u}, {100u, 256u, 4u, 64u}}) {
      opencl::Tuning tuning;
      tuning.distancePairs = piece;
      tuning.batchGroup = group;
      tuning.leafTriangles = leaf;
      tuning.stackRoom = room;
      const auto slot = openSlot(tuning);
      INFO(threads << " threads, pieces of " << piece << ", groups of " << group << ", leaves of " << leaf);
      CHECK(differences(onDevice(*slot, pool, pairs, kInfinity), expected) == 0);
      const std::vector<Bits> byOther = onDevice(*slot, pool, others, kInfinity);
      for (std::size_t i = 0; i < byOther.size(); ++i) {
        // Of meshes that overlap, the point that both have is whichever is found first.
        if (expected[i].distance != 0) CHECK((byOther[i] == expected[i]));
      }
      CHECK(slot->failedCalls == 0);
    }
  }
}

TEST_CASE("sizes beyond single precision are the CPU's") {
  const auto slot = openSlot();
  ThreadPool pool(2);
  Pairs pairs;
  for (const float size : {1e-20f, 1e-9f, 1e6f, 1e17f}) {
    scenes::MeshArrays arrays = scenes::makeLump(1, 1, 0.2, 3);
    for (Vec3f& v : arrays.vertices) v = {size * v.x, size * v.y, size * v.z};
    pairs.meshes.push_back(collisionMesh(arrays));
    const auto& mesh = *pairs.meshes.back();
    const double apart = 3 * static_cast<double>(size);
    pairs.jobs.push_back({{&mesh, &mesh, makePose({0, 0, 1}, 0.3, {apart, apart, 0})}, Place::kOpencl});
  }
  for (const double far : {1e9, 1e17, 1e30}) {
    const auto& mesh = *pairs.meshes[2];
    pairs.jobs.push_back({{&mesh, &mesh, makePose({0, 0, 1}, 0.3, {far, 0, far})}, Place::kOpencl});
  }
  CHECK(differences(onDevice(*slot, pool, pairs, kInfinity), oneByOne(pairs, kInfinity)) == 0);
  CHECK(slot->failedCalls == 0);
}

TEST_CASE("no pairs, and pairs that all overlap") {
  const auto slot = openSlot();
  ThreadPool pool(2);
  CHECK(onDevice(*slot, pool, {}, kInfinity).empty());
  Pairs inside;
  inside.meshes = {collisionMesh(scenes::makeLump(1, 2, 0.1, 3)), collisionMesh(scenes::makeLump(0.3, 2, 0.1, 3))};
  inside.jobs.push_back({{inside.meshes[0].get(), inside.meshes[1].get(), {{1, 0, 0, 0, 1, 0, 0, 0, 1}, {}}}, {}});
  inside.jobs.push_back({{inside.meshes[0].get(), inside.meshes[0].get(), makePose({0, 0, 1}, 0.1, {0.1, 0, 0})}, {}});
  const std::vector<Bits> device = onDevice(*slot, pool, inside, kInfinity);
  CHECK(differences(device, oneByOne(inside, kInfinity)) == 0);
  CHECK(device[0].triangleA == kNone);
  CHECK(device[1].triangleA != kNone);
  CHECK(slot->failedCalls == 0);
  CHECK(slot->backend->counts().distances == 0);
}

TEST_CASE("whichever call fails, the distances are the same") {
  const std::vector<samples::NamedMesh> some = {{"lump", scenes::build(scenes::makeLump(1, 1, 0.3, 7))},
                                                {"box", scenes::build(scenes::makeBox({1, 1.5, 0.5}, 1))}};
  const std::vector<Bits> expected = oneByOne(allPairs(some, 4), kInfinity);
  opencl::Tuning tuning;
  tuning.distancePairs = 5;  // three pieces
  tuning.distanceWork = 4;   // or more, by their cost
  ThreadPool pool(2);
  // With meshes of its own each time, so that they are uploaded.
  const auto differ = [&](DeviceSlot& slot, int times) {
    const Pairs own = allPairs(some, 4);
    std::size_t sum = 0;
    for (int i = 0; i < times; ++i) sum += differences(onDevice(slot, pool, own, kInfinity), expected);
    return sum;
  };
  const auto taken = [](const DeviceSlot& slot) { return slot.backend->counts().distancesOnHost; };
  const FailedCalls sums = checkFailingCalls(tuning, 50, differ, taken);
  CHECK(sums.onHost > 500);
}

TEST_CASE("several threads ask at once, about meshes that do not fit together") {
  opencl::Tuning tuning;
  tuning.meshBudget = 3 << 20;
  const auto slot = openSlot(tuning);
  ThreadPool pool(2);
  std::atomic<std::size_t> wrong{0};
  std::vector<Pairs> all(3);  // longer than threads live: what is gone makes room without being evicted
  std::vector<std::thread> threads;
  for (std::uint32_t t = 0; t < 3; ++t) {
    threads.emplace_back([&, t] {
      std::vector<samples::NamedMesh> some;
      for (std::uint32_t i = 0; i < 4; ++i)
        some.push_back({"", scenes::build(scenes::makeLump(1, 3, 0.2, 10 + 7 * t + i))});
      all[t] = allPairs(some, 4);
      const Pairs& own = all[t];
      const std::vector<Bits> expected = oneByOne(own, kInfinity), device = onDevice(*slot, pool, own, kInfinity);
      for (std::size_t k = 0; k < expected.size(); ++k) wrong += device[k] == expected[k] ? 0 : 1;
    });
  }
  for (std::thread& thread : threads) thread.join();
  CHECK(wrong == 0);
  CHECK(slot->failedCalls == 0);
  CHECK(slot->backend->counts().meshEvictions > 0);
  CHECK(slot->backend->counts().meshBytes <= tuning.meshBudget);
}

TEST_CASE("distances are asked for where that is expected to be done sooner, and a choice is a choice") {
  Pairs pairs = allPairs({{"lump", scenes::build(scenes::makeLump(1, 2, 0.2, 1))}}, 12);
  Pairs empty;
  empty.meshes = {collisionMesh({})};
  Dispatcher dispatcher;
  dispatcher.setThreadCount(2);
  const auto slot = openSlot();
  dispatcher.setDevices({slot});
  std::vector<Bits> expected = oneByOne(pairs, kInfinity);
  pairs.jobs.push_back({{pairs.meshes[0].get(), empty.meshes[0].get(), makePose({0, 0, 1}, 0, {2, 0, 0})}, {}});
  pairs.jobs.push_back({});  // geoms without meshes
  expected.resize(pairs.jobs.size(), bitsOf({}));
  const auto run = [&](Place place) {
    const std::uint64_t before = slot->backend->counts().distances;
    for (OverlapJob& job : pairs.jobs) job.place = place;
    std::vector<MeshDistance> answers(pairs.jobs.size());
    dispatcher.askDistances(pairs.jobs, kInfinity, answers);
    std::vector<Bits> bits;
    for (const MeshDistance& one : answers) bits.push_back(bitsOf(one));
    CHECK(differences(bits, expected) == 0);
    return slot->backend->counts().distances - before;
  };
  CHECK(run(Place::kAuto) == 0);  // costs are not known
  CHECK(run(Place::kOpencl) > 3);
  CHECK(run(Place::kCpu) == 0);
  slot->costs.distanceLaunch = 100;
  slot->costs.hostDistance = {100, 1};
  slot->costs.batchDistance = {1, 0.001};
  CHECK(run(Place::kAuto) > 3);
  slot->costs.distanceLaunch = 1e7;
  CHECK(run(Place::kAuto) == 0);
  slot->isOff = true;
  CHECK(run(Place::kOpencl) == 0);
  opencl::Tuning tuning;
  tuning.doubles = false;
  const auto single = openSlot(tuning);
  dispatcher.setDevices({single});
  CHECK(run(Place::kOpencl) == 0);
  CHECK(single->backend->counts().distances == 0);
}
