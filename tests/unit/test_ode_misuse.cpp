// SPDX-License-Identifier: BSD-3-Clause
// Misuse is reported: ids that are null or no longer alive, geoms of other classes, data that are changed while a
// collision uses them.
#include <atomic>
#include <cmath>
#include <thread>
#include <vector>

#include "support/catch.h"
#include "support/ode_world.h"

using namespace otg;
using namespace otg::test;

namespace {

int lastError() {
  return dGpuTriMeshGetError();
}

/// Calls every function that takes mesh data, and expects each to refuse it.
void expectRefused(dGpuTriMeshDataID data) {
  const scenes::MeshArrays box = scenes::makeBox({1, 1, 1});
  const auto vertices = static_cast<int>(box.vertices.size()), indices = static_cast<int>(3 * box.triangles.size());
  const std::vector<double> doubles(3 * box.vertices.size(), 0.5);
  const std::vector<dReal> simple(4 * box.vertices.size(), dReal(0.5));
  const std::vector<dTriIndex> wide(3 * box.triangles.size(), 0);
  const int numbers[1] = {0};
  const void *const v = box.vertices.data(), *const t = box.triangles.data();
  constexpr int kRefused = dGPUTRIMESH_ERROR_ARGUMENT;
  CHECK(dGpuTriMeshDataBuildSingle(data, v, 0, vertices, t, indices, 0) == kRefused);
  CHECK(dGpuTriMeshDataBuildSingle1(data, v, 0, vertices, t, indices, 0, nullptr) == kRefused);
  CHECK(dGpuTriMeshDataBuildDouble(data, doubles.data(), 0, vertices, t, indices, 0) == kRefused);
  CHECK(dGpuTriMeshDataBuildDouble1(data, doubles.data(), 0, vertices, t, indices, 0, nullptr) == kRefused);
  CHECK(dGpuTriMeshDataBuildSimple(data, simple.data(), vertices, wide.data(), indices) == kRefused);
  CHECK(dGpuTriMeshDataBuildSimple1(data, simple.data(), vertices, wide.data(), indices, nullptr) == kRefused);
  dGpuTriMeshBuildParams params;
  dGpuTriMeshBuildParamsInit(&params);
  CHECK(dGpuTriMeshDataBuild(data, &params) == kRefused);
  CHECK(dGpuTriMeshDataUpdateVerticesSingle(data, v, 0, vertices) == kRefused);
  CHECK(dGpuTriMeshDataUpdateVerticesDouble(data, doubles.data(), 0, vertices) == kRefused);
  CHECK(dGpuTriMeshDataUpdate(data, simple.data(), vertices) == kRefused);
  CHECK(dGpuTriMeshDataUpdateRangeSingle(data, v, 0, 0, 1) == kRefused);
  CHECK(dGpuTriMeshDataUpdateRangeDouble(data, doubles.data(), 0, 0, 1) == kRefused);
  CHECK(dGpuTriMeshDataUpdateListSingle(data, v, 0, numbers, 1) == kRefused);
  CHECK(dGpuTriMeshDataUpdateListDouble(data, doubles.data(), 0, numbers, 1) == kRefused);
  dGpuTriMeshReport report;
  dGpuTriMeshReportInit(&report);
  CHECK(dGpuTriMeshDataGetReport(data, &report) == kRefused);
  CHECK(dGpuTriMeshDataGetProblemCount(data) == 0);
  dGpuTriMeshProblem problem;
  dGpuTriMeshProblemInit(&problem);
  CHECK(dGpuTriMeshDataGetProblem(data, 0, &problem) == kRefused);
  CHECK(dGpuTriMeshDataGetRepairCount(data) == 0);
  CHECK(dGpuTriMeshDataGetRepair(data, 0) == nullptr);
  CHECK(std::string(dGpuTriMeshDataGetErrorString(data)) != "");
  CHECK(dGpuTriMeshDataPreprocess(data) == 0);
  CHECK(dGpuTriMeshDataPreprocess2(data, 1u << dTRIDATAPREPROCESS_BUILD_CONCAVE_EDGES, nullptr) == 0);
  CHECK(dGpuTriMeshDataSet(data, dTRIMESHDATA_USE_FLAGS, nullptr) == kRefused);
  CHECK(dGpuTriMeshDataGet(data, dTRIMESHDATA_FACE_NORMALS) == nullptr);
  CHECK(dGpuTriMeshDataGet2(data, dTRIMESHDATA_FACE_NORMALS, nullptr) == nullptr);
  dReal angle = 0;
  CHECK(dGpuTriMeshDataGetEdgeAngle(data, 0, 0, &angle) == kRefused);
  unsigned char bytes[8] = {};
  lastError();
  CHECK(dGpuTriMeshDataCook(data, bytes, sizeof bytes) == 0);
  CHECK(lastError() == kRefused);
  CHECK(dGpuTriMeshDataUncook(data, bytes, sizeof bytes) == kRefused);
  CHECK(dGpuTriMeshDataSave(data, "/nowhere") == kRefused);
  CHECK(dGpuTriMeshDataLoad(data, "/nowhere") == kRefused);
  dMass mass;
  CHECK(dMassSetGpuTriMeshData(&mass, 1, data) == kRefused);
  CHECK(dMassSetGpuTriMeshDataTotal(&mass, 1, data) == kRefused);
}

dGpuTriMeshDataID changedInside = nullptr;
std::vector<unsigned char> cookedInside;
/// What every function that changes a mesh said.
std::vector<int> statusInside;
int changeWhileAsked(dGeomID, dGeomID, int) {
  const float place[3] = {5, 5, 5};
  const scenes::MeshArrays box = scenes::makeBox({2, 2, 2});
  const auto vertices = static_cast<int>(box.vertices.size()), indices = static_cast<int>(3 * box.triangles.size());
  const dGpuTriMeshDataID data = changedInside;
  statusInside = {
      dGpuTriMeshDataUpdateRangeSingle(data, place, 0, 0, 1),
      dGpuTriMeshDataUpdateVerticesSingle(data, box.vertices.data(), 0, vertices),
      dGpuTriMeshDataBuildSingle(data, box.vertices.data(), 0, vertices, box.triangles.data(), indices, 0),
      dGpuTriMeshDataUncook(data, cookedInside.data(), cookedInside.size()),
  };
  return 1;
}

}  // namespace

