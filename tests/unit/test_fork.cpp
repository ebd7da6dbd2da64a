// SPDX-License-Identifier: BSD-3-Clause
// fork(): the child collides with threads of its own and ends in every way, whatever the parent's threads are at.
#include <atomic>

#include "support/fork_child.h"

using namespace otg;
using namespace otg::test;

TEST_CASE("a child of a process whose threads are idle") {
  const OdeSession session;
  REQUIRE(dGpuTriMeshSetThreadCount(4) == dGPUTRIMESH_OK);
  const ForkScene scene;
  REQUIRE(scene.hasContacts());
  checkChildren(scene);
}

TEST_CASE("a child of a process that has used one thread") {
  const OdeSession session;
  REQUIRE(dGpuTriMeshSetThreadCount(1) == dGPUTRIMESH_OK);
  const ForkScene scene;
  checkChildren(scene);
}

TEST_CASE("children of a process whose threads are busy") {
  const OdeSession session;
  REQUIRE(dGpuTriMeshSetThreadCount(4) == dGPUTRIMESH_OK);
  const ForkScene scene;
  std::atomic<bool> stop{false}, good{true};
  std::vector<std::thread> busy;
  for (int i = 0; i < 3; ++i) {
    busy.emplace_back([&, i] {
      dAllocateODEDataForThread(dAllocateMaskAll);
      while (!stop) {
        // What is made and built for the first time takes locks that a single collision does not.
        const ForkScene own;
        if (i > 0 && !own.isAsBefore()) good = false;
      }
    });
  }
  for (int round = 0; round < 10; ++round) {
    for (const ChildEnd end : kChildEnds) {
      INFO(nameOf(end) << ", round " << round);
      CHECK(childFault(end, [&] { return scene.isAsBefore() && ForkScene().hasContacts(); }) == "");
    }
  }
  CHECK(childFault(ChildEnd::kExit, [&] { return scene.areAllAsBefore(); }) == "");
  stop = true;
  for (std::thread& thread : busy) thread.join();
  CHECK(good);
}

TEST_CASE("a child with a batch that its parent has submitted") {
  const OdeSession session;
  REQUIRE(dGpuTriMeshSetThreadCount(2) == dGPUTRIMESH_OK);
  const ForkScene scene;
  for (int round = 0; round < 20; ++round) {
    const dGpuTriMeshBatchID batch =
        dGpuTriMeshBatchSubmit(scene.pairs().data(), static_cast<int>(scene.pairs().size()), 64);
    REQUIRE(batch != nullptr);
    CHECK(childFault(ChildEnd::kExit, [&] {
            const bool done = dGpuTriMeshBatchWait(batch) >= 0;
            dGpuTriMeshBatchDestroy(batch);
            return done && scene.isAsBefore();
          }) == "");
    CHECK(dGpuTriMeshBatchWait(batch) >= 0);
    dGpuTriMeshBatchDestroy(batch);
  }
}

TEST_CASE("a child that is made in a callback of the library") {
  const OdeSession session;
  REQUIRE(dGpuTriMeshSetThreadCount(2) == dGPUTRIMESH_OK);
  const ForkScene scene;
  static const ForkScene* asked;
  static std::string fault;
  static int times;
  asked = &scene;
  fault = "never called";
  times = 0;
  const Data data(scenes::makeBox({1, 1, 1}));
  const Geom a(data), b(data);
  dGeomSetPosition(b.id, 0.3, 0.2, 0.9);
  usePairwise(a.id);
  dGeomGpuTriMeshSetCallback(a.id, [](dGeomID, dGeomID, int) {
    if (times++ == 0) fault = childFault(ChildEnd::kExit, [] { return asked->isAsBefore(); });
    return 1;
  });
  CHECK(!test::collide(a.id, b.id).empty());
  CHECK(times > 0);
  CHECK(fault == "");
}

TEST_CASE("a process that collides and closes the library in the destructors of its globals") {
  const OdeSession session;
  CHECK(childFault(ChildEnd::kExit, [] {
          static const struct AtEnd {
            ForkScene scene;
            ~AtEnd() {
              if (!scene.isAsBefore()) _exit(3);
              dGpuTriMeshClose();
            }
          } atEnd;
          return atEnd.scene.hasContacts();
        }) == "");
}
