// SPDX-License-Identifier: BSD-3-Clause
// Arrays of points through the C API: with devices they have the bytes that they have on the CPU.
#include <cstring>
#include <random>

#include "opencl/runtime/device_info.h"
#include "support/catch.h"
#include "support/ode_devices.h"
#include "support/ode_world.h"

using namespace otg;
using namespace otg::test;

namespace {

struct Particle {
  dReal x[3];
  dReal mass;
};

std::vector<Particle> particles(std::size_t count) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> unit(-3, 3);
  std::vector<Particle> all(count);
  for (Particle& p : all) p = {{unit(random), unit(random), unit(random)}, 1};
  return all;
}

struct Answers {
  std::vector<dGpuTriMeshClosestPoint> closest;
  std::vector<unsigned char> inside;
  int count = 0;
  bool operator==(const Answers& o) const {
    return count == o.count && inside == o.inside && closest.size() == o.closest.size() &&
           std::memcmp(closest.data(), o.closest.data(), closest.size() * sizeof closest[0]) == 0;
  }
};

Answers ask(dGeomID geom, const std::vector<Particle>& points) {
  Answers out;
  out.closest.resize(points.size());
  out.inside.resize(points.size());
  std::memset(static_cast<void*>(out.closest.data()), 0, out.closest.size() * sizeof out.closest[0]);
  const int count = static_cast<int>(points.size());
  CHECK(dGeomGpuTriMeshClosestPoints(geom, points[0].x, sizeof(Particle), count, out.closest.data()) == dGPUTRIMESH_OK);
  out.count = dGeomGpuTriMeshPointsInside(geom, points[0].x, sizeof(Particle), count, out.inside.data());
  return out;
}

}  // namespace

TEST_CASE("points of geoms that are posed, scaled and mirrored have the same bytes on a device") {
  const OdeSession session;
  const std::vector<Particle> points = particles(3000);
  scenes::MeshArrays open = scenes::makeLump(1, 3, 0.3, 5);
  open.triangles.resize(open.triangles.size() * 3 / 4);
  scenes::MeshArrays tangled = open;
  for (std::size_t t = 0; t < tangled.triangles.size(); t += 3) {
    std::swap(tangled.triangles[t].v[0], tangled.triangles[t].v[1]);
  }
  const int index = opencl::defaultDevice(opencl::listDevices());
  std::mt19937 random(8);
  int insides = 0;
  for (const scenes::MeshArrays& arrays :
       {scenes::makeLump(1, 3, 0.3, 5), scenes::makeBox({1, 2, 3}, 2), open, tangled}) {
    const Data data(arrays);
    const Geom geom(data);
    for (const auto& scale : {std::array<double, 3>{1, 1, 1}, {2, 0.5, 1}, {-1, 1, 1.5}}) {
      CHECK(dGeomGpuTriMeshSetScale(geom.id, scale[0], scale[1], scale[2]) == dGPUTRIMESH_OK);
      setRandomPose(geom.id, random, 1);
      CHECK(dGeomGpuTriMeshSetBackend(geom.id, dGPUTRIMESH_BACKEND_CPU) == dGPUTRIMESH_OK);
      const Answers expected = ask(geom.id, points);
      insides += expected.count;
      for (std::size_t i = 0; i < points.size(); i += 97) {  // an array is its points, one by one
        dGpuTriMeshClosestPoint one;
        std::memset(static_cast<void*>(&one), 0, sizeof one);
        CHECK(dGeomGpuTriMeshClosestPoint(geom.id, points[i].x, &one) == dGPUTRIMESH_OK);
        CHECK(std::memcmp(&one, &expected.closest[i], sizeof one) == 0);
        CHECK((one.distance < 0) == (expected.inside[i] != 0));
      }
      REQUIRE(dGpuTriMeshOpenDevices(&index, 1) == 1);
      const bool answersInside = expected.count > 0;
      const std::uint64_t before = deviceCalls();
      CHECK(dGeomGpuTriMeshSetBackend(geom.id, dGPUTRIMESH_BACKEND_OPENCL) == dGPUTRIMESH_OK);
      CHECK(ask(geom.id, points) == expected);
      CHECK(deviceCalls() == before + (answersInside ? 2 : 1));  // a shell has no inside to be asked about
      CHECK(dGeomGpuTriMeshSetBackend(geom.id, dGPUTRIMESH_BACKEND_AUTO) == dGPUTRIMESH_OK);
      CHECK(ask(geom.id, points) == expected);
      dGpuTriMeshCloseDevices();
    }
  }
  CHECK(insides > 500);
}

TEST_CASE("an array of no points, and a geom without a mesh, with a device at hand") {
  const OdeSession session;
  const int index = opencl::defaultDevice(opencl::listDevices());
  REQUIRE(dGpuTriMeshOpenDevices(&index, 1) == 1);
  const Data data(scenes::makeBox({1, 1, 1}, 1));
  const Geom geom(data);
  CHECK(dGeomGpuTriMeshSetBackend(geom.id, dGPUTRIMESH_BACKEND_OPENCL) == dGPUTRIMESH_OK);
  CHECK(dGeomGpuTriMeshClosestPoints(geom.id, nullptr, 24, 0, nullptr) == dGPUTRIMESH_OK);
  CHECK(dGeomGpuTriMeshPointsInside(geom.id, nullptr, 24, 0, nullptr) == 0);
  const dGeomID bare = dCreateGpuTriMesh(nullptr, nullptr);
  CHECK(dGeomGpuTriMeshSetBackend(bare, dGPUTRIMESH_BACKEND_OPENCL) == dGPUTRIMESH_OK);
  const std::vector<Particle> points = particles(10);
  const Answers none = ask(bare, points);
  CHECK(none.count == 0);
  for (const dGpuTriMeshClosestPoint& p : none.closest) {
    CHECK(p.triangle == -1);
    CHECK(p.distance == dInfinity);
  }
  dGeomDestroy(bare);
  dGpuTriMeshCloseDevices();
}
