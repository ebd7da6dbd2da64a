// SPDX-License-Identifier: BSD-3-Clause
// Devices through the C API: worlds, arrays of pairs and single calls have the bytes that they have on the CPU.
#include <cstring>
#include <fstream>
#include <random>

#include "dispatch/dispatcher.h"
#include "opencl/published/published_design.h"
#include "opencl/runtime/call.h"
#include "opencl/runtime/device_info.h"
#include "opencl/runtime/log.h"
#include "support/catch.h"
#include "support/pile_world.h"

using namespace otg;
using namespace otg::test;

namespace {

/// The process's choices, put back at the end.
class Devices {
 public:
  explicit Devices(int count) {
    const std::vector<int> indices(static_cast<std::size_t>(count), opencl::defaultDevice(opencl::listDevices()));
    REQUIRE(dGpuTriMeshOpenDevices(indices.data(), count) == count);
    CHECK(dGpuTriMeshGetDeviceCount() == count);
  }
  ~Devices() {
    opencl::FaultInjection::failAt(0);
    dGpuTriMeshCloseDevices();
    dGpuTriMeshSetBackend(dGPUTRIMESH_BACKEND_CPU);
  }
  Devices(const Devices&) = delete;
  Devices& operator=(const Devices&) = delete;
  dGpuTriMeshDevice operator[](int i) const {
    dGpuTriMeshDevice device;
    dGpuTriMeshDeviceInit(&device);
    CHECK(dGpuTriMeshGetDevice(i, &device) == dGPUTRIMESH_OK);
    return device;
  }
};

struct Quiet {
  Quiet() {
    opencl::setLogSink([](const std::string&) {});
  }
  ~Quiet() { opencl::setLogSink({}); }
};

void setPhases(const PileWorld& world, int middle, int near) {
  for (const dGeomID geom : world.geoms()) {
    dGpuTriMeshParams params;
    dGpuTriMeshParamsInit(&params);
    CHECK(dGeomGpuTriMeshGetParams(geom, &params) == dGPUTRIMESH_OK);
    params.middle_phase = middle;
    params.near_phase = near;
    CHECK(dGeomGpuTriMeshSetParams(geom, &params) == dGPUTRIMESH_OK);
  }
}

/// Kilobytes of memory that the process has now.
long residentKb() {
  std::ifstream status("/proc/self/status");
  for (std::string line; std::getline(status, line);) {
    if (line.rfind("VmRSS:", 0) == 0) return std::stol(line.substr(6));
  }
  return 0;
}

}  // namespace

TEST_CASE("a world on devices has the bytes of a world on the CPU, prefetched or not, wherever its phases run") {
  const OdeSession session;
  PileWorld::Choices choices;
  choices.bodies = 6;
  for (const bool pairwise : {false, true}) {
    choices.pairwise = pairwise;
    PileWorld plain(choices);
    plain.step(30);
    const std::vector<unsigned char> expected = plain.bytes();
    CHECK(plain.contacts() > 200);
    CHECK(plain.stats().on_device == 0);
    for (int count = 1; count <= 4; ++count) {
      const Devices devices(count);
      const auto check = [&](int backend, int middle, int near, bool ahead, bool onDevice) {
        INFO("pairwise " << pairwise << ", devices " << count << ", " << backend << middle << near << ahead);
        CHECK(dGpuTriMeshSetBackend(backend) == dGPUTRIMESH_OK);
        CHECK(dGpuTriMeshGetBackend() == backend);
        PileWorld world(choices);
        setPhases(world, middle, near);
        world.step(30, [&] {
          if (ahead) dGpuTriMeshPrefetch(world.space());
        });
        CHECK(world.bytes() == expected);
        CHECK((world.stats().prefetched > 0) == ahead);
        if (onDevice) CHECK(world.stats().on_device > 100);
        CHECK(world.stats().device_failures == 0);
      };
      for (const bool ahead : {false, true}) {
        check(dGPUTRIMESH_BACKEND_OPENCL, 0, 0, ahead, true);
        if (count > 2) continue;
        check(dGPUTRIMESH_BACKEND_AUTO, 0, 0, ahead, false);
        check(dGPUTRIMESH_BACKEND_CPU, dGPUTRIMESH_BACKEND_OPENCL, dGPUTRIMESH_BACKEND_OPENCL, ahead, true);
        check(dGPUTRIMESH_BACKEND_CPU, dGPUTRIMESH_BACKEND_OPENCL, 0, ahead, true);
        check(dGPUTRIMESH_BACKEND_OPENCL, dGPUTRIMESH_BACKEND_CPU, 0, ahead, true);
      }
      for (int i = 0; i < count; ++i) {
        CHECK(devices[i].failed_calls == 0);
        CHECK(devices[i].switched_off == 0);
        CHECK(devices[i].name[0] != 0);
        CHECK(devices[i].queries > 0);
        CHECK(devices[i].mesh_uploads > 0);
      }
    }
  }
}