TEST_CASE("null ids of mesh data, and ids that were given back, are refused by every function") {
  const OdeSession session;
  expectRefused(nullptr);
  const dGpuTriMeshDataID gone = dGpuTriMeshDataCreate();
  const Data box(scenes::makeBox({1, 1, 1}));
  const dGeomID keeper = dCreateGpuTriMesh(nullptr, gone);  // the object lives on, so that no other gets its address
  const Geom geom(box);
  dGpuTriMeshDataDestroy(gone);
  expectRefused(gone);
  lastError();
  dGpuTriMeshDataDestroy(gone);  // a second time
  CHECK(lastError() == dGPUTRIMESH_ERROR_ARGUMENT);
  CHECK(dCreateGpuTriMesh(nullptr, gone) == nullptr);
  CHECK(lastError() == dGPUTRIMESH_ERROR_ARGUMENT);
  CHECK(dGeomGpuTriMeshSetData(geom.id, gone) == dGPUTRIMESH_ERROR_ARGUMENT);
  CHECK(dGeomGpuTriMeshGetData(geom.id) == box.id);
  dGeomDestroy(keeper);
  expectRefused(gone);  // freed by now
}

TEST_CASE("geoms of other classes, null geoms and destroyed ones are refused") {
  const OdeSession session;
  const dGeomID sphere = dCreateSphere(nullptr, 1);
  const Data box(scenes::makeBox({1, 1, 1}));
  const Geom geom(box);
  const dGeomID gone = dCreateGpuTriMesh(nullptr, box.id);
  dGeomDestroy(gone);
  for (const dGeomID g : {sphere, static_cast<dGeomID>(nullptr), gone}) {
    constexpr int kRefused = dGPUTRIMESH_ERROR_CLASS;
    dGpuTriMeshParams params;
    dGpuTriMeshParamsInit(&params);
    dGpuTriMeshStats stats;
    dGpuTriMeshStatsInit(&stats);
    dVector3 v = {0, 0, 0, 0};
    dMass mass;
    dContactGeom contact;
    dGpuTriMeshClosestPoint nearest;
    dGpuTriMeshDistance apart;
    CHECK(dGeomGpuTriMeshSetData(g, box.id) == kRefused);
    CHECK(dGeomGpuTriMeshGetData(g) == nullptr);
    if (g != gone) {  // functions that take a dTriMesh as well have to look at the geom
      CHECK(dGeomGpuTriMeshSetParams(g, &params) == kRefused);
      CHECK(dGeomGpuTriMeshGetParams(g, &params) == kRefused);
      CHECK(dGeomGpuTriMeshSetLastTransform(g, nullptr) == kRefused);
      CHECK(dGeomGpuTriMeshGetLastTransform(g) == nullptr);
      CHECK(dGeomGpuTriMeshClearTCCache(g) == kRefused);
      CHECK(dGeomGpuTriMeshForgetHistory(g) == kRefused);
      CHECK(dGeomGpuTriMeshGetStats(g, &stats) == kRefused);
      CHECK(dGeomGpuTriMeshResetStats(g) == kRefused);
      CHECK(dGpuTriMeshOverridePrepare(g) == kRefused);
    }
    CHECK(dGeomGpuTriMeshPrepare(g) == kRefused);
    CHECK(dGeomGpuTriMeshGetTriangleCount(g) == 0);
    CHECK(dGeomGpuTriMeshGetTriangle(g, 0, &v, nullptr, nullptr) == kRefused);
    CHECK(dGeomGpuTriMeshGetPoint(g, 0, 0, 0, v) == kRefused);
    CHECK(dGeomGpuTriMeshSetScale(g, 1, 1, 1) == kRefused);
    CHECK(dGeomGpuTriMeshGetScale(g, v) == kRefused);
    CHECK(dGeomGpuTriMeshEnableTC(g, dSphereClass, 1) == kRefused);
    CHECK(dGeomGpuTriMeshSetCallback(g, nullptr) == kRefused);
    CHECK(dGeomGpuTriMeshSetPairCallback(g, nullptr) == kRefused);
    CHECK(dGeomGpuTriMeshSetBackend(g, dGPUTRIMESH_BACKEND_CPU) == kRefused);
    CHECK(dMassSetGpuTriMesh(&mass, 1, g) == kRefused);
    CHECK(dGpuTriMeshCollideEx(g, geom.id, 1, &contact, sizeof contact, nullptr, 0) == kRefused);
    CHECK(dGeomGpuTriMeshClosestPoint(g, v, &nearest) == kRefused);
    CHECK(dGpuTriMeshGetDistance(g, geom.id, 1, &apart) == kRefused);
    CHECK(dGpuTriMeshOverlap(g, geom.id) == kRefused);
    const dGpuTriMeshPair pair{geom.id, g};
    int count = 0;
    unsigned char answer = 0;
    const dGpuTriMeshRay ray{{0, 0, 0, 0}, {0, 0, 1, 0}, 1};
    dGpuTriMeshRayHit hit;
    CHECK(dGpuTriMeshCollidePairs(&pair, 1, 1, &contact, sizeof contact, &count) == kRefused);
    CHECK(dGpuTriMeshBatchSubmit(&pair, 1, 1) == nullptr);
    CHECK(dGpuTriMeshOverlaps(&pair, 1, &answer) == kRefused);
    CHECK(dGeomGpuTriMeshPointsInside(g, v, sizeof v, 1, &answer) == kRefused);
    CHECK(dGeomGpuTriMeshCastRays(g, &ray, 1, 0, &hit) == kRefused);
  }
  dGeomDestroy(sphere);
}

