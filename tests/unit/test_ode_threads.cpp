// SPDX-License-Identifier: BSD-3-Clause
// Several threads collide at once: different pairs, the same pair, the first use of lazily made tree layouts, and geoms
// that come and go meanwhile. Meant for ThreadSanitizer; without it, results are compared with those of one thread.
#include <atomic>
#include <thread>

#include "support/catch.h"
#include "support/ode_world.h"

#if defined(__SANITIZE_THREAD__)
// ODE hands the memory of a destroyed geom's pose from one thread to the next through an atomic exchange. Its library
// is not compiled for ThreadSanitizer, which therefore sees the memory change hands but not why that is safe: it tells
// of the thread that destroyed the geom, or of the one that had the memory allocated for its own.
extern "C" __attribute__((visibility("default"))) const char* __tsan_default_suppressions();
extern "C" const char* __tsan_default_suppressions() {
  return "race:dxGeom::~dxGeom\nrace:dxGeom::dxGeom\n";
}
#endif

using namespace otg;
using namespace otg::test;

namespace {

constexpr int kThreads = 4;

template <class Work>
void runThreads(Work work) {
  std::atomic<int> waiting{kThreads};
  std::vector<std::thread> threads;
  for (int i = 0; i < kThreads; ++i) {
    threads.emplace_back([&, i] {
      dAllocateODEDataForThread(dAllocateMaskAll);
      --waiting;
      while (waiting > 0) std::this_thread::yield();
      work(i);
    });
  }
  for (std::thread& t : threads) t.join();
}

/// ODE computes poses and boxes of moved geoms on demand; from then on reading them writes nothing.
void settle(dGeomID g) {
  dReal aabb[6];
  dGeomGetAABB(g, aabb);
}

}  // namespace

TEST_CASE("threads that collide the same pair and different pairs get what one thread gets") {
  const OdeSession session;
  for (int traversal = dGPUTRIMESH_TRAVERSAL_STANDARD; traversal <= dGPUTRIMESH_TRAVERSAL_WIDE; ++traversal) {
    const Data ground(scenes::makeGround(6, 1, 12)), lump(scenes::makeLump(0.5, 3, 0.2, 4));
    const Geom floor(ground);
    std::vector<dGeomID> lumps;
    for (int i = 0; i < 2 * kThreads; ++i) {
      lumps.push_back(dCreateGpuTriMesh(nullptr, lump.id));
      dGeomSetPosition(lumps.back(), 0.5 * i - 2, 0.1 * i, 0.4);
      settle(lumps.back());
    }
    settle(floor.id);
    dGpuTriMeshParams params;
    dGpuTriMeshParamsInit(&params);
    params.traversal = traversal;
    CHECK(dGeomGpuTriMeshSetParams(floor.id, &params) == dGPUTRIMESH_OK);
    std::vector<std::vector<dContactGeom>> shared(kThreads), own(kThreads);
    runThreads([&](int i) {
      for (int round = 0; round < 10; ++round) {
        shared[i] = i % 2 ? test::collide(floor.id, lumps[0]) : mirrored(test::collide(lumps[0], floor.id));
        own[i] = test::collide(lumps[2 * i], lumps[2 * i + 1]);
      }
    });
    const auto expected = test::collide(floor.id, lumps[0]);
    CHECK(!expected.empty());
    for (std::size_t i = 0; i < kThreads; ++i) {
      CHECK(sameContacts(shared[i], expected));
      const auto alone = test::collide(lumps[2 * i], lumps[2 * i + 1]);
      CHECK(!alone.empty());
      CHECK(sameContacts(own[i], alone));
    }
    dGpuTriMeshStats stats;
    dGpuTriMeshStatsInit(&stats);
    CHECK(dGeomGpuTriMeshGetStats(floor.id, &stats) == dGPUTRIMESH_OK);
    CHECK(stats.queries == 10 * kThreads + 1);
    CHECK(stats.contacts == (10 * kThreads + 1) * expected.size());
    for (const dGeomID g : lumps) dGeomDestroy(g);
  }
}