TEST_CASE("a world by the published traversal has the bytes of a world on the CPU, with devices or without") {
  const OdeSession session;
  PileWorld::Choices choices;
  choices.bodies = 6;
  const auto byLevels = [](const PileWorld& world) {
    for (const dGeomID geom : world.geoms()) {
      dGpuTriMeshParams params;
      dGpuTriMeshParamsInit(&params);
      CHECK(dGeomGpuTriMeshGetParams(geom, &params) == dGPUTRIMESH_OK);
      params.traversal = dGPUTRIMESH_TRAVERSAL_LEVELS;
      CHECK(dGeomGpuTriMeshSetParams(geom, &params) == dGPUTRIMESH_OK);
      dGpuTriMeshParamsInit(&params);
      CHECK(dGeomGpuTriMeshGetParams(geom, &params) == dGPUTRIMESH_OK);
      CHECK(params.traversal == dGPUTRIMESH_TRAVERSAL_LEVELS);
    }
  };
  for (const bool pairwise : {false, true}) {
    choices.pairwise = pairwise;
    PileWorld plain(choices);
    plain.step(30);
    CHECK(plain.contacts() > 200);
    {
      PileWorld alone(choices);
      byLevels(alone);
      alone.step(30);
      CHECK(alone.bytes() == plain.bytes());
      CHECK(alone.stats().on_device == 0);
    }
    for (const bool ahead : {false, true}) {
      INFO("pairwise " << pairwise << ", ahead " << ahead);
      const Devices devices(1);
      const auto slot = dispatcher().devices().front();
      CHECK(dGpuTriMeshSetBackend(dGPUTRIMESH_BACKEND_OPENCL) == dGPUTRIMESH_OK);
      const std::uint64_t uploadsBefore = devices[0].mesh_uploads;
      PileWorld world(choices);
      byLevels(world);
      world.step(30, [&] {
        if (ahead) dGpuTriMeshPrefetch(world.space());
      });
      CHECK(world.bytes() == plain.bytes());
      CHECK((world.stats().prefetched > 0) == ahead);
      CHECK(world.stats().on_device > 100);
      CHECK(world.stats().device_failures == 0);
      // All of it was done there by that traversal: meshes are in its store alone.
      const std::uint64_t uploads = slot->backend->published().meshCounts().uploads;
      CHECK(uploads > 0);
      CHECK(devices[0].mesh_uploads == uploadsBefore + uploads);
    }
  }
}

TEST_CASE("the published traversal takes nothing of a device until it is asked for") {
  const OdeSession session;
  const Data lump(scenes::makeLump(0.5, 2, 0.3, 1));  // pairs of convex meshes are the host's
  const Geom a(lump), b(lump);
  dGeomSetPosition(b.id, 0.4, 0.3, 0.2);
  const Devices devices(1);
  const auto slot = dispatcher().devices().front();
  const auto bytesByLevels = [&] { return slot->backend->published().meshCounts().bytesHeld; };
  CHECK(dGpuTriMeshSetBackend(dGPUTRIMESH_BACKEND_OPENCL) == dGPUTRIMESH_OK);
  const auto expected = test::collide(a.id, b.id);
  CHECK_FALSE(expected.empty());
  CHECK(bytesByLevels() == 0);
  const auto set = [](dGeomID geom, int traversal, int near) {
    dGpuTriMeshParams params;
    dGpuTriMeshParamsInit(&params);
    params.traversal = traversal;
    params.near_phase = near;
    CHECK(dGeomGpuTriMeshSetParams(geom, &params) == dGPUTRIMESH_OK);
  };
  set(b.id, dGPUTRIMESH_TRAVERSAL_LEVELS, dGPUTRIMESH_BACKEND_DEFAULT);
  CHECK(sameContacts(test::collide(a.id, b.id), expected));  // the search is as the geom created first has it
  CHECK(bytesByLevels() == 0);
  set(a.id, dGPUTRIMESH_TRAVERSAL_LEVELS, dGPUTRIMESH_BACKEND_CPU);
  CHECK(sameContacts(test::collide(a.id, b.id), expected));  // the CPU decides what levels find
  CHECK(bytesByLevels() > 0);
  set(a.id, dGPUTRIMESH_TRAVERSAL_LEVELS, dGPUTRIMESH_BACKEND_DEFAULT);
  CHECK(sameContacts(test::collide(a.id, b.id), expected));
  CHECK(devices[0].failed_calls == 0);
}

