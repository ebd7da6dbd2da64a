// SPDX-License-Identifier: BSD-3-Clause
// ODE's dTriMesh with ODE's other geoms through this library: the same contacts as a geom of our class, with the
// callbacks and data of the dTriMesh, and from many threads at once.
#include <algorithm>
#include <atomic>
#include <cmath>
#include <thread>

#include "support/catch.h"
#include "support/ode_world.h"

using namespace otg;
using namespace otg::test;

namespace {

/// A dTriMesh and a geom of our class with the same triangles at the same place.
struct Twins {
  scenes::MeshArrays arrays;
  Data data;
  Geom mesh;
  dTriMeshDataID odeData = dGeomTriMeshDataCreate();
  dGeomID native;
  explicit Twins(const scenes::MeshArrays& from) : arrays(from), data(from), mesh(data) {
    dGeomTriMeshDataBuildSingle(odeData, arrays.vertices.data(), sizeof(Vec3f),
                                static_cast<int>(arrays.vertices.size()), arrays.triangles.data(),
                                static_cast<int>(3 * arrays.triangles.size()), sizeof(Triangle));
    native = dCreateTriMesh(nullptr, odeData, nullptr, nullptr, nullptr);
  }
  ~Twins() {
    dGpuTriMeshOverrideForgetGeom(native);
    dGpuTriMeshOverrideForgetData(odeData);
    dGeomDestroy(native);
    dGeomTriMeshDataDestroy(odeData);
  }
  Twins(const Twins&) = delete;
  Twins& operator=(const Twins&) = delete;
  void forget() const {
    dGeomGpuTriMeshForgetHistory(mesh.id);
    dGpuTriMeshOverrideForgetGeom(native);
  }
};

/// ODE's own geoms, each a little in reach of a ground at z = 0.
struct Others {
  std::vector<dGeomID> geoms{dCreateSphere(nullptr, 0.3),          dCreateBox(nullptr, 0.5, 0.4, 0.6),
                             dCreateCapsule(nullptr, 0.2, 0.5),    dCreateCylinder(nullptr, 0.3, 0.5),
                             dCreatePlane(nullptr, 0, 0, 1, 0.05), dCreateRay(nullptr, 3)};
  std::vector<int> classes{dSphereClass, dBoxClass, dCapsuleClass, dCylinderClass, dPlaneClass, dRayClass};
  float heights[4] = {0.3f, 0.3f, 0.3f, 0.3f};
  dHeightfieldDataID field = dGeomHeightfieldDataCreate();
  Others() {
    REQUIRE(dGpuTriMeshHeightfieldDataBuildSingle(field, heights, 0, 8, 8, 2, 2, 1, 0, 1, 0) == dGPUTRIMESH_OK);
    geoms.push_back(dCreateHeightfield(nullptr, field, 1));
    classes.push_back(dHeightfieldClass);
  }
  ~Others() {
    for (const dGeomID g : geoms) dGeomDestroy(g);
    dGpuTriMeshHeightfieldDataDestroy(field);
  }
  Others(const Others&) = delete;
  Others& operator=(const Others&) = delete;
  void scatter(std::mt19937& random) const {
    for (std::size_t i = 0; i < geoms.size(); ++i) {
      if (classes[i] == dPlaneClass) continue;
      setRandomPose(geoms[i], random, 0.3);
      if (classes[i] != dRayClass) continue;
      dGeomRaySet(geoms[i], dGeomGetPosition(geoms[i])[0], dGeomGetPosition(geoms[i])[1], 1, 0.1, 0.2, -1);
    }
  }
};

/// But for the mesh geom, which is another one.
bool sameButMesh(std::vector<dContactGeom> a, const std::vector<dContactGeom>& b) {
  if (a.size() != b.size()) return false;
  for (std::size_t i = 0; i < a.size(); ++i) {
    if (a[i].g2 != b[i].g2) return false;
    a[i].g1 = b[i].g1;
  }
  return sameContacts(a, b);
}

/// Callbacks run in many threads.
std::atomic<int> askedTimes{0};
int askOdd(dGeomID, dGeomID, int triangle) {
  ++askedTimes;
  return triangle % 2;
}
int askNone(dGeomID, dGeomID, int) {
  return 0;
}
int passRay(dGeomID, dGeomID, int, dReal, dReal) {
  return 0;
}

}  // namespace