TEST_CASE("a callback cannot change the mesh of the collision that asks it") {
  const OdeSession session;
  const Data box(scenes::makeBox({1, 1, 1})), other(scenes::makeBox({1, 1, 1}));
  const Geom a(box), b(other);
  dGeomSetPosition(b.id, 0.1, 0.2, 0.9);
  const std::vector<int> allBusy(4, dGPUTRIMESH_ERROR_BUSY);
  changedInside = box.id;
  cookedInside.resize(dGpuTriMeshDataCook(other.id, nullptr, 0));
  REQUIRE(dGpuTriMeshDataCook(other.id, cookedInside.data(), cookedInside.size()) == cookedInside.size());
  REQUIRE(dGeomGpuTriMeshSetCallback(a.id, &changeWhileAsked) == dGPUTRIMESH_OK);
  CHECK(!test::collide(a.id, b.id).empty());
  CHECK(statusInside == allBusy);
  const dGeomID ball = dCreateSphere(nullptr, 0.5);
  dGeomSetPosition(ball, 0, 0, 0.9);
  statusInside.clear();
  CHECK(!test::collide(a.id, ball).empty());
  CHECK(statusInside == allBusy);
  dGeomDestroy(ball);
  const float place[3] = {-0.5f, -0.5f, -0.51f};
  CHECK(dGpuTriMeshDataUpdateRangeSingle(box.id, place, 0, 0, 1) == dGPUTRIMESH_OK);  // afterwards it can
}