TEST_CASE("threads that collide dTriMesh geoms, first of all at once, get what one thread gets") {
  const OdeSession session;
  REQUIRE(dGpuTriMeshOverrideTriMesh() == dGPUTRIMESH_OK);
  const scenes::MeshArrays ground = scenes::makeGround(6, 1, 12), lump = scenes::makeLump(0.5, 3, 0.2, 4);
  const auto dataOf = [](const scenes::MeshArrays& mesh) {
    const dTriMeshDataID data = dGeomTriMeshDataCreate();
    dGeomTriMeshDataBuildSingle(data, mesh.vertices.data(), sizeof(Vec3f), static_cast<int>(mesh.vertices.size()),
                                mesh.triangles.data(), static_cast<int>(3 * mesh.triangles.size()), sizeof(Triangle));
    return data;
  };
  const dTriMeshDataID groundData = dataOf(ground), lumpData = dataOf(lump);
  std::vector<dGeomID> geoms = {dCreateTriMesh(nullptr, groundData, nullptr, nullptr, nullptr)};
  for (int i = 0; i < kThreads; ++i) {
    geoms.push_back(dCreateTriMesh(nullptr, lumpData, nullptr, nullptr, nullptr));
    dGeomSetPosition(geoms.back(), 0.9 * i - 2, 0.1 * i, 0.4);
  }
  for (const dGeomID g : geoms) {
    settle(g);
    dGpuTriMeshOverrideForgetGeom(g);
  }
  dGpuTriMeshOverrideForgetData(groundData);
  dGpuTriMeshOverrideForgetData(lumpData);
  // The ground is the older one of each pair whichever thread comes first; the meshes are built by whoever needs them.
  REQUIRE(dGpuTriMeshOverridePrepare(geoms[0]) == dGPUTRIMESH_OK);
  std::vector<std::vector<dContactGeom>> own(kThreads), shared(kThreads);
  runThreads([&](int i) {
    for (int round = 0; round < 10; ++round) {
      own[i] = test::collide(geoms[0], geoms[1 + i]);
      shared[i] = mirrored(test::collide(geoms[1], geoms[0]));
    }
  });
  for (int i = 0; i < kThreads; ++i) {
    CHECK(!own[i].empty());
    CHECK(sameContacts(own[i], test::collide(geoms[0], geoms[1 + i])));
    CHECK(sameContacts(shared[i], test::collide(geoms[0], geoms[1])));
  }
  for (const dGeomID g : geoms) dGeomDestroy(g);
  dGeomTriMeshDataDestroy(groundData);
  dGeomTriMeshDataDestroy(lumpData);
}

namespace {

/// Lets every second triangle of the ground collide; counts the calls of each thread.
std::atomic<int> calls{0};
int everySecond(dGeomID, dGeomID, int triangle) {
  ++calls;
  return triangle % 2;
}
int notTheFirst(dGeomID, dGeomID, int triangle, int) {
  return triangle != 0;
}

}  // namespace

TEST_CASE("threads whose collisions ask callbacks get what one thread gets") {
  const OdeSession session;
  const Data ground(scenes::makeGround(6, 1, 12)), lump(scenes::makeLump(0.5, 3, 0.2, 4));
  const Geom floor(ground), body(lump);
  REQUIRE(dGeomGpuTriMeshSetCallback(floor.id, &everySecond) == dGPUTRIMESH_OK);
  REQUIRE(dGeomGpuTriMeshSetPairCallback(body.id, &notTheFirst) == dGPUTRIMESH_OK);
  dGeomSetPosition(body.id, 0.2, 0.1, 0.4);
  settle(floor.id);
  settle(body.id);
  const auto expected = test::collide(floor.id, body.id);
  CHECK(!expected.empty());
  for (const dContactGeom& c : expected) CHECK(c.side1 % 2 == 1);
  const int once = calls.exchange(0);
  std::vector<std::vector<dContactGeom>> found(kThreads);
  runThreads([&](int i) {
    for (int round = 0; round < 10; ++round) {
      found[i] = i % 2 ? test::collide(floor.id, body.id) : mirrored(test::collide(body.id, floor.id));
    }
  });
  for (const auto& contacts : found) CHECK(sameContacts(contacts, expected));
  CHECK(calls == 10 * kThreads * once);
}

