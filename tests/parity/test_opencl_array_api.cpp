// SPDX-License-Identifier: BSD-3-Clause
// Arrays of points and of rays through the C API: with devices they have the bytes that they have on the CPU. What both
// promise is tested once, for either.
#include <array>
#include <cmath>
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

template <class T>
bool sameBytes(const std::vector<T>& x, const std::vector<T>& y) {
  return x.size() == y.size() && std::memcmp(x.data(), y.data(), x.size() * sizeof(T)) == 0;
}

struct Answers {
  std::vector<dGpuTriMeshClosestPoint> closest;
  std::vector<unsigned char> inside;
  int count = 0;
  bool operator==(const Answers& o) const {
    return count == o.count && inside == o.inside && sameBytes(closest, o.closest);
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

struct Hits {
  std::vector<dGpuTriMeshRayHit> hits;
  int count = 0;
  bool operator==(const Hits& o) const { return count == o.count && sameBytes(hits, o.hits); }
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

scenes::MeshArrays openLump() {
  scenes::MeshArrays open = scenes::makeLump(1, 3, 0.3, 5);
  open.triangles.resize(open.triangles.size() * 3 / 4);
  return open;
}

/// What tests of arrays through the C API need to know of points.
struct Points {
  static constexpr int kLeast = 500;  ///< answers that are no misses
  std::vector<Particle> items = particles(3000);
  static std::vector<scenes::MeshArrays> meshes() {
    scenes::MeshArrays tangled = openLump();
    for (std::size_t t = 0; t < tangled.triangles.size(); t += 3) {
      std::swap(tangled.triangles[t].v[0], tangled.triangles[t].v[1]);
    }
    return {scenes::makeLump(1, 3, 0.3, 5), scenes::makeBox({1, 2, 3}, 2), openLump(), tangled};
  }
  static void pose(dGeomID geom, bool, std::mt19937& random) { setRandomPose(geom, random, 1); }
  std::vector<Answers> answers(dGeomID geom) const { return {ask(geom, items)}; }
  /// An array is its points, one by one. Returns how many are no misses.
  int check(dGeomID geom, const std::vector<Answers>& expected) const {
    for (std::size_t i = 0; i < items.size(); i += 97) {
      dGpuTriMeshClosestPoint one;
      std::memset(static_cast<void*>(&one), 0, sizeof one);
      CHECK(dGeomGpuTriMeshClosestPoint(geom, items[i].x, &one) == dGPUTRIMESH_OK);
      CHECK(std::memcmp(&one, &expected[0].closest[i], sizeof one) == 0);
      CHECK((one.distance < 0) == (expected[0].inside[i] != 0));
    }
    return expected[0].count;
  }
  /// Calls of the device: a shell has no inside to be asked about.
  static unsigned calls(const std::vector<Answers>& expected) { return expected[0].count > 0 ? 2 : 1; }
};

/// What they need to know of rays.
struct Rays {
  static constexpr int kLeast = 2000;
  std::vector<dGpuTriMeshRay> items = rays(3000);
  static std::vector<scenes::MeshArrays> meshes() {
    return {scenes::makeLump(1, 3, 0.3, 5), scenes::makeBox({1, 2, 3}, 2), openLump()};
  }
  static void pose(dGeomID geom, bool plain, std::mt19937& random) {
    if (plain) {
      dRSetIdentity(const_cast<dReal*>(dGeomGetRotation(geom)));  // rays along axes meet edges and corners
      dGeomSetPosition(geom, 0, 0, 0);
    } else {
      setRandomPose(geom, random, 1);
    }
  }
  std::vector<Hits> answers(dGeomID geom) const {
    std::vector<Hits> all;
    for (const int flags : kFlags) all.push_back(cast(geom, items, flags));
    return all;
  }
  int check(dGeomID geom, const std::vector<Hits>& expected) const {
    CHECK(expected[2] == expected[0]);  // any hit: the closest one
    CHECK(expected[3] == expected[1]);
    for (std::size_t i = 0; i < items.size(); i += 97) {
      CHECK((cast(geom, {items[i]}, 0).hits[0].triangle == expected[0].hits[i].triangle));
    }
    return expected[0].count;
  }
  static unsigned calls(const std::vector<Hits>&) { return 4; }
};

int askNothing(dGeomID, dGeomID, int, dReal, dReal) {
  FAIL("the ray callback is asked about rays that are geoms alone");
  return 0;
}

}  // namespace

TEMPLATE_TEST_CASE("arrays about geoms that are posed, scaled and mirrored have the same bytes on a device", "", Points,
                   Rays) {
  const OdeSession session;
  const TestType kind;
  const int index = opencl::defaultDevice(opencl::listDevices());
  std::mt19937 random(8);
  int found = 0;
  for (const scenes::MeshArrays& arrays : TestType::meshes()) {
    const Data data(arrays);
    const Geom geom(data);
    for (const auto& scale : {std::array<double, 3>{1, 1, 1}, {2, 0.5, 1}, {-1, 1, 1.5}}) {
      CHECK(dGeomGpuTriMeshSetScale(geom.id, scale[0], scale[1], scale[2]) == dGPUTRIMESH_OK);
      TestType::pose(geom.id, scale[0] == 1, random);
      CHECK(dGeomGpuTriMeshSetBackend(geom.id, dGPUTRIMESH_BACKEND_CPU) == dGPUTRIMESH_OK);
      const auto expected = kind.answers(geom.id);
      found += kind.check(geom.id, expected);
      REQUIRE(dGpuTriMeshOpenDevices(&index, 1) == 1);
      const std::uint64_t before = deviceCalls();
      CHECK(dGeomGpuTriMeshSetBackend(geom.id, dGPUTRIMESH_BACKEND_OPENCL) == dGPUTRIMESH_OK);
      CHECK((kind.answers(geom.id) == expected));
      CHECK(deviceCalls() == before + TestType::calls(expected));
      CHECK(dGeomGpuTriMeshSetBackend(geom.id, dGPUTRIMESH_BACKEND_AUTO) == dGPUTRIMESH_OK);
      CHECK((kind.answers(geom.id) == expected));
      dGpuTriMeshCloseDevices();
    }
  }
  CHECK(found > TestType::kLeast);
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
