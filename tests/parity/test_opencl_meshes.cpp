// SPDX-License-Identifier: BSD-3-Clause
// Many meshes on a device: what their first use costs is counted, not timed.
#include <atomic>
#include <thread>

#include "dispatch/threads/thread_pool.h"
#include "opencl/meshes/mesh_store.h"
#include "opencl/meshes/pack_mesh.h"
#include "opencl/runtime/device.h"
#include "support/opencl.h"

using namespace otg;
using namespace otg::scenes;
using namespace otg::test;
using opencl::MeshStore;

namespace {

struct ManyMeshes {
  std::vector<std::shared_ptr<const CollisionMesh>> owned;
  std::vector<const CollisionMesh*> list;

  explicit ManyMeshes(std::uint32_t count, std::uint32_t first = 0) {
    for (std::uint32_t i = 0; i < count; ++i) {
      owned.push_back(collisionMesh(makeLump(1, 1, 0.2, first + i)));
      list.push_back(owned.back().get());
    }
  }
};

opencl::Context& theContext() {
  static opencl::Context context(opencl::findDevices().at(0), opencl::ProgramCache(""));
  return context;
}

std::shared_ptr<opencl::MemoryBudget> budget(std::uint64_t bytes) {
  return std::make_shared<opencl::MemoryBudget>(bytes);
}

constexpr std::uint64_t kPlenty = std::uint64_t{1} << 30;

/// Whether the device has what packMesh() makes of each.
bool areThere(const MeshStore::Pinned& pinned, std::span<const CollisionMesh* const> meshes) {
  const opencl::QueueHandle queue = theContext().makeQueue(false);
  for (std::size_t i = 0; i < meshes.size(); ++i) {
    const opencl::PackedMesh packed = opencl::packMesh(*meshes[i], opencl::MeshLayout::kEightWide, 2);
    const std::uint32_t begin = pinned[i].nodes - packed.place.nodes;
    std::vector<opencl::MeshUnit> there(packed.units.size());
    const std::size_t bytes = there.size() * sizeof(opencl::MeshUnit);
    opencl::clDo(OTG_CL(clEnqueueReadBuffer), queue.get(), pinned.buffer(), cl_bool{CL_TRUE},
                 begin * sizeof(opencl::MeshUnit), bytes, static_cast<void*>(there.data()), cl_uint{0},
                 static_cast<const cl_event*>(nullptr), static_cast<cl_event*>(nullptr));
    if (std::memcmp(there.data(), packed.units.data(), bytes) != 0) return false;
  }
  return true;
}

}  // namespace

TEST_CASE("the first use of many meshes takes few writes, and steps in proportion to them") {
  const ManyMeshes meshes(3000);
  ThreadPool pool(2);
  const opencl::RunParts threads = [&](std::size_t count, const auto& work) { pool.run(count, 1, work, true); };
  for (const bool lent : {false, true}) {
    MeshStore store(theContext(), budget(kPlenty), 2);
    {
      const MeshStore::Pinned pinned = store.acquire(meshes.list, lent ? &threads : nullptr);
      CHECK(areThere(pinned, std::span(meshes.list).subspan(0, 3000)));
    }
    const MeshStore::Counts first = store.counts();
    CHECK(first.uploads == 3000);
    CHECK(first.writes <= 4);
    CHECK(first.steps <= 3000);
    // Those that are there cost neither.
    { const MeshStore::Pinned again = store.acquire(meshes.list); }
    CHECK(store.counts().writes == first.writes);
    CHECK(store.counts().steps == first.steps);
    CHECK(store.counts().uploads == 3000);
  }
}

TEST_CASE("meshes that come one by one take steps in proportion, too, with a budget that is full and without") {
  const ManyMeshes meshes(1500);
  const std::size_t each = opencl::packMesh(*meshes.list[0], opencl::MeshLayout::kEightWide, 2).units.size() * 16;
  for (const std::uint64_t room : {kPlenty, std::uint64_t{each * 200}}) {
    MeshStore store(theContext(), budget(room), 2);
    for (const CollisionMesh* const mesh : meshes.list) {
      const MeshStore::Pinned one = store.acquire({&mesh, 1});
    }
    const MeshStore::Counts counts = store.counts();
    CHECK(counts.uploads == 1500);
    CHECK(counts.steps <= 1500 * 6);
    if (room != kPlenty) CHECK(counts.evictions > 1200);
    if (room == kPlenty) CHECK(counts.evictions == 0);
  }
}

TEST_CASE("where the oldest meshes are in use, others make room, in few steps") {
  const ManyMeshes held(150), more(600, 1000);
  const std::size_t each = opencl::packMesh(*held.list[0], opencl::MeshLayout::kEightWide, 2).units.size() * 16;
  MeshStore store(theContext(), budget(each * 200), 2);
  const MeshStore::Pinned pinned = store.acquire(held.list);
  for (const CollisionMesh* const mesh : more.list) {
    const MeshStore::Pinned one = store.acquire({&mesh, 1});
    REQUIRE(areThere(one, {&mesh, 1}));
  }
  CHECK(areThere(pinned, held.list));
  CHECK(store.counts().steps < 150 * 20 + 600 * 12);
  CHECK(store.counts().evictions > 500);
}

TEST_CASE("threads that need the same meshes first get the same copies") {
  const ManyMeshes meshes(400);
  MeshStore store(theContext(), budget(kPlenty), 2);
  std::vector<std::thread> threads;
  std::atomic<int> wrong{0};
  for (std::size_t t = 0; t < 4; ++t) {
    threads.emplace_back([&, t] {
      std::vector<const CollisionMesh*> own(meshes.list.begin() + static_cast<std::ptrdiff_t>(50 * t),
                                            meshes.list.begin() + static_cast<std::ptrdiff_t>(50 * t + 250));
      own.push_back(own.front());  // one that is there twice
      const MeshStore::Pinned pinned = store.acquire(own);
      if (!areThere(pinned, own) || pinned[0].nodes != pinned[250].nodes) ++wrong;
    });
  }
  for (std::thread& thread : threads) thread.join();
  CHECK(wrong == 0);
  CHECK(store.counts().uploads == 400);
}

TEST_CASE("a failing call on the way leaves nothing behind") {
  const ManyMeshes meshes(60);
  MeshStore store(theContext(), budget(kPlenty), 2);
  for (std::uint64_t nth = 1; nth < 5; ++nth) {
    const std::uint64_t before = store.counts().bytesUsed;
    opencl::FaultInjection::failAt(nth);
    bool failed = false;
    try {
      store.acquire(meshes.list);
    } catch (const opencl::ClError&) {
      failed = true;
    }
    opencl::FaultInjection::failAt(0);
    if (failed) CHECK(store.counts().bytesUsed == before);
    const MeshStore::Pinned pinned = store.acquire({meshes.list.data(), 1});
    CHECK(areThere(pinned, {meshes.list.data(), 1}));
    if (!failed) break;
  }
  const MeshStore::Pinned pinned = store.acquire(meshes.list);
  CHECK(areThere(pinned, meshes.list));
}