TEST_CASE(
    "a mesh that one thread changes while another collides it: one of the two gets an error, and nothing breaks") {
  const OdeSession session;
  scenes::MeshArrays lump = scenes::makeLump(0.5, 4, 0.2, 4);
  const Data ground(scenes::makeGround(6, 1, 12)), body(lump);
  const Geom floor(ground), geom(body);
  dGeomSetPosition(geom.id, 0.1, 0.2, 0.4);
  const dGeomID ball = dCreateSphere(nullptr, 0.3);  // of ODE's own
  dGeomSetPosition(ball, 0.1, 0.2, 0.9);
  dReal aabb[6];
  for (const dGeomID g : {floor.id, geom.id, ball}) dGeomGetAABB(g, aabb);
  std::atomic<bool> done{false};
  std::atomic<int> busy{0}, changed{0}, refused{0}, bad{0};
  std::thread changer([&] {
    for (int i = 0; i < 300; ++i) {
      for (Vec3f& v : lump.vertices) v.z *= i % 2 == 0 ? 1.001f : 1 / 1.001f;
      const int status =
          dGpuTriMeshDataUpdateVerticesSingle(body.id, lump.vertices.data(), 0, static_cast<int>(lump.vertices.size()));
      ++(status == dGPUTRIMESH_OK ? changed : status == dGPUTRIMESH_ERROR_BUSY ? busy : bad);
    }
    done = true;
  });
  int rounds = 0;
  dGpuTriMeshGetError();
  while (!done || rounds < 10) {
    ++rounds;
    for (const dGeomID other : {floor.id, ball}) {
      const auto contacts = test::collide(other, geom.id);
      const int error = dGpuTriMeshGetError();
      if (error == dGPUTRIMESH_ERROR_BUSY) ++refused;
      if (contacts.empty() != (error == dGPUTRIMESH_ERROR_BUSY)) ++bad;
    }
  }
  changer.join();
  INFO(busy << " updates and " << refused << " collisions were refused");
  CHECK(bad == 0);
  CHECK(changed + busy == 300);
  CHECK(!test::collide(floor.id, geom.id).empty());
  CHECK(!test::collide(ball, geom.id).empty());
  dGeomDestroy(ball);
}

namespace {

dGeomID changedGeom = nullptr;
dGpuTriMeshDataID otherData = nullptr;
/// What functions that change a geom said, and then those that only read.
std::vector<int> geomStatus, readStatus;
int changeGeomWhileAsked(dGeomID, dGeomID, int) {
  geomStatus = {dGeomGpuTriMeshSetData(changedGeom, otherData), dGeomGpuTriMeshSetData(changedGeom, nullptr),
                dGeomGpuTriMeshSetScale(changedGeom, 2, 2, 2)};
  dVector3 point = {0, 0, 0.2, 0};
  dGpuTriMeshClosestPoint nearest;
  dMass mass;
  dVector3 corner;
  readStatus = {dGeomGpuTriMeshClosestPoint(changedGeom, point, &nearest), dMassSetGpuTriMesh(&mass, 1, changedGeom),
                dGeomGpuTriMeshGetTriangle(changedGeom, 0, &corner, nullptr, nullptr)};
  return 1;
}

bool destroyed = false;
int destroyWhileAsked(dGeomID, dGeomID, int) {
  if (!destroyed) dGeomDestroy(changedGeom);
  destroyed = true;
  return 1;
}

}  // namespace

