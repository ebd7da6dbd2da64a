// SPDX-License-Identifier: BSD-3-Clause
// Whether meshes overlap, for arrays of pairs through the C API: with devices the answers are those of the CPU.
#include <algorithm>
#include <atomic>
#include <cstdlib>
#include <memory>
#include <new>
#include <random>

#include "opencl/runtime/call.h"
#include "opencl/runtime/device_info.h"
#include "support/catch.h"
#include "support/ode_world.h"

namespace {

/// What is so large lists something for each pair of an array.
constexpr std::size_t kLarge = 8192;
/// How many more of these may be taken from the heap, where that is limited.
std::atomic<bool> isLimited{false};
std::atomic<int> left{0};

}  // namespace

// This program's own, which the library in it uses as well.
[[gnu::noinline]] void* operator new(std::size_t size) {
  if (size >= kLarge && isLimited && left-- <= 0) throw std::bad_alloc();
  if (void* const memory = std::malloc(size > 0 ? size : 1); memory != nullptr) return memory;
  throw std::bad_alloc();
}
[[gnu::noinline]] void operator delete(void* memory) noexcept {
  std::free(memory);
}
[[gnu::noinline]] void operator delete(void* memory, std::size_t) noexcept {
  std::free(memory);
}

using namespace otg;
using namespace otg::test;

namespace {

/// Closed bodies of several sizes, a sheet, a shell that is wound anyhow, one triangle, and a geom without a mesh,
/// thrown into a box; and a small body wholly inside a large one.
class Crowd {
 public:
  Crowd() {
    scenes::MeshArrays open = scenes::makeLump(1, 3, 0.3, 5);
    open.triangles.resize(open.triangles.size() * 3 / 4);
    scenes::MeshArrays tangled = open;
    for (std::size_t t = 0; t < tangled.triangles.size(); t += 3) {
      std::swap(tangled.triangles[t].v[0], tangled.triangles[t].v[1]);
    }
    scenes::MeshArrays one;
    one.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0.5f}};
    one.triangles = {{{0, 1, 2}}};
    for (const scenes::MeshArrays& arrays :
         {scenes::makeLump(1, 3, 0.3, 5), scenes::makeLump(0.4, 2, 0.2, 6), scenes::makeBox({2, 3, 2}, 2), open,
          tangled, one, scenes::makeBox({0.1, 0.1, 0.1})}) {
      data_.push_back(std::make_unique<Data>(arrays));
    }
    std::mt19937 random(11);
    for (int copy = 0; copy < 6; ++copy) {
      for (const auto& data : data_) {
        const dGeomID geom = dCreateGpuTriMesh(nullptr, data->id);
        setRandomPose(geom, random, 2);
        geoms_.push_back(geom);
      }
    }
    geoms_.push_back(dCreateGpuTriMesh(nullptr, nullptr));
    for (std::size_t i = 0; i < geoms_.size(); ++i) {
      for (std::size_t k = 0; k < geoms_.size(); ++k) {
        if (i != k) pairs_.push_back({geoms_[i], geoms_[k]});
      }
    }
    const dGeomID large = dCreateGpuTriMesh(nullptr, data_[2]->id), small = dCreateGpuTriMesh(nullptr, data_[6]->id);
    geoms_.insert(geoms_.end(), {large, small});
    pairs_.push_back({small, large});
    pairs_.push_back({large, small});
  }
  ~Crowd() {
    for (const dGeomID geom : geoms_) dGeomDestroy(geom);
  }
  Crowd(const Crowd&) = delete;
  Crowd& operator=(const Crowd&) = delete;

  std::vector<unsigned char> ask(int* sum = nullptr) const {
    std::vector<unsigned char> answers(pairs_.size(), 7);
    const int count = dGpuTriMeshOverlaps(pairs_.data(), static_cast<int>(pairs_.size()), answers.data());
    CHECK(count == std::count(answers.begin(), answers.end(), 1));
    if (sum != nullptr) *sum = count;
    return answers;
  }
  const std::vector<dGpuTriMeshPair>& pairs() const { return pairs_; }
  const std::vector<dGeomID>& geoms() const { return geoms_; }

 private:
  std::vector<std::unique_ptr<Data>> data_;
  std::vector<dGeomID> geoms_;
  std::vector<dGpuTriMeshPair> pairs_;
};

dGpuTriMeshDevice device(int number) {
  dGpuTriMeshDevice device;
  dGpuTriMeshDeviceInit(&device);
  CHECK(dGpuTriMeshGetDevice(number, &device) == dGPUTRIMESH_OK);
  return device;
}

}  // namespace

TEST_CASE("an array of pairs has the same yes or no on one to three devices, on the CPU, and one by one") {
  const OdeSession session;
  const Crowd crowd;
  REQUIRE(dGpuTriMeshSetBackend(dGPUTRIMESH_BACKEND_CPU) == dGPUTRIMESH_OK);
  int sum = 0;
  const std::vector<unsigned char> expected = crowd.ask(&sum);
  CHECK(sum > 100);
  CHECK(sum + 100 < static_cast<int>(expected.size()));
  CHECK(expected[expected.size() - 1] == 1);  // wholly inside
  CHECK(expected[expected.size() - 2] == 1);
  for (std::size_t i = 0; i < expected.size(); i += 17) {
    CHECK(dGpuTriMeshOverlap(crowd.pairs()[i].o1, crowd.pairs()[i].o2) == expected[i]);
  }
  const int index = opencl::defaultDevice(opencl::listDevices());
  for (const int count : {1, 2, 3}) {
    const std::vector<int> same(static_cast<std::size_t>(count), index);
    REQUIRE(dGpuTriMeshOpenDevices(same.data(), count) == count);
    REQUIRE(dGpuTriMeshSetBackend(dGPUTRIMESH_BACKEND_OPENCL) == dGPUTRIMESH_OK);
    CHECK(crowd.ask() == expected);
    duint64 asked = 0;
    for (int d = 0; d < count; ++d) {
      CHECK(device(d).queries > 0);
      CHECK(device(d).failed_calls == 0);
      asked += device(d).queries;
    }
    // All but those of the geom without a mesh.
    CHECK(asked == expected.size() - 2 * (crowd.geoms().size() - 3));
    REQUIRE(dGpuTriMeshSetBackend(dGPUTRIMESH_BACKEND_AUTO) == dGPUTRIMESH_OK);
    CHECK(crowd.ask() == expected);
    REQUIRE(dGpuTriMeshSetBackend(dGPUTRIMESH_BACKEND_CPU) == dGPUTRIMESH_OK);
    const duint64 before = device(0).queries;
    CHECK(crowd.ask() == expected);
    CHECK(device(0).queries == before);
  }
  dGpuTriMeshCloseDevices();
}