TEST_CASE("pairs with other classes are taken over one class at a time, or all at once") {
  CHECK(dGpuTriMeshOverrideTriMeshWith(dBoxClass) == dGPUTRIMESH_ERROR_ODE);
  for (const bool all : {false, true}) {
    const OdeSession session;
    for (const int bad : {-2, int{dGeomTransformClass}, int{dSimpleSpaceClass}, dGpuTriMeshGetClass(), 99}) {
      CHECK(dGpuTriMeshOverrideTriMeshWith(bad) == dGPUTRIMESH_ERROR_ARGUMENT);
    }
    const Twins twins(scenes::makeGround(4, 0.5, 16, [](double x, double y) { return 0.05 * std::sin(3 * x + y); }));
    const Others others;
    std::mt19937 random(4);
    others.scatter(random);
    if (all) REQUIRE(dGpuTriMeshOverrideTriMeshWith(dGPUTRIMESH_OVERRIDE_ALL) == dGPUTRIMESH_OK);
    for (std::size_t i = 0; i < others.geoms.size(); ++i) {
      if (!all) {
        dGpuTriMeshOverrideStats before, after;
        dGpuTriMeshOverrideStatsInit(&before);
        dGpuTriMeshOverrideStatsInit(&after);
        REQUIRE(dGpuTriMeshOverrideGetStats(&before) == dGPUTRIMESH_OK);
        test::collide(twins.native, others.geoms[i]);  // ODE's own still
        REQUIRE(dGpuTriMeshOverrideGetStats(&after) == dGPUTRIMESH_OK);
        CHECK(after.queries == before.queries);
        REQUIRE(dGpuTriMeshOverrideTriMeshWith(others.classes[i]) == dGPUTRIMESH_OK);
        const auto contacts = test::collide(twins.native, others.geoms[i]);
        REQUIRE(dGpuTriMeshOverrideGetStats(&after) == dGPUTRIMESH_OK);
        CHECK(after.queries == before.queries + 1);
        CHECK(after.contacts == before.contacts + contacts.size());
      }
      int touching = 0;
      for (int k = 0; k < 30; ++k) {
        INFO("class " << others.classes[i] << " pose " << k);
        others.scatter(random);
        twins.forget();
        const auto wanted = test::collide(twins.mesh.id, others.geoms[i]);
        const auto found = test::collide(twins.native, others.geoms[i]);
        REQUIRE(sameButMesh(found, wanted));
        REQUIRE(sameContacts(mirrored(test::collide(others.geoms[i], twins.native)), found));
        touching += !found.empty();
      }
      CHECK(touching > 10);
    }
  }
}

TEST_CASE("callbacks of the dTriMesh are asked, and changes of its vertices are noticed") {
  const OdeSession session;
  REQUIRE(dGpuTriMeshOverrideTriMeshWith(dGPUTRIMESH_OVERRIDE_ALL) == dGPUTRIMESH_OK);
  Twins twins(scenes::makeBox({2, 2, 1}));
  const dGeomID ball = dCreateSphere(nullptr, 0.5), ray = dCreateRay(nullptr, 5);
  dGeomSetPosition(ball, 0.3, 0.1, 0.9);
  dGeomRaySet(ray, 0.3, 0.1, 3, 0, 0, -1);
  REQUIRE(test::collide(twins.native, ball).size() == 1);
  REQUIRE(!test::collide(twins.native, ray).empty());
  dGeomTriMeshSetCallback(twins.native, &askNone);
  CHECK(test::collide(twins.native, ball).empty());
  CHECK(test::collide(twins.native, ray).empty());
  dGeomTriMeshSetCallback(twins.native, nullptr);
  dGeomTriMeshSetRayCallback(twins.native, &passRay);
  CHECK(test::collide(twins.native, ball).size() == 1);
  CHECK(test::collide(twins.native, ray).empty());
  for (Vec3f& v : twins.arrays.vertices) v.z *= 1.1f;
  dGeomTriMeshDataUpdate(twins.odeData);
  const auto raised = test::collide(twins.native, ball);
  REQUIRE(raised.size() == 1);
  CHECK(raised[0].depth == Approx(0.15).margin(1e-6));
  dGeomDestroy(ball);
  dGeomDestroy(ray);
}

TEST_CASE("many threads collide one dTriMesh and one mesh, with callbacks and heightfields, as a single one does") {
  const OdeSession session;
  REQUIRE(dGpuTriMeshOverrideTriMeshWith(dGPUTRIMESH_OVERRIDE_ALL) == dGPUTRIMESH_OK);
  const Twins twins(scenes::makeGround(4, 0.5, 16, [](double x, double y) { return 0.05 * std::sin(3 * x + y); }));
  dGeomTriMeshSetCallback(twins.native, &askOdd);
  dGeomGpuTriMeshSetCallback(twins.mesh.id, &askOdd);
  // Without history a query depends on the moment alone, whatever other threads ask.
  dGpuTriMeshParams params;
  dGpuTriMeshParamsInit(&params);
  params.history = dGPUTRIMESH_HISTORY_OFF;
  REQUIRE(dGeomGpuTriMeshSetParams(twins.mesh.id, &params) == dGPUTRIMESH_OK);
  REQUIRE(dGeomGpuTriMeshSetParams(twins.native, &params) == dGPUTRIMESH_OK);
  const Others others;
  std::mt19937 random(9);
  others.scatter(random);
  std::vector<std::pair<dGeomID, dGeomID>> pairs;
  for (const dGeomID other : others.geoms) {
    for (const dGeomID mesh : {twins.mesh.id, twins.native}) {
      pairs.emplace_back(mesh, other);
      pairs.emplace_back(other, mesh);
    }
  }
  pairs.emplace_back(twins.native, twins.mesh.id);
  std::vector<std::vector<dContactGeom>> wanted;
  for (const auto& [a, b] : pairs) wanted.push_back(test::collide(a, b));
  std::atomic<int> wrong{0};
  std::vector<std::thread> threads;
  for (std::size_t t = 0; t < 4; ++t) {
    threads.emplace_back([&, t] {
      for (int round = 0; round < 5; ++round) {
        if (t == 0) dGpuTriMeshOverrideDataChanged(twins.odeData);  // read again, while others have it
        for (std::size_t k = 0; k < pairs.size(); ++k) {
          const std::size_t i = (k * (2 * t + 1) + t) % pairs.size();
          if (!sameContacts(test::collide(pairs[i].first, pairs[i].second), wanted[i])) ++wrong;
        }
      }
      dGpuTriMeshClose();
    });
  }
  for (std::thread& thread : threads) thread.join();
  CHECK(wrong == 0);
  CHECK(askedTimes > 100);
}
