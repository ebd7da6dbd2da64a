// SPDX-License-Identifier: BSD-3-Clause
// Arrays of rays on a device against the same rays on the CPU, one by one, and against every triangle: byte for byte.
#include <atomic>
#include <cstring>
#include <limits>
#include <thread>

#include "dispatch/dispatcher.h"
#include "opencl/runtime/log.h"
#include "support/failing_calls.h"
#include "support/opencl.h"
#include "support/ray_samples.h"

using namespace otg;
using namespace otg::test;
using samples::raysFor;

namespace {

/// All that is said of a ray, as bits: 0 is not -0.
struct Bits {
  std::uint64_t distance;
  std::uint32_t triangle;
  bool back;
  bool operator==(const Bits&) const = default;
};

Bits bitsOf(const RayHit& hit) {
  return {std::bit_cast<std::uint64_t>(hit.distance), hit.triangle, hit.back};
}

/// Answers of all rays, and that each ray was answered once.
std::vector<Bits> cast(const std::function<void(const RaySource&, const RaySink&)>& run,
                       const std::vector<LongRay>& rays) {
  std::vector<Bits> answers(rays.size());
  std::vector<std::atomic<int>> times(rays.size());
  run(
      [&](std::size_t begin, std::size_t end, LongRay* to) {
        std::copy(rays.begin() + static_cast<std::ptrdiff_t>(begin), rays.begin() + static_cast<std::ptrdiff_t>(end),
                  to);
      },
      [&](std::size_t begin, std::size_t end, const LongRay* same, const RayHit* some) {
        for (std::size_t i = begin; i < end; ++i) {
          answers[i] = bitsOf(some[i - begin]);
          times[i] += std::memcmp(&same[i - begin], &rays[i], sizeof(LongRay)) == 0 ? 1 : 100;
        }
      });
  std::size_t wrong = 0;
  for (const auto& t : times) wrong += t != 1 ? 1 : 0;
  CHECK(wrong == 0);
  return answers;
}

std::vector<Bits> onDevice(DeviceSlot& slot, ThreadPool& pool, const RayJob& job, const std::vector<LongRay>& rays) {
  return cast(
      [&](const RaySource& source, const RaySink& sink) { castOnDevice(slot, pool, job, rays.size(), source, sink); },
      rays);
}

std::vector<Bits> oneByOne(const RayJob& job, const std::vector<LongRay>& rays) {
  std::vector<Bits> answers;
  for (const LongRay& ray : rays) answers.push_back(bitsOf(answerRay(job, ray)));
  return answers;
}

/// Without a tree.
Bits throughAll(const RayJob& job, const LongRay& ray) {
  const TriMesh& mesh = job.mesh->mesh();
  const TriangleRay alone(mesh, ray.ray);
  RayHit best;
  for (std::uint32_t t = 0; t < mesh.triangleCount(); ++t) {
    RayHit hit;
    if (mesh.isDegenerate(t) || !alone.hits(t, hit) || hit.distance > ray.length || (job.cullBack && hit.back))
      continue;
    if (best.triangle == kNone || hit.distance < best.distance) best = hit;
  }
  return bitsOf(best);
}

std::size_t differences(const std::vector<Bits>& x, const std::vector<Bits>& y) {
  REQUIRE(x.size() == y.size());
  std::size_t count = 0;
  for (std::size_t i = 0; i < x.size(); ++i) count += x[i] == y[i] ? 0 : 1;
  return count;
}

}  // namespace

TEST_CASE("rays have the same hits on the device, byte for byte") {
  const auto slot = openSlot();
  ThreadPool pool(3);
  std::size_t hits = 0, backs = 0, tried = 0, all = 0, hitsCulled = 0;
  for (const auto& [name, mesh] : samples::meshesToHit()) {
    if (mesh->triangleCount() == 0) continue;
    INFO(name);
    const auto tree = std::make_shared<CollisionMesh>(mesh, BuildStrategy::kSah);
    if (tree->tree().nodes.empty()) continue;
    // Meshes on which the tree is of no use take as long for a ray as they have triangles.
    const std::vector<LongRay> rays = raysFor(*mesh, 7, mesh->triangleCount() > 50000 ? 64 : 1600);
    for (const bool cullBack : {false, true}) {
      const RayJob job{tree.get(), cullBack, Place::kOpencl};
      REQUIRE(raysOnDevice(*slot));
      const std::vector<Bits> device = onDevice(*slot, pool, job, rays), host = oneByOne(job, rays);
      INFO((cullBack ? "culled" : "all"));
      CHECK(differences(device, host) == 0);
      const std::size_t some = 200000 / mesh->triangleCount() + 2;  // tried against every triangle
      for (std::size_t i = 0; i < rays.size(); i += 1 + rays.size() / some, ++tried) {
        CHECK((device[i] == throughAll(job, rays[i])));
      }
      for (const Bits& bits : host) {
        (cullBack ? hitsCulled : hits) += bits.triangle != kNone ? 1 : 0;
        backs += bits.back ? 1 : 0;
        if (cullBack) CHECK_FALSE(bits.back);
      }
      all += rays.size();
    }
  }
  CHECK(slot->failedCalls == 0);
  CHECK(slot->backend->counts().rays == all);
  CHECK(slot->backend->counts().raysOnHost == 0);
  CHECK(hits > 5000);
  CHECK(backs > 1000);
  CHECK(hitsCulled > 3000);
  CHECK(tried > 2000);
}

