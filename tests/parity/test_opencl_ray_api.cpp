// SPDX-License-Identifier: BSD-3-Clause
// Arrays of rays through the C API: with devices they have the bytes that they have on the CPU.
#include <cstring>
#include <random>

#include "opencl/runtime/device_info.h"
#include "support/catch.h"
#include "support/ode_devices.h"
#include "support/ode_world.h"

using namespace otg;
using namespace otg::test;

namespace {

/// In any direction, of any length, with an end or not; and along axes through a grid of places.
std::vector<dGpuTriMeshRay> rays(std::size_t count) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> unit(-1, 1);
  std::vector<dGpuTriMeshRay> all(count);
  for (std::size_t i = 0; i < count; ++i) {
    const double size = std::pow(10, 3 * unit(random));
    all[i] = {{3 * unit(random), 3 * unit(random), 3 * unit(random), 0},
              {size * unit(random), size * unit(random), size * unit(random), 0},
              i % 3 == 0 ? 2 + 2 * unit(random) : dInfinity};
    if (i % 4 == 0) {
      all[i] = {{0.25 * static_cast<double>(i % 17) - 2, 0.25 * static_cast<double>(i % 13) - 1.5, 5, 0},
                {0, 0, -1, 0},
                dInfinity};
    }
  }
  return all;
}

struct Hits {
  std::vector<dGpuTriMeshRayHit> hits;
  int count = 0;
  bool operator==(const Hits& o) const {
    return count == o.count && hits.size() == o.hits.size() &&
           std::memcmp(hits.data(), o.hits.data(), hits.size() * sizeof hits[0]) == 0;
  }
};

Hits cast(dGeomID geom, const std::vector<dGpuTriMeshRay>& rays, int flags) {
  Hits out;
  out.hits.resize(rays.size());
  std::memset(static_cast<void*>(out.hits.data()), 0xcd, out.hits.size() * sizeof out.hits[0]);
  out.count = dGeomGpuTriMeshCastRays(geom, rays.data(), static_cast<int>(rays.size()), flags, out.hits.data());
  return out;
}

constexpr int kFlags[] = {0, dGPUTRIMESH_RAY_CULL_BACK, dGPUTRIMESH_RAY_ANY,
                          dGPUTRIMESH_RAY_CULL_BACK | dGPUTRIMESH_RAY_ANY};

int askNothing(dGeomID, dGeomID, int, dReal, dReal) {
  FAIL("the ray callback is asked about rays that are geoms alone");
  return 0;
}

}  // namespace

TEST_CASE("rays at geoms that are posed, scaled and mirrored have the same bytes on a device") {
  const OdeSession session;
  const std::vector<dGpuTriMeshRay> some = rays(3000);
  scenes::MeshArrays open = scenes::makeLump(1, 3, 0.3, 5);
  open.triangles.resize(open.triangles.size() * 3 / 4);
  const int index = opencl::defaultDevice(opencl::listDevices());
  std::mt19937 random(8);
  int hits = 0;
  for (const scenes::MeshArrays& arrays : {scenes::makeLump(1, 3, 0.3, 5), scenes::makeBox({1, 2, 3}, 2), open}) {
    const Data data(arrays);
    const Geom geom(data);
    for (const auto& scale : {std::array<double, 3>{1, 1, 1}, {2, 0.5, 1}, {-1, 1, 1.5}}) {
      CHECK(dGeomGpuTriMeshSetScale(geom.id, scale[0], scale[1], scale[2]) == dGPUTRIMESH_OK);
      if (scale[0] == 1) {
        dRSetIdentity(const_cast<dReal*>(dGeomGetRotation(geom.id)));  // rays along axes meet edges and corners
        dGeomSetPosition(geom.id, 0, 0, 0);
      } else {
        setRandomPose(geom.id, random, 1);
      }
      CHECK(dGeomGpuTriMeshSetBackend(geom.id, dGPUTRIMESH_BACKEND_CPU) == dGPUTRIMESH_OK);
      std::vector<Hits> expected;
      for (const int flags : kFlags) expected.push_back(cast(geom.id, some, flags));
      CHECK(expected[2] == expected[0]);  // any hit: the closest one
      CHECK(expected[3] == expected[1]);
      hits += expected[0].count;
      for (std::size_t i = 0; i < some.size(); i += 97) {  // an array is its rays, one by one
        CHECK((cast(geom.id, {some[i]}, 0).hits[0].triangle == expected[0].hits[i].triangle));
      }
      REQUIRE(dGpuTriMeshOpenDevices(&index, 1) == 1);
      const std::uint64_t before = deviceCalls();
      CHECK(dGeomGpuTriMeshSetBackend(geom.id, dGPUTRIMESH_BACKEND_OPENCL) == dGPUTRIMESH_OK);
      for (std::size_t k = 0; k < 4; ++k) CHECK(cast(geom.id, some, kFlags[k]) == expected[k]);
      CHECK(deviceCalls() == before + 4);
      CHECK(dGeomGpuTriMeshSetBackend(geom.id, dGPUTRIMESH_BACKEND_AUTO) == dGPUTRIMESH_OK);
      CHECK(cast(geom.id, some, 0) == expected[0]);
      dGpuTriMeshCloseDevices();
    }
  }
  CHECK(hits > 2000);
}