TEST_CASE("a device that fails in the middle of a simulation changes nothing but the statistics") {
  const OdeSession session;
  const Quiet quiet;
  PileWorld::Choices choices;
  choices.bodies = 6;
  PileWorld plain(choices);
  plain.step(40);
  for (const bool ahead : {false, true}) {
    const Devices devices(2);
    CHECK(dGpuTriMeshSetBackend(dGPUTRIMESH_BACKEND_OPENCL) == dGPUTRIMESH_OK);
    PileWorld world(choices);
    int step = 0;
    world.step(40, [&] {
      if (++step == 15) opencl::FaultInjection::failAt(1, CL_OUT_OF_RESOURCES, 1u << 30);
      if (ahead) dGpuTriMeshPrefetch(world.space());
    });
    CHECK(world.bytes() == plain.bytes());
    CHECK(world.stats().device_failures >= 2);
    for (int i = 0; i < 2; ++i) {
      CHECK(devices[i].switched_off == 1);
      CHECK(devices[i].failed_calls >= dGPUTRIMESH_DEVICE_FAILURES);
    }
    opencl::FaultInjection::failAt(0);
  }
}

TEST_CASE("vertices that move are sent to devices by themselves, of a mesh and of its scaled ones") {
  const OdeSession session;
  const scenes::MeshArrays lump = scenes::makeLump(1, 4, 0.2, 3);
  const Data data(lump), other(scenes::makeBox({1, 1, 1}, 3));
  const Geom plain(data), stretched(data), mirrored(data), box(other);
  REQUIRE(dGeomGpuTriMeshSetScale(stretched.id, 1.2, 1, 0.9) == dGPUTRIMESH_OK);
  REQUIRE(dGeomGpuTriMeshSetScale(mirrored.id, -1, 1, 1) == dGPUTRIMESH_OK);
  const Devices devices(2);
  for (const dGeomID g : {plain.id, stretched.id, mirrored.id, box.id}) {
    dGpuTriMeshParams params;
    dGpuTriMeshParamsInit(&params);
    params.history = dGPUTRIMESH_HISTORY_OFF;
    CHECK(dGeomGpuTriMeshSetParams(g, &params) == dGPUTRIMESH_OK);
  }
  dGeomSetPosition(box.id, 0.9, 0.5, 0.4);
  std::mt19937 random(4);
  std::vector<Vec3f> now = lump.vertices;
  duint64 uploads = 0;
  for (int step = 0; step < 8; ++step) {
    INFO("step " << step);
    const int vertex = static_cast<int>(random() % now.size());
    Vec3f& p = now[static_cast<std::size_t>(vertex)];
    p = otgScale(p, 1.001f);
    REQUIRE(dGpuTriMeshDataUpdateListSingle(data.id, &p, 0, &vertex, 1) == dGPUTRIMESH_OK);
    for (const dGeomID g : {plain.id, stretched.id, mirrored.id}) {
      CHECK(dGpuTriMeshSetBackend(dGPUTRIMESH_BACKEND_CPU) == dGPUTRIMESH_OK);
      const auto expected = test::collide(g, box.id);
      CHECK(!expected.empty());
      CHECK(dGpuTriMeshSetBackend(dGPUTRIMESH_BACKEND_OPENCL) == dGPUTRIMESH_OK);
      for (int i = 0; i < 2; ++i) CHECK(sameContacts(test::collide(g, box.id), expected));
    }
    if (step == 2) uploads = devices[0].mesh_uploads + devices[1].mesh_uploads;
  }
  CHECK(devices[0].mesh_uploads + devices[1].mesh_uploads == uploads);
  CHECK(devices[0].mesh_updates + devices[1].mesh_updates >= 3 * 5);
  CHECK(devices[0].mesh_bytes_sent + devices[1].mesh_bytes_sent > 0);
  CHECK(devices[0].memory_bytes > devices[0].mesh_bytes);
  CHECK(dGpuTriMeshReleaseDeviceMemory() > 0);
  CHECK(devices[0].memory_bytes + devices[1].memory_bytes == 0);
  CHECK(!test::collide(plain.id, box.id).empty());
  CHECK(devices[0].memory_bytes + devices[1].memory_bytes > 0);
}