TEST_CASE("a callback can neither give the geom that is collided other data nor scale it, but may read it") {
  const OdeSession session;
  const Data box(scenes::makeBox({1, 1, 1})), small(scenes::makeBox({0.5f, 0.5f, 0.5f}));
  const Geom a(box), b(box);
  dGeomSetPosition(b.id, 0.1, 0.2, 0.9);
  const auto plain = test::collide(a.id, b.id);
  const dGeomID ball = dCreateSphere(nullptr, 0.5);
  dGeomSetPosition(ball, 0, 0, 0.9);
  otherData = small.id;
  for (const dGeomID changed : {a.id, b.id}) {
    changedGeom = changed;
    REQUIRE(dGeomGpuTriMeshSetCallback(changed, &changeGeomWhileAsked) == dGPUTRIMESH_OK);
    for (const dGeomID other : {changed == a.id ? b.id : a.id, ball}) {
      geomStatus.clear();
      const auto contacts = test::collide(changed, other);
      if (other != ball) CHECK(contacts.size() == plain.size());
      CHECK(geomStatus == std::vector<int>(3, dGPUTRIMESH_ERROR_BUSY));
      CHECK(readStatus == std::vector<int>(3, dGPUTRIMESH_OK));
    }
    REQUIRE(dGeomGpuTriMeshSetCallback(changed, nullptr) == dGPUTRIMESH_OK);
    CHECK(dGeomGpuTriMeshGetData(changed) == box.id);
    CHECK(dGeomGpuTriMeshSetScale(changed, 1, 1, 1) == dGPUTRIMESH_OK);  // afterwards it can
  }
  CHECK(dGeomGpuTriMeshSetData(b.id, small.id) == dGPUTRIMESH_OK);
  dGeomDestroy(ball);
}

TEST_CASE("a geom that a callback destroys is gone after the query, which gets an error, and its data with it") {
  const OdeSession session;
  const Data box(scenes::makeBox({1, 1, 1}));
  const Geom a(box);
  for (const bool keepsHandle : {true, false}) {
    const dGpuTriMeshDataID data = dGpuTriMeshDataCreate();
    const scenes::MeshArrays lump = scenes::makeLump(0.5, 3, 0.2, 4);
    REQUIRE(dGpuTriMeshDataBuildSingle(data, lump.vertices.data(), 0, static_cast<int>(lump.vertices.size()),
                                       lump.triangles.data(), static_cast<int>(3 * lump.triangles.size()),
                                       0) == dGPUTRIMESH_OK);
    changedGeom = dCreateGpuTriMesh(nullptr, data);
    if (!keepsHandle) dGpuTriMeshDataDestroy(data);  // the geom's is the last use
    dGeomSetPosition(changedGeom, 0, 0, 0.9);
    destroyed = false;
    REQUIRE(dGeomGpuTriMeshSetCallback(a.id, &destroyWhileAsked) == dGPUTRIMESH_OK);
    dGpuTriMeshGetError();
    dContactGeom contacts[8];
    dCollide(a.id, changedGeom, 8, contacts, sizeof(dContactGeom));
    CHECK(destroyed);
    CHECK(lastError() == dGPUTRIMESH_ERROR_BUSY);
    CHECK(dGeomGpuTriMeshGetData(changedGeom) == nullptr);
    REQUIRE(dGeomGpuTriMeshSetCallback(a.id, nullptr) == dGPUTRIMESH_OK);
    if (keepsHandle) {
      CHECK(dGpuTriMeshDataUpdateVerticesSingle(data, lump.vertices.data(), 0,
                                                static_cast<int>(lump.vertices.size())) == dGPUTRIMESH_OK);
      dGpuTriMeshDataDestroy(data);
    }
  }
}