TEST_CASE("an array of pairs has its yes or no when calls of the device fail") {
  const OdeSession session;
  const Crowd crowd;
  REQUIRE(dGpuTriMeshSetBackend(dGPUTRIMESH_BACKEND_CPU) == dGPUTRIMESH_OK);
  const std::vector<unsigned char> expected = crowd.ask();
  const int index = opencl::defaultDevice(opencl::listDevices());
  std::uint64_t calls = 0;
  int failed = 0;
  for (std::uint64_t failing = 0; failing <= calls; ++failing) {
    REQUIRE(dGpuTriMeshOpenDevices(&index, 1) == 1);
    REQUIRE(dGpuTriMeshSetBackend(dGPUTRIMESH_BACKEND_OPENCL) == dGPUTRIMESH_OK);
    const std::uint64_t before = opencl::FaultInjection::callCount();
    opencl::FaultInjection::failAt(failing);  // 0: none
    CHECK(crowd.ask() == expected);
    opencl::FaultInjection::failAt(0);
    if (failing == 0) calls = opencl::FaultInjection::callCount() - before;
    failed += device(0).failed_calls > 0 ? 1 : 0;  // not by calls that release
    if (failing == 0) CHECK(failed == 0);
    dGpuTriMeshCloseDevices();
  }
  CHECK(calls > 8);
  CHECK(failed > 5);
  REQUIRE(dGpuTriMeshSetBackend(dGPUTRIMESH_BACKEND_CPU) == dGPUTRIMESH_OK);
}

TEST_CASE("an array of pairs whose memory is refused ends with an error, and is answered once there is enough") {
  const OdeSession session;
  const Crowd crowd;
  REQUIRE(dGpuTriMeshSetBackend(dGPUTRIMESH_BACKEND_CPU) == dGPUTRIMESH_OK);
  const std::vector<unsigned char> expected = crowd.ask();
  const int index = opencl::defaultDevice(opencl::listDevices());
  const std::vector<int> twice{index, index};
  for (const int count : {1, 2}) {
    REQUIRE(dGpuTriMeshOpenDevices(twice.data(), count) == count);
    REQUIRE(dGpuTriMeshSetBackend(dGPUTRIMESH_BACKEND_OPENCL) == dGPUTRIMESH_OK);
    CHECK(crowd.ask() == expected);  // what is kept for the next call is there
    std::vector<unsigned char> answers(expected.size());
    int refused = 0;
    for (bool isDone = false; !isDone;) {
      left = refused;
      isLimited = true;
      const int sum = dGpuTriMeshOverlaps(crowd.pairs().data(), static_cast<int>(crowd.pairs().size()), answers.data());
      isLimited = false;
      isDone = sum >= 0;
      if (isDone) break;
      REQUIRE(sum == dGPUTRIMESH_ERROR_MEMORY);
      REQUIRE(++refused < 1000);
    }
    CHECK(answers == expected);
    CHECK(refused > 3);
    dGpuTriMeshCloseDevices();
  }
  REQUIRE(dGpuTriMeshSetBackend(dGPUTRIMESH_BACKEND_CPU) == dGPUTRIMESH_OK);
}

TEST_CASE("pairs with a geom of another class or a bad pose end an array with an error, with a device at hand") {
  const OdeSession session;
  const Crowd crowd;
  const int index = opencl::defaultDevice(opencl::listDevices());
  REQUIRE(dGpuTriMeshOpenDevices(&index, 1) == 1);
  REQUIRE(dGpuTriMeshSetBackend(dGPUTRIMESH_BACKEND_OPENCL) == dGPUTRIMESH_OK);
  unsigned char answer = 0;
  const dGeomID sphere = dCreateSphere(nullptr, 1);
  const dGpuTriMeshPair wrong{crowd.geoms()[0], sphere};
  CHECK(dGpuTriMeshOverlaps(&wrong, 1, &answer) == dGPUTRIMESH_ERROR_CLASS);
  CHECK(dGpuTriMeshOverlaps(nullptr, 0, nullptr) == 0);
  CHECK(dGpuTriMeshOverlaps(nullptr, 1, &answer) == dGPUTRIMESH_ERROR_ARGUMENT);
  dGeomSetPosition(crowd.geoms()[1], dInfinity, 0, 0);
  const dGpuTriMeshPair lost{crowd.geoms()[0], crowd.geoms()[1]};
  CHECK(dGpuTriMeshOverlaps(&lost, 1, &answer) == dGPUTRIMESH_ERROR_POSE);
  dGeomDestroy(sphere);
  dGpuTriMeshCloseDevices();
  REQUIRE(dGpuTriMeshSetBackend(dGPUTRIMESH_BACKEND_CPU) == dGPUTRIMESH_OK);
}