TEST_CASE("the hit does not depend on the tree, the pieces or the number of threads") {
  const auto mesh = scenes::build(scenes::makeBox({1, 1, 0.25}, 16));
  const auto sah = std::make_shared<CollisionMesh>(mesh, BuildStrategy::kSah);
  const auto other = std::make_shared<CollisionMesh>(mesh, BuildStrategy::kMeanSplit);
  const std::vector<LongRay> rays = raysFor(*mesh, 11, 3000);
  const RayJob job{sah.get(), false, Place::kOpencl}, byOther{other.get(), false, Place::kOpencl};
  const std::vector<Bits> expected = oneByOne(job, rays);
  CHECK(differences(oneByOne(byOther, rays), expected) == 0);
  for (const unsigned threads : {1u, 4u}) {
    ThreadPool pool(threads);
    CHECK(differences(cast([&](const RaySource& source,
                               const RaySink& sink) { castOnHost(pool, job, 0, rays.size(), source, sink); },
                           rays),
                      expected) == 0);
    for (const auto& [piece, least, leaf] :
         {std::tuple{1u << 18, 1u << 15, 2u}, {100u, 1u, 8u}, {1u, 1u, 1u}, {3010u, 1000u, 4u}}) {
      opencl::Tuning tuning;
      tuning.pointPiece = piece;
      tuning.leastPointPiece = least;
      tuning.leafTriangles = leaf;
      const auto slot = openSlot(tuning);
      const std::vector<LongRay> some(rays.begin(), rays.begin() + (piece == 1 ? 200 : 3000));
      const std::vector<Bits> expectedSome(expected.begin(),
                                           expected.begin() + static_cast<std::ptrdiff_t>(some.size()));
      INFO(threads << " threads, pieces of " << piece);
      CHECK(differences(onDevice(*slot, pool, job, some), expectedSome) == 0);
      CHECK(differences(onDevice(*slot, pool, byOther, some), expectedSome) == 0);
      CHECK(slot->failedCalls == 0);
    }
  }
}

TEST_CASE("an array without rays is answered") {
  const auto slot = openSlot();
  ThreadPool pool(2);
  const auto lump = collisionMesh(scenes::makeLump(1, 3, 0.2, 3));
  CHECK(onDevice(*slot, pool, {lump.get(), false, Place::kOpencl}, {}).empty());
  CHECK(slot->failedCalls == 0);
}

TEST_CASE("whichever call fails, the hits are the same") {
  const scenes::MeshArrays arrays = scenes::makeLump(1, 2, 0.2, 1);
  const auto lump = collisionMesh(arrays);
  const std::vector<LongRay> rays = raysFor(lump->mesh(), 5, 400);
  const std::vector<Bits> expected = oneByOne({lump.get(), false, Place::kOpencl}, rays);
  opencl::Tuning tuning;
  tuning.pointPiece = 150;  // three pieces
  ThreadPool pool(2);
  // With a mesh of its own each time, so that it is uploaded.
  const auto differ = [&](DeviceSlot& slot, int times) {
    const auto own = collisionMesh(arrays);
    std::size_t sum = 0;
    for (int i = 0; i < times; ++i) {
      sum += differences(onDevice(slot, pool, {own.get(), false, Place::kOpencl}, rays), expected);
    }
    return sum;
  };
  const auto taken = [](const DeviceSlot& slot) { return slot.backend->counts().raysOnHost; };
  const FailedCalls sums = checkFailingCalls(tuning, 30, differ, taken);
  CHECK(sums.onHost > 100 * 150);
  CHECK(sums.onHost < sums.failed * rays.size());  // pieces that were answered before are not cast again
}