TEST_CASE("the choice of a geom, and of two that differ") {
  const OdeSession session;
  const Data lump(scenes::makeLump(0.5, 2, 0.3, 1));  // pairs of convex meshes are the host's
  const Geom a(lump), b(lump);
  dGeomSetPosition(b.id, 0.4, 0.3, 0.2);
  const auto onDevice = [&] {
    dGeomGpuTriMeshResetStats(a.id);
    CHECK(!test::collide(a.id, b.id).empty());
    dGpuTriMeshStats stats;
    dGpuTriMeshStatsInit(&stats);
    CHECK(dGeomGpuTriMeshGetStats(a.id, &stats) == dGPUTRIMESH_OK);
    return stats.on_device == 1;
  };
  CHECK(dGeomGpuTriMeshSetBackend(a.id, dGPUTRIMESH_BACKEND_OPENCL) == dGPUTRIMESH_NO_DEVICE);
  CHECK_FALSE(onDevice());
  const Devices devices(1);
  CHECK(dGeomGpuTriMeshSetBackend(a.id, dGPUTRIMESH_BACKEND_OPENCL) == dGPUTRIMESH_OK);
  CHECK(dGeomGpuTriMeshGetBackend(a.id) == dGPUTRIMESH_BACKEND_OPENCL);
  CHECK(dGpuTriMeshSetBackend(dGPUTRIMESH_BACKEND_CPU) == dGPUTRIMESH_OK);
  CHECK_FALSE(onDevice());  // b does as the process
  CHECK(dGeomGpuTriMeshSetBackend(b.id, dGPUTRIMESH_BACKEND_AUTO) == dGPUTRIMESH_OK);
  CHECK(onDevice());
  CHECK(dGeomGpuTriMeshSetBackend(b.id, dGPUTRIMESH_BACKEND_CPU) == dGPUTRIMESH_OK);
  CHECK_FALSE(onDevice());
  CHECK(dGeomGpuTriMeshSetBackend(b.id, dGPUTRIMESH_BACKEND_DEFAULT) == dGPUTRIMESH_OK);
  CHECK(dGpuTriMeshSetBackend(dGPUTRIMESH_BACKEND_OPENCL) == dGPUTRIMESH_OK);
  CHECK(onDevice());
  // Refused.
  for (const int wrong : {-1, 0, 4}) CHECK(dGpuTriMeshSetBackend(wrong) == dGPUTRIMESH_ERROR_ARGUMENT);
  for (const int wrong : {-1, 4}) CHECK(dGeomGpuTriMeshSetBackend(a.id, wrong) == dGPUTRIMESH_ERROR_ARGUMENT);
  CHECK(dGeomGpuTriMeshSetBackend(nullptr, 1) == dGPUTRIMESH_ERROR_CLASS);
  CHECK(dGeomGpuTriMeshGetBackend(nullptr) == dGPUTRIMESH_ERROR_CLASS);
  const int none = 12345;
  CHECK(dGpuTriMeshOpenDevices(nullptr, -2) == dGPUTRIMESH_ERROR_ARGUMENT);
  CHECK(dGpuTriMeshOpenDevices(&none, -1) == dGPUTRIMESH_ERROR_ARGUMENT);
  dGpuTriMeshDevice device;
  dGpuTriMeshDeviceInit(&device);
  CHECK(dGpuTriMeshGetDevice(1, &device) == dGPUTRIMESH_ERROR_ARGUMENT);
  CHECK(dGpuTriMeshGetDevice(-1, &device) == dGPUTRIMESH_ERROR_ARGUMENT);
  CHECK(dGpuTriMeshGetDevice(0, nullptr) == dGPUTRIMESH_ERROR_ARGUMENT);
  device.size = 3;
  CHECK(dGpuTriMeshGetDevice(0, &device) == dGPUTRIMESH_ERROR_ARGUMENT);
  CHECK(dGpuTriMeshGetDeviceCount() == 1);  // nothing of that closed it
  const Quiet quiet;
  CHECK(dGpuTriMeshOpenDevices(&none, 1) == 0);
  CHECK(dGpuTriMeshGetDeviceCount() == 0);
  CHECK_FALSE(onDevice());
  CHECK(dGpuTriMeshOpenDevices(nullptr, 0) == 1);
  CHECK(onDevice());
  CHECK(dGpuTriMeshOpenDevices(nullptr, -1) >= 0);
}

