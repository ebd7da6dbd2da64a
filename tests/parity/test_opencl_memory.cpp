// SPDX-License-Identifier: BSD-3-Clause
// All buffers count against one budget, and what is not used is given back.
#include <atomic>
#include <thread>

#include "opencl/runtime/log.h"
#include "support/opencl.h"

using namespace otg;
using namespace otg::scenes;
using namespace otg::test;

namespace {

/// No lines on stderr.
struct Quiet {
  Quiet() {
    opencl::setLogSink([](const std::string&) {});
  }
  ~Quiet() { opencl::setLogSink({}); }
};

/// Two meshes whose triangles nearly all meet many others.
struct ManyHits {
  std::shared_ptr<const CollisionMesh> a, b;
  Query query;
  Workspace host;

  explicit ManyHits(int copies) {
    std::vector<MeshArrays> fans;
    for (int i = 0; i < copies; ++i) {
      const double at = 2e-4 * i;
      MeshArrays fan;
      fan.vertices = {{0, 0, static_cast<float>(at)}, {1, 0, static_cast<float>(at)}, {0, 1, static_cast<float>(at)}};
      fan.triangles = {{{0, 1, 2}}};
      fans.push_back(fan);
    }
    a = collisionMesh(merge(fans));
    for (MeshArrays& fan : fans) {
      for (Vec3f& v : fan.vertices) v = {v.z + 0.2f, v.x - 0.4f, v.y - 0.4f};
    }
    b = collisionMesh(merge(fans));
    query = makeQuery(*a, *b, makeMove({0, 0, 0}));
    query.options.contacts = ContactModel::kPairwise;
    collide(query, host);
  }
};

constexpr std::uint64_t kMega = std::uint64_t{1} << 20;

}  // namespace

TEST_CASE("what queries of all sizes took is given back without a complaint") {
  std::vector<std::string> lines;
  opencl::setLogSink([&](const std::string& line) { lines.push_back(line); });
  for (const int copies : {10, 200, 20, 400}) {
    const ManyHits many(copies);
    const auto backend = openBackend();
    REQUIRE(backend);
    Workspace workspace;
    for (const int times : {1, 2}) {
      CAPTURE(copies, times);
      CHECK(backend->collide(many.query, workspace));
      CHECK(sameBytes(workspace.reduced, many.host.reduced));
    }
  }
  opencl::setLogSink({});
  CHECK(lines.empty());
}

TEST_CASE("a query that needs more than the budget is the host's, and nothing is left of it") {
  const Quiet quiet;
  const ManyHits many(500), few(10);
  REQUIRE(many.host.stats.intersectingPairs == 250000);
  opencl::Tuning tuning;
  {
    const auto roomy = openBackend();
    REQUIRE(roomy);
    Workspace device;
    REQUIRE(roomy->collide(few.query, device));
    tuning.memoryBudget = roomy->counts().memory + 12 * kMega;
    INFO(tuning.memoryBudget);
    CHECK(tuning.memoryBudget < 32 * kMega);  // the header says how much a device needs to begin with
    tuning.batchHits = 1u << 20;              // it is memory that ends the batch
  }
  const auto backend = openBackend(tuning);
  REQUIRE(backend);
  for (int round = 0; round < 2; ++round) {
    Workspace device;
    CHECK_FALSE(backend->collide(many.query, device));
    checkSame(device, many.host);
    CHECK(backend->counts().memory <= tuning.memoryBudget);
    CHECK(backend->collide(few.query, device));
    checkSame(device, few.host);
  }
  opencl::BatchAnswer answer;
  CHECK_FALSE(backend->collideBatch(std::span<const Query>(&many.query, 1), answer));
  CHECK(sameBytes(answer.of(0), many.host.reduced));
  CHECK(backend->counts().memory <= tuning.memoryBudget);
  CHECK(backend->counts().onHost == 3);
}