TEST_CASE("several threads cast at once, at meshes that have to make room for each other") {
  opencl::Tuning tuning;
  tuning.memoryBudget = 2 << 20;
  tuning.pointPiece = 64;
  const auto slot = openSlot(tuning);
  ThreadPool pool(2);
  std::atomic<std::size_t> wrong{0};
  std::atomic<int> done{0};
  std::vector<std::thread> threads;
  for (std::uint32_t t = 0; t < 4; ++t) {
    threads.emplace_back([&, t] {
      for (std::uint32_t i = 0; i < 12; ++i) {
        const auto own = collisionMesh(scenes::makeLump(1, 3 + i % 2, 0.2, 10 + 7 * t + i % 3));
        const std::vector<LongRay> rays = raysFor(own->mesh(), t * 100 + i, 200);
        const RayJob job{own.get(), i % 3 != 0, Place::kOpencl};
        std::vector<Bits> device(rays.size());
        castOnDevice(
            *slot, pool, job, rays.size(),
            [&](std::size_t begin, std::size_t end, LongRay* to) {
              std::copy(rays.data() + begin, rays.data() + end, to);
            },
            [&](std::size_t begin, std::size_t end, const LongRay*, const RayHit* answers) {
              for (std::size_t k = begin; k < end; ++k) device[k] = bitsOf(answers[k - begin]);
            });
        std::size_t different = 0;
        for (std::size_t k = 0; k < rays.size(); ++k) {
          if (!(device[k] == bitsOf(answerRay(job, rays[k])))) ++different;
        }
        wrong += different;
        ++done;
      }
    });
  }
  for (std::thread& thread : threads) thread.join();
  CHECK(done == 48);
  CHECK(wrong == 0);
  CHECK(slot->backend->counts().meshUploads >= 12);
  CHECK(slot->backend->counts().meshBytes <= tuning.memoryBudget);
}

TEST_CASE("a mesh that does not fit leaves its rays to the CPU") {
  opencl::Tuning tuning;
  tuning.memoryBudget = 100 << 10;
  const auto slot = openSlot(tuning);
  ThreadPool pool(2);
  opencl::forgetFailures();
  std::vector<std::string> lines;
  opencl::setLogSink([&](const std::string& line) { lines.push_back(line); });
  const auto lump = collisionMesh(scenes::makeLump(1, 4, 0.2, 1));
  const std::vector<LongRay> rays = raysFor(lump->mesh(), 5, 100);
  const RayJob job{lump.get(), false, Place::kOpencl};
  for (int i = 0; i < DeviceSlot::kMostFailures; ++i) {
    CHECK(differences(onDevice(*slot, pool, job, rays), oneByOne(job, rays)) == 0);
  }
  opencl::setLogSink({});
  CHECK(slot->failedCalls == DeviceSlot::kMostFailures);
  CHECK(slot->isOff);
  CHECK(lines.size() == 2);  // why, once; and that the device is off
  CHECK(slot->backend->counts().raysOnHost == DeviceSlot::kMostFailures * rays.size());
}

TEST_CASE("a device without doubles takes no part") {
  opencl::Tuning tuning;
  tuning.doubles = false;
  const auto slot = openSlot(tuning);
  CHECK_FALSE(raysOnDevice(*slot));
  const auto lump = collisionMesh(scenes::makeLump(1, 3, 0.2, 1));
  const std::vector<LongRay> rays = raysFor(lump->mesh(), 5, 300);
  Dispatcher dispatcher;
  dispatcher.setDevices({slot});
  const RayJob job{lump.get(), false, Place::kOpencl};
  CHECK(differences(cast([&](const RaySource& source,
                             const RaySink& sink) { dispatcher.castRays(job, rays.size(), source, sink); },
                         rays),
                    oneByOne(job, rays)) == 0);
  CHECK(slot->backend->counts().rays == 0);
}

TEST_CASE("auto casts where that is expected to be done sooner, and a choice is a choice") {
  const auto lump = collisionMesh(scenes::makeLump(1, 3, 0.2, 1));
  const std::vector<LongRay> rays = raysFor(lump->mesh(), 5, 1000);
  Dispatcher dispatcher;
  dispatcher.setThreadCount(2);
  const auto slot = openSlot();
  dispatcher.setDevices({slot});
  const auto run = [&](Place place, std::size_t count) {
    const std::uint64_t before = slot->backend->counts().rays;
    const RayJob job{lump.get(), false, place};
    const std::vector<LongRay> some(rays.begin(), rays.begin() + static_cast<std::ptrdiff_t>(count));
    CHECK(differences(cast([&](const RaySource& source,
                               const RaySink& sink) { dispatcher.castRays(job, some.size(), source, sink); },
                           some),
                      oneByOne(job, some)) == 0);
    return slot->backend->counts().rays - before;
  };
  CHECK(run(Place::kAuto, 1000) == 0);  // costs are not known
  CHECK(run(Place::kOpencl, 10) == 10);
  slot->costs.rayLaunch = {100, 0};  // as long as 100 rays take on one thread
  slot->costs.hostRay = {1, 0};
  slot->costs.deviceRay = {0.001, 0};
  slot->costs.rayFinish = 0.1;
  CHECK(run(Place::kAuto, 50) == 0);
  CHECK(run(Place::kAuto, 1000) == 1000);
  CHECK(run(Place::kCpu, 1000) == 0);
  slot->costs.rayFinish = 2;  // what the CPU makes of triangles may cost more than it saves
  CHECK(run(Place::kAuto, 1000) == 0);
  slot->costs.rayFinish = 0.1;
  slot->costs.rayLaunch = {0, 1000};  // searches of trees as deep as this one's take too long
  CHECK(run(Place::kAuto, 1000) == 0);
  slot->isOff = true;
  CHECK(run(Place::kOpencl, 1000) == 0);
}