TEST_CASE("ten thousand queries and a thousand batches take no more memory than a few") {
  const OdeSession session;
  const Devices devices(2);
  CHECK(dGpuTriMeshSetBackend(dGPUTRIMESH_BACKEND_OPENCL) == dGPUTRIMESH_OK);
  const Data box(scenes::makeBox({1, 1, 1}, 2)), torus(scenes::makeTorus(0.5, 0.2, 12, 7));
  std::vector<dGeomID> geoms;
  std::mt19937 random(1);
  const dSpaceID space = dSimpleSpaceCreate(nullptr);
  for (int i = 0; i < 5; ++i) {
    geoms.push_back(dCreateGpuTriMesh(space, i % 2 ? torus.id : box.id));
    if (i > 2) usePairwise(geoms.back());
  }
  dContactGeom contacts[10 * 8];
  int counts[10];
  std::vector<dGpuTriMeshPair> pairs;
  for (std::size_t i = 0; i < 5; ++i) {
    for (std::size_t k = i + 1; k < 5; ++k) pairs.push_back({geoms[i], geoms[k]});
  }
  long found = 0;
  const auto round = [&](int n) {
    for (int i = 0; i < n; ++i) {
      for (const dGeomID geom : geoms) setRandomPose(geom, random, 0.6);
      found += dGpuTriMeshCollidePairs(pairs.data(), 10, 8, contacts, sizeof(dContactGeom), counts);
      dGpuTriMeshPrefetch(space);
      for (std::size_t k = 0; k < 10; ++k) {  // half of them of the prefetch, and then computed
        dCollide(pairs[k].o1, pairs[k].o2, 8, contacts, sizeof(dContactGeom));
        if (k % 2 == 0)
          dCollide(pairs[k].o1, pairs[k].o2, int(8u | CONTACTS_UNIMPORTANT), contacts, sizeof(dContactGeom));
      }
    }
  };
  round(60);
  const long before = residentKb();
  round(600);
  const long after = residentKb();
  CHECK(found > 10000);
  CHECK(devices[0].queries + devices[1].queries > 10000);
  CHECK(devices[0].failed_calls + devices[1].failed_calls == 0);
  CHECK(after - before < 4096);
  dSpaceDestroy(space);
}

TEST_CASE("a hundred thousand tiny pairs in one call have the bytes of the CPU") {
  const OdeSession session;
  const Data one(scenes::makeTetrahedron({0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1})),
      two(scenes::makeBox({1, 1, 1}, 1));
  constexpr std::size_t kGeoms = 448;
  constexpr int kPlaces = 4;
  std::mt19937 random(5);
  const dSpaceID space = dSimpleSpaceCreate(nullptr);
  std::vector<dGeomID> geoms;
  for (std::size_t i = 0; i < kGeoms; ++i) {
    geoms.push_back(dCreateGpuTriMesh(space, i % 3 ? one.id : two.id));
    usePairwise(geoms.back());
    setRandomPose(geoms.back(), random, 0.4);  // so that nearly all boxes overlap
  }
  std::vector<dGpuTriMeshPair> pairs;
  for (std::size_t i = 0; i < kGeoms; ++i) {
    for (std::size_t k = i + 1; k < kGeoms; ++k) pairs.push_back({geoms[i], geoms[k]});
  }
  REQUIRE(pairs.size() > 100000);
  struct Found {
    std::vector<dContactGeom> contacts;
    std::vector<int> counts;
    int all = 0;
  };
  const auto collideAll = [&] {
    Found found;
    found.contacts.resize(pairs.size() * kPlaces);
    std::memset(static_cast<void*>(found.contacts.data()), 0, found.contacts.size() * sizeof(dContactGeom));
    found.counts.resize(pairs.size());
    found.all = dGpuTriMeshCollidePairs(pairs.data(), static_cast<int>(pairs.size()), kPlaces, found.contacts.data(),
                                        sizeof(dContactGeom), found.counts.data());
    return found;
  };
  CHECK(dGpuTriMeshSetBackend(dGPUTRIMESH_BACKEND_CPU) == dGPUTRIMESH_OK);
  const Found expected = collideAll();
  CHECK(expected.all > 100000);
  const Devices devices(1);
  for (const int backend : {dGPUTRIMESH_BACKEND_OPENCL, dGPUTRIMESH_BACKEND_AUTO}) {
    CHECK(dGpuTriMeshSetBackend(backend) == dGPUTRIMESH_OK);
    const Found found = collideAll();
    CHECK(found.all == expected.all);
    CHECK(found.counts == expected.counts);
    CHECK(std::memcmp(found.contacts.data(), expected.contacts.data(),
                      expected.contacts.size() * sizeof(dContactGeom)) == 0);
  }
  CHECK(devices[0].failed_calls == 0);
  CHECK(devices[0].queries > 90000);
  dSpaceDestroy(space);
}