TEST_CASE("an array of rays goes where dGpuTriMeshSetBackend() says if the geom says nothing") {
  const OdeSession session;
  const Data data(scenes::makeBox({1, 2, 3}, 2));
  const Geom geom(data);
  const std::vector<dGpuTriMeshRay> some = rays(100);
  const Hits expected = cast(geom.id, some, 0);
  const int index = opencl::defaultDevice(opencl::listDevices());
  REQUIRE(dGpuTriMeshOpenDevices(&index, 1) == 1);
  for (const auto& [backend, calls] : {std::pair{dGPUTRIMESH_BACKEND_CPU, 0u}, {dGPUTRIMESH_BACKEND_OPENCL, 1u}}) {
    CHECK(dGpuTriMeshSetBackend(backend) == dGPUTRIMESH_OK);
    const std::uint64_t before = deviceCalls();
    CHECK(cast(geom.id, some, 0) == expected);
    CHECK(deviceCalls() == before + calls);
  }
  CHECK(dGpuTriMeshSetBackend(dGPUTRIMESH_BACKEND_AUTO) == dGPUTRIMESH_OK);
  dGpuTriMeshCloseDevices();
}

TEST_CASE("no rays, a geom without a mesh, bad rays and a ray callback, with a device at hand") {
  const OdeSession session;
  const int index = opencl::defaultDevice(opencl::listDevices());
  REQUIRE(dGpuTriMeshOpenDevices(&index, 1) == 1);
  const Data data(scenes::makeBox({1, 1, 1}, 1));
  const Geom geom(data);
  CHECK(dGeomGpuTriMeshSetBackend(geom.id, dGPUTRIMESH_BACKEND_OPENCL) == dGPUTRIMESH_OK);
  CHECK(dGeomGpuTriMeshCastRays(geom.id, nullptr, 0, 0, nullptr) == 0);
  std::vector<dGpuTriMeshRay> some = rays(5000);
  const Hits expected = cast(geom.id, some, 0);
  CHECK(expected.count > 0);
  dGeomGpuTriMeshSetRayCallback(geom.id, askNothing);
  CHECK(cast(geom.id, some, 0) == expected);
  some[4999].direction[0] = std::nan("");
  const std::uint64_t before = deviceCalls();
  CHECK(cast(geom.id, some, 0).count == dGPUTRIMESH_ERROR_ARGUMENT);
  CHECK(deviceCalls() == before);
  some = rays(10);
  const dGeomID bare = dCreateGpuTriMesh(nullptr, nullptr);
  CHECK(dGeomGpuTriMeshSetBackend(bare, dGPUTRIMESH_BACKEND_OPENCL) == dGPUTRIMESH_OK);
  const Hits none = cast(bare, some, 0);
  CHECK(none.count == 0);
  for (const dGpuTriMeshRayHit& hit : none.hits) {
    CHECK(hit.triangle == -1);
    CHECK(hit.distance == dInfinity);
  }
  dGeomDestroy(bare);
  dGpuTriMeshCloseDevices();
}