TEST_CASE(
    "queries of every kind and changes of the mesh, the data and the scale in two threads: one of the two gets an "
    "error") {
  const OdeSession session;
  scenes::MeshArrays lump = scenes::makeLump(0.5, 4, 0.2, 4);
  const Data ground(scenes::makeGround(6, 1, 12)), body(lump), spare(scenes::makeLump(0.5, 3, 0.2, 5));
  const Geom floor(ground), geom(body);
  dGeomSetPosition(geom.id, 0.1, 0.2, 0.4);
  dReal aabb[6];
  for (const dGeomID g : {floor.id, geom.id}) dGeomGetAABB(g, aabb);
  std::atomic<bool> done{false};
  std::atomic<int> changed{0}, refusals{0}, bad{0};
  const auto countChange = [&](int status) {
    ++(status == dGPUTRIMESH_OK ? changed : status == dGPUTRIMESH_ERROR_BUSY ? refusals : bad);
  };
  std::thread changer([&] {
    const auto vertices = static_cast<int>(lump.vertices.size());
    for (int i = 0; i < 60; ++i) {
      for (Vec3f& v : lump.vertices) v.z *= i % 2 == 0 ? 1.001f : 1 / 1.001f;
      countChange(dGpuTriMeshDataUpdateVerticesSingle(body.id, lump.vertices.data(), 0, vertices));
      countChange(dGpuTriMeshDataUpdateRangeSingle(body.id, lump.vertices.data(), 0, 0, 3));
      countChange(dGeomGpuTriMeshSetData(geom.id, i % 2 == 0 ? spare.id : body.id));
      countChange(dGeomGpuTriMeshSetScale(geom.id, 1, 1, i % 3 == 0 ? 1.5 : 1));
    }
    done = true;
  });
  const dGpuTriMeshPair pair{floor.id, geom.id};
  const dReal points[8] = {0, 0, 0.3, 0, 0.2, 0.1, 5, 0};
  const dGpuTriMeshRay ray{{0.1, 0.2, 5, 0}, {0, 0, -1, 0}, 10};
  std::atomic<int> answered{0}, refused{0};
  const auto count = [&](int status) { ++(status >= 0 ? answered : status == dGPUTRIMESH_ERROR_BUSY ? refused : bad); };
  for (int rounds = 0; !done || rounds < 10; ++rounds) {
    dGpuTriMeshClosestPoint nearest[2];
    unsigned char inside[2], overlaps = 0;
    dGpuTriMeshDistance apart;
    dGpuTriMeshRayHit hit;
    dMass mass;
    dVector3 corner;
    dContactGeom contacts[16];
    int contactCount = 0;
    count(dGeomGpuTriMeshClosestPoints(geom.id, points, 4 * sizeof(dReal), 2, nearest));
    count(dGeomGpuTriMeshPointsInside(geom.id, points, 4 * sizeof(dReal), 2, inside));
    count(dGpuTriMeshGetDistance(floor.id, geom.id, 1, &apart));
    count(dGpuTriMeshOverlaps(&pair, 1, &overlaps));
    count(dGeomGpuTriMeshCastRays(geom.id, &ray, 1, 0, &hit));
    count(dMassSetGpuTriMesh(&mass, 1, geom.id));
    count(dMassSetGpuTriMeshData(&mass, 1, body.id));
    count(dGeomGpuTriMeshGetTriangle(geom.id, 7, &corner, nullptr, nullptr));
    dGpuTriMeshGetError();
    count(dGpuTriMeshDataCook(body.id, nullptr, 0) > 0 ? 0 : dGpuTriMeshGetError());
    count(dGpuTriMeshCollidePairs(&pair, 1, 16, contacts, sizeof(dContactGeom), &contactCount) > 0 ? 0
          : dGpuTriMeshGetError() == dGPUTRIMESH_ERROR_BUSY ? dGPUTRIMESH_ERROR_BUSY
                                                            : dGPUTRIMESH_ERROR_ARGUMENT);
    count(dCollide(floor.id, geom.id, 16, contacts, sizeof(dContactGeom)) > 0 ? 0
          : dGpuTriMeshGetError() == dGPUTRIMESH_ERROR_BUSY                   ? dGPUTRIMESH_ERROR_BUSY
                                                                              : dGPUTRIMESH_ERROR_ARGUMENT);
  }
  changer.join();
  INFO(answered << " answered, " << refused << " refused; " << changed << " changed, " << refusals << " refused");
  CHECK(bad == 0);
  CHECK(answered > 0);
  CHECK(changed + refusals == 240);
}
