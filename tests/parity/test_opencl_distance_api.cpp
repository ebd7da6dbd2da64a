// SPDX-License-Identifier: BSD-3-Clause
// Arrays of distances through the C API: with devices they have the bytes that they have on the CPU.
#include <cstring>
#include <random>

#include "opencl/runtime/device_info.h"
#include "support/catch.h"
#include "support/ode_devices.h"
#include "support/ode_world.h"

using namespace otg;
using namespace otg::test;

namespace {

struct Distances {
  std::vector<dGpuTriMeshDistance> all;
  int status = 0;
  bool operator==(const Distances& o) const {
    return status == o.status && all.size() == o.all.size() &&
           std::memcmp(all.data(), o.all.data(), all.size() * sizeof all[0]) == 0;
  }
};

Distances measure(const std::vector<dGpuTriMeshPair>& pairs, dReal limit) {
  Distances out;
  out.all.resize(pairs.size());
  std::memset(static_cast<void*>(out.all.data()), 0xcd, out.all.size() * sizeof out.all[0]);
  out.status = dGpuTriMeshGetDistances(pairs.data(), static_cast<int>(pairs.size()), limit, out.all.data());
  return out;
}

}  // namespace

TEST_CASE("distances of geoms that are posed, scaled and mirrored have the same bytes on a device") {
  const OdeSession session;
  const Data lump(scenes::makeLump(1, 3, 0.3, 5)), box(scenes::makeBox({1, 2, 3}, 2));
  std::mt19937 random(8);
  std::vector<std::unique_ptr<Geom>> geoms;
  for (int i = 0; i < 12; ++i) {
    geoms.push_back(std::make_unique<Geom>(i % 2 == 0 ? lump : box));
    const dGeomID g = geoms.back()->id;
    if (i % 3 == 1) CHECK(dGeomGpuTriMeshSetScale(g, 2, 0.5, 1) == dGPUTRIMESH_OK);
    if (i % 3 == 2) CHECK(dGeomGpuTriMeshSetScale(g, -1, 1, 1.5) == dGPUTRIMESH_OK);
    setRandomPose(g, random, 6);
  }
  const dGeomID bare = dCreateGpuTriMesh(nullptr, nullptr);
  std::vector<dGpuTriMeshPair> pairs;
  for (std::size_t i = 0; i < geoms.size(); ++i) {
    for (std::size_t k = 0; k < i; ++k) pairs.push_back({geoms[i]->id, geoms[k]->id});
  }
  pairs.push_back({bare, geoms[0]->id});
  pairs.push_back({geoms[3]->id, geoms[3]->id});
  const int index = opencl::defaultDevice(opencl::listDevices());
  const auto choose = [&](int backend) {
    for (const auto& geom : geoms) CHECK(dGeomGpuTriMeshSetBackend(geom->id, backend) == dGPUTRIMESH_OK);
  };
  for (const dReal limit : {dInfinity, dReal(2)}) {
    choose(dGPUTRIMESH_BACKEND_CPU);
    const Distances expected = measure(pairs, limit);
    CHECK(expected.status == dGPUTRIMESH_OK);
    int apart = 0, overlapping = 0, beyond = 0;
    for (std::size_t i = 0; i < pairs.size(); ++i) {
      const dReal distance = expected.all[i].distance;
      ++(distance == 0 ? overlapping : distance == dInfinity ? beyond : apart);
      dGpuTriMeshDistance one;  // an array is its pairs, one by one
      std::memset(static_cast<void*>(&one), 0xcd, sizeof one);
      CHECK(dGpuTriMeshGetDistance(pairs[i].o1, pairs[i].o2, limit, &one) == dGPUTRIMESH_OK);
      CHECK(std::memcmp(&one, &expected.all[i], sizeof one) == 0);
    }
    CHECK(apart > 10);
    CHECK(overlapping > 2);
    CHECK(beyond >= (limit == dInfinity ? 1 : 10));
    REQUIRE(dGpuTriMeshOpenDevices(&index, 1) == 1);
    std::uint64_t before = deviceCalls();
    CHECK(measure(pairs, limit) == expected);
    CHECK(deviceCalls() == before);  // the CPU's
    choose(dGPUTRIMESH_BACKEND_OPENCL);
    CHECK(measure(pairs, limit) == expected);
    CHECK(deviceCalls() == before + 1);
    before = deviceCalls();
    dGpuTriMeshDistance one;
    CHECK(dGpuTriMeshGetDistance(pairs[0].o1, pairs[0].o2, limit, &one) == dGPUTRIMESH_OK);
    CHECK(deviceCalls() == before);  // a single pair is always the CPU's
    choose(dGPUTRIMESH_BACKEND_AUTO);
    CHECK(measure(pairs, limit) == expected);
    // Geoms are let go of, and one of another class is an error.
    CHECK(dGeomGpuTriMeshSetScale(geoms[0]->id, 1, 1, 1) == dGPUTRIMESH_OK);
    const dGeomID sphere = dCreateSphere(nullptr, 1);
    CHECK(measure({pairs[0], {sphere, geoms[0]->id}}, limit).status == dGPUTRIMESH_ERROR_CLASS);
    CHECK(measure(pairs, -1).status == dGPUTRIMESH_ERROR_ARGUMENT);
    dGeomDestroy(sphere);
    dGpuTriMeshCloseDevices();
  }
  dGeomDestroy(bare);
}