TEST_CASE("thousands of triangles that lie on one another have a bound on a device, alone and in a batch") {
  // 2,250,000 pairs intersect, more than either may have.
  constexpr std::size_t kCopies = 1500;
  MeshArrays flat, upright;
  flat.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  upright.vertices = {{0.2f, 0.2f, -0.5f}, {0.3f, 0.3f, 0.5f}, {0.2f, 0.4f, 0.5f}};
  flat.triangles.assign(kCopies, {{0, 1, 2}});
  upright.triangles = flat.triangles;
  const auto a = collisionMesh(flat), b = collisionMesh(upright);
  Query query = makeQuery(*a, *b, makeMove({0, 0, 0}));
  query.options.contacts = ContactModel::kSolid;
  Workspace host, device;
  collide(query, host);
  REQUIRE(host.stats.intersectingPairs == kCopies * kCopies);
  const auto backend = openBackend();
  REQUIRE(backend);
  CHECK(backend->collide(query, device));
  CHECK(sameBytes(device.reduced, host.reduced));
  CHECK(backend->counts().leftToHost == 1);
  opencl::BatchAnswer answer;
  CHECK(backend->collideBatch(std::span<const Query>(&query, 1), answer));
  CHECK(sameBytes(answer.of(0), host.reduced));
  CHECK(backend->counts().onHost == 0);
  CHECK(backend->counts().memory < 256 * kMega);
}

TEST_CASE("what queries that are done hold is given back when it is asked for") {
  const ManyHits many(500), few(10);
  const auto backend = openBackend();
  REQUIRE(backend);
  Workspace device;
  for (int round = 0; round < 2; ++round) {
    REQUIRE(backend->collide(few.query, device));
    const std::uint64_t before = backend->counts().memory;
    REQUIRE(backend->collide(many.query, device));
    checkSame(device, many.host);
    const std::uint64_t held = backend->counts().memory;
    CHECK(held > before + 32 * kMega);
    CHECK(backend->releaseMemory() == held);
    CHECK(backend->counts().memory == 0);
    CHECK(backend->releaseMemory() == 0);
  }
}

TEST_CASE("results that a caller keeps stay as they are, and count until they go") {
  const ManyHits few(10);
  const auto backend = openBackend();
  REQUIRE(backend);
  const std::vector<Query> queries(300, few.query);
  {
    opencl::BatchAnswer answer;
    REQUIRE(backend->collideBatch(std::span<const Query>(queries), answer));
    CHECK(backend->releaseMemory() > 0);
    CHECK(backend->counts().memory > 0);
    CHECK(backend->counts().memory < kMega);
    for (std::size_t i = 0; i < queries.size(); ++i) REQUIRE(sameBytes(answer.of(i), few.host.reduced));
  }
  CHECK(backend->counts().memory == 0);
}

TEST_CASE("threads share a budget that has no room for all of them") {
  const Quiet quiet;
  const ManyHits some(120), few(10);
  opencl::Tuning tuning;
  tuning.memoryBudget = 96 * kMega;
  const auto backend = openBackend(tuning);
  REQUIRE(backend);
  std::atomic<int> wrong{0}, tooMuch{0}, onDevice{0};
  std::vector<std::thread> threads;
  for (int t = 0; t < 6; ++t) {
    threads.emplace_back([&, t] {
      for (int i = 0; i < 6; ++i) {
        const ManyHits& which = (i + t) % 2 == 0 ? some : few;
        Workspace device;
        if (backend->collide(which.query, device)) ++onDevice;
        if (!sameBytes(device.reduced, which.host.reduced)) ++wrong;
        if (backend->counts().memory > tuning.memoryBudget) ++tooMuch;
        if (i == 3) backend->releaseMemory();
      }
    });
  }
  for (std::thread& thread : threads) thread.join();
  CHECK(wrong == 0);
  CHECK(tooMuch == 0);
  CHECK(onDevice > 0);
}