TEST_CASE("threads create, collide and destroy geoms of one mesh, and errors stay with their thread") {
  const OdeSession session;
  const Data box(scenes::makeBox({1, 1, 1}));
  std::atomic<int> empty{0}, foreignErrors{0};
  runThreads([&](int i) {
    for (int round = 0; round < 20; ++round) {
      const Geom a(box), b(box);
      dGeomSetPosition(b.id, 0.4, 0.3, 0.2);
      if (test::collide(a.id, b.id).empty()) ++empty;
      if (i == 0) {
        dGeomGpuTriMeshGetData(nullptr);
      } else if (dGpuTriMeshGetError() != dGPUTRIMESH_OK) {
        ++foreignErrors;
      }
    }
    dGpuTriMeshClose();
  });
  CHECK(empty == 0);
  CHECK(foreignErrors == 0);
}

TEST_CASE("threads collide one pair between partial updates of its mesh") {
  const OdeSession session;
  scenes::MeshArrays lump = scenes::makeLump(0.5, 3, 0.2, 4);
  const Data ground(scenes::makeGround(6, 1, 12)), body(lump), same(lump);
  const Geom floor(ground), first(body), second(same);
  for (const Geom* g : {&first, &second}) {
    dGeomSetPosition(g->id, 0.1, 0.2, 0.4);
    dGpuTriMeshParams params;
    dGpuTriMeshParamsInit(&params);
    params.history = dGPUTRIMESH_HISTORY_OFF;  // threads take turns in remembering
    dGeomGpuTriMeshSetParams(g->id, &params);
  }
  const auto count = static_cast<int>(lump.vertices.size());
  for (int round = 0; round < 8; ++round) {
    const int from = count / 8 * round;
    for (int v = from; v < from + 10; ++v) lump.vertices[static_cast<std::size_t>(v)].z *= 1.02f;
    REQUIRE(dGpuTriMeshDataUpdateRangeSingle(body.id, &lump.vertices[static_cast<std::size_t>(from)], 0, from, 10) ==
            dGPUTRIMESH_OK);
    REQUIRE(dGpuTriMeshDataUpdateVerticesSingle(same.id, lump.vertices.data(), 0, count) == dGPUTRIMESH_OK);
    for (const dGeomID g : {floor.id, first.id, second.id}) settle(g);
    std::vector<std::vector<dContactGeom>> found(kThreads);
    runThreads([&](int i) {
      for (int k = 0; k < 3; ++k) found[i] = test::collide(floor.id, first.id);
    });
    auto expected = test::collide(floor.id, second.id);
    CHECK(!expected.empty());
    for (dContactGeom& c : expected) c.g2 = first.id;
    for (const auto& contacts : found) CHECK(sameContacts(contacts, expected));
  }
}

TEST_CASE("threads load, update, collide and destroy meshes of their own") {
  const OdeSession session;
  const scenes::MeshArrays lump = scenes::makeLump(0.5, 3, 0.2, 4);
  std::vector<unsigned char> bytes;
  {
    const Data data(lump);
    bytes.resize(dGpuTriMeshDataCook(data.id, nullptr, 0));
    REQUIRE(dGpuTriMeshDataCook(data.id, bytes.data(), bytes.size()) == bytes.size());
  }
  const auto work = [&](std::vector<dContactGeom>& found) {
    const dGpuTriMeshDataID data = dGpuTriMeshDataCreate();
    bool good = dGpuTriMeshDataUncook(data, bytes.data(), bytes.size()) == dGPUTRIMESH_OK;
    std::vector<Vec3f> places(lump.vertices.begin() + 20, lump.vertices.begin() + 60);
    for (Vec3f& p : places) p.x *= 1.01f;
    const dGeomID a = dCreateGpuTriMesh(nullptr, data), b = dCreateGpuTriMesh(nullptr, data);
    good = good && dGpuTriMeshDataUpdateRangeSingle(data, places.data(), 0, 20, 40) == dGPUTRIMESH_OK;
    dGpuTriMeshDataDestroy(data);
    dGeomSetPosition(b, 0.4, 0.3, 0.2);
    found = good ? test::collide(a, b) : std::vector<dContactGeom>();
    for (dContactGeom& c : found) c.g1 = c.g2 = nullptr;
    dGeomDestroy(a);
    dGeomDestroy(b);
  };
  std::vector<dContactGeom> expected;
  work(expected);
  CHECK(!expected.empty());
  std::vector<std::vector<dContactGeom>> found(kThreads);
  std::atomic<int> others{0};
  runThreads([&](int i) {
    for (int round = 0; round < 6; ++round) {
      work(found[i]);
      if (!sameContacts(found[i], expected)) ++others;
    }
  });
  CHECK(others == 0);
}
