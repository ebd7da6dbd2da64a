// SPDX-License-Identifier: BSD-3-Clause
// Mesh data through the C API: all Build functions, arguments, reports, repairs, updates, ownership, mass.
#include <cmath>
#include <cstring>
#include <limits>

#include "ode_trimesh_gpu/ode_trimesh_gpu.hpp"
#include "support/catch.h"
#include "support/ode_world.h"

using namespace otg;
using namespace otg::test;

namespace {

dGpuTriMeshReport reportOf(dGpuTriMeshDataID id) {
  dGpuTriMeshReport report;
  dGpuTriMeshReportInit(&report);
  CHECK(dGpuTriMeshDataGetReport(id, &report) == dGPUTRIMESH_OK);
  return report;
}

int build(dGpuTriMeshDataID id, const scenes::MeshArrays& mesh, int repair = dGPUTRIMESH_REPAIR_NONE,
          int tree = dGPUTRIMESH_TREE_SAH) {
  dGpuTriMeshBuildParams params;
  dGpuTriMeshBuildParamsInit(&params);
  params.vertices = mesh.vertices.data();
  params.vertex_count = static_cast<int>(mesh.vertices.size());
  params.indices = mesh.triangles.data();
  params.index_count = static_cast<int>(3 * mesh.triangles.size());
  params.repair = repair;
  params.tree = tree;
  return dGpuTriMeshDataBuild(id, &params);
}

bool hasProblem(dGpuTriMeshDataID id, int kind, int count) {
  for (int i = 0; i < dGpuTriMeshDataGetProblemCount(id); ++i) {
    dGpuTriMeshProblem problem;
    dGpuTriMeshProblemInit(&problem);
    CHECK(dGpuTriMeshDataGetProblem(id, i, &problem) == dGPUTRIMESH_OK);
    CHECK(std::strlen(problem.message) > 0);
    CHECK(problem.element_count <= problem.count);
    if (problem.kind == kind && problem.count == count) return true;
  }
  return false;
}

bool near(double a, double b, double tolerance) {
  return std::abs(a - b) <= tolerance;
}

bool sameMass(const dMass& a, const dMass& b, double tolerance) {
  bool same = near(a.mass, b.mass, tolerance);
  for (int i = 0; i < 3; ++i) same = same && near(a.c[i], b.c[i], tolerance);
  for (int i = 0; i < 12; ++i) same = same && (i % 4 == 3 || near(a.I[i], b.I[i], tolerance));
  return same;
}

}  // namespace

TEST_CASE("every Build function makes the same mesh from its kind of array, and keeps nothing of it") {
  const OdeSession session;
  const scenes::MeshArrays torus = scenes::makeTorus(1, 0.3, 12, 8);
  const int vertexCount = static_cast<int>(torus.vertices.size());
  const int indexCount = static_cast<int>(3 * torus.triangles.size());
  // Arrays with something between the elements, in an order of its own for each kind.
  struct StridedVertex {
    char before[4];
    float p[3];
    char after[5];
  };
  struct StridedTriangle {
    std::uint32_t v[3];
    float user[2];
  };
  std::vector<StridedVertex> strided(torus.vertices.size());
  std::vector<StridedTriangle> stridedTriangles(torus.triangles.size());
  std::vector<double> doubles;
  std::vector<dReal> simple;
  std::vector<dTriIndex> indices;
  for (std::size_t i = 0; i < torus.vertices.size(); ++i) {
    const Vec3f v = torus.vertices[i];
    strided[i] = {{1, 2, 3, 4}, {v.x, v.y, v.z}, {5, 6, 7, 8, 9}};
    doubles.insert(doubles.end(), {v.x, v.y, v.z});
    simple.insert(simple.end(), {v.x, v.y, v.z, std::numeric_limits<dReal>::quiet_NaN()});
  }
  for (std::size_t i = 0; i < torus.triangles.size(); ++i) {
    const std::uint32_t* const v = torus.triangles[i].v;
    stridedTriangles[i] = {{v[0], v[1], v[2]}, {1e30f, -1}};
    indices.insert(indices.end(), {v[0], v[1], v[2]});
  }
  dGpuTriMeshDataID ids[7];
  for (dGpuTriMeshDataID& id : ids) id = dGpuTriMeshDataCreate();
  CHECK(dGpuTriMeshDataBuildSingle(ids[0], strided[0].p, sizeof(StridedVertex), vertexCount, stridedTriangles.data(),
                                   indexCount, sizeof(StridedTriangle)) == dGPUTRIMESH_OK);
  CHECK(dGpuTriMeshDataBuildSingle1(ids[1], torus.vertices.data(), 0, vertexCount, torus.triangles.data(), indexCount,
                                    0, nullptr) == dGPUTRIMESH_OK);
  CHECK(dGpuTriMeshDataBuildDouble(ids[2], doubles.data(), 24, vertexCount, indices.data(), indexCount, 12) ==
        dGPUTRIMESH_OK);
  CHECK(dGpuTriMeshDataBuildDouble1(ids[3], doubles.data(), 24, vertexCount, indices.data(), indexCount, 12,
                                    doubles.data()) == dGPUTRIMESH_OK);
  CHECK(dGpuTriMeshDataBuildSimple(ids[4], simple.data(), vertexCount, indices.data(), indexCount) == dGPUTRIMESH_OK);
  CHECK(dGpuTriMeshDataBuildSimple1(ids[5], simple.data(), vertexCount, indices.data(), indexCount, nullptr) ==
        dGPUTRIMESH_OK);
  CHECK(build(ids[6], torus, dGPUTRIMESH_REPAIR_NONE, dGPUTRIMESH_TREE_MEAN_SPLIT) == dGPUTRIMESH_OK);
  // The arrays may go away: overwritten, they must not show.
  for (StridedVertex& v : strided) v.p[0] = v.p[1] = v.p[2] = 77;
  for (StridedTriangle& t : stridedTriangles) t.v[0] = t.v[1] = t.v[2] = 0;
  std::fill(doubles.begin(), doubles.end(), 77);
  std::fill(simple.begin(), simple.end(), dReal(77));
  std::fill(indices.begin(), indices.end(), 0u);
  for (const dGpuTriMeshDataID id : ids) {
    const dGpuTriMeshReport report = reportOf(id);
    CHECK(report.solid == 1);
    CHECK(report.valid == 1);
    CHECK(report.edges == 3 * report.triangles / 2);
    const dGeomID geom = dCreateGpuTriMesh(nullptr, id);
    REQUIRE(dGeomGpuTriMeshGetTriangleCount(geom) == static_cast<int>(torus.triangles.size()));
    bool same = true;
    for (std::size_t t = 0; t < torus.triangles.size(); ++t) {
      dVector3 v[3];
      CHECK(dGeomGpuTriMeshGetTriangle(geom, static_cast<int>(t), &v[0], &v[1], &v[2]) == dGPUTRIMESH_OK);
      for (int k = 0; k < 3; ++k) {
        const Vec3f& expected = torus.vertices[torus.triangles[t].v[k]];
        same = same && v[k][0] == expected.x && v[k][1] == expected.y && v[k][2] == expected.z && v[k][3] == 0;
      }
    }
    CHECK(same);
    dGeomDestroy(geom);
    dGpuTriMeshDataDestroy(id);
  }
}

TEST_CASE("bad arguments are refused and change nothing") {
  const scenes::MeshArrays box = scenes::makeBox({1, 1, 1});
  const Data data(box);
  const void* const v = box.vertices.data();
  const void* const t = box.triangles.data();
  CHECK(dGpuTriMeshDataBuildSingle(nullptr, v, 12, 8, t, 36, 12) == dGPUTRIMESH_ERROR_ARGUMENT);
  CHECK(dGpuTriMeshDataBuildSingle(data.id, v, 12, -1, t, 36, 12) == dGPUTRIMESH_ERROR_ARGUMENT);
  CHECK(dGpuTriMeshDataBuildSingle(data.id, v, 12, 8, t, -3, 12) == dGPUTRIMESH_ERROR_ARGUMENT);
  CHECK(dGpuTriMeshDataBuildSingle(data.id, v, 12, 8, t, 35, 12) == dGPUTRIMESH_ERROR_ARGUMENT);
  CHECK(dGpuTriMeshDataBuildSingle(data.id, v, -12, 8, t, 36, 12) == dGPUTRIMESH_ERROR_ARGUMENT);
  CHECK(dGpuTriMeshDataBuildSingle(data.id, v, 8, 8, t, 36, 12) == dGPUTRIMESH_ERROR_ARGUMENT);
  CHECK(dGpuTriMeshDataBuildSingle(data.id, v, 12, 8, t, 36, 8) == dGPUTRIMESH_ERROR_ARGUMENT);
  CHECK(dGpuTriMeshDataBuildDouble(data.id, v, 12, 8, t, 36, 12) == dGPUTRIMESH_ERROR_ARGUMENT);
  CHECK(dGpuTriMeshDataBuild(data.id, nullptr) == dGPUTRIMESH_ERROR_ARGUMENT);
  CHECK(build(data.id, box, 16) == dGPUTRIMESH_ERROR_ARGUMENT);
  CHECK(build(data.id, box, 0, 2) == dGPUTRIMESH_ERROR_ARGUMENT);
  dGpuTriMeshBuildParams params;
  dGpuTriMeshBuildParamsInit(&params);
  params.size -= 1;
  CHECK(dGpuTriMeshDataBuild(data.id, &params) == dGPUTRIMESH_ERROR_ARGUMENT);
  dGpuTriMeshReport report;
  dGpuTriMeshReportInit(&report);
  report.size = 0;
  CHECK(dGpuTriMeshDataGetReport(data.id, &report) == dGPUTRIMESH_ERROR_ARGUMENT);
  CHECK(dGpuTriMeshDataGetReport(data.id, nullptr) == dGPUTRIMESH_ERROR_ARGUMENT);
  dGpuTriMeshProblem problem;
  dGpuTriMeshProblemInit(&problem);
  CHECK(dGpuTriMeshDataGetProblem(data.id, 0, &problem) == dGPUTRIMESH_ERROR_ARGUMENT);
  CHECK(dGpuTriMeshDataGetProblem(data.id, -1, &problem) == dGPUTRIMESH_ERROR_ARGUMENT);
  CHECK(dGpuTriMeshDataGetRepair(data.id, 0) == nullptr);
  CHECK(dGpuTriMeshDataGetProblemCount(nullptr) == 0);
  CHECK(reportOf(data.id).triangles == 12);
  CHECK(std::string(dGpuTriMeshDataGetErrorString(data.id)).empty());
  dGpuTriMeshDataDestroy(nullptr);
  dGpuTriMeshReportInit(nullptr);
  dGpuTriMeshParamsInit(nullptr);
}

TEST_CASE("a mesh that can't be worked with is refused with its reason, and the mesh before it stays") {
  const OdeSession session;
  scenes::MeshArrays box = scenes::makeBox({1, 1, 1});
  const Data data(box);
  const Geom geom(data);
  const auto refused = [&](int kind, int count) {
    CHECK(build(data.id, box) == dGPUTRIMESH_ERROR_MESH);
    CHECK(reportOf(data.id).accepted == 0);
    CHECK(hasProblem(data.id, kind, count));
    CHECK(std::strlen(dGpuTriMeshDataGetErrorString(data.id)) > 0);
    CHECK(dGeomGpuTriMeshGetTriangleCount(geom.id) == 12);
    box = scenes::makeBox({1, 1, 1});
  };
  box.triangles[3].v[1] = static_cast<std::uint32_t>(box.vertices.size());
  refused(dGPUTRIMESH_PROBLEM_INDEX_OUT_OF_RANGE, 1);
  box.vertices[2].y = std::numeric_limits<float>::quiet_NaN();
  box.vertices[5].x = std::numeric_limits<float>::infinity();
  refused(dGPUTRIMESH_PROBLEM_NONFINITE_VERTEX, 2);
  CHECK(dGpuTriMeshDataBuildSingle(data.id, nullptr, 12, 8, box.triangles.data(), 36, 12) == dGPUTRIMESH_ERROR_MESH);
  CHECK(hasProblem(data.id, dGPUTRIMESH_PROBLEM_NULL_ARRAY, 1));
  CHECK(build(data.id, box) == dGPUTRIMESH_OK);
  CHECK(reportOf(data.id).accepted == 1);
  CHECK(std::string(dGpuTriMeshDataGetErrorString(data.id)).empty());
}

TEST_CASE("reports name problems; repairs on request say what they did") {
  scenes::MeshArrays box = scenes::makeBox({1, 1, 1});
  std::swap(box.triangles[4].v[0], box.triangles[4].v[1]);
  box.triangles.push_back(box.triangles[0]);
  const Data data(scenes::makeBox({1, 1, 1}));
  CHECK(build(data.id, box) == dGPUTRIMESH_OK);
  CHECK(reportOf(data.id).solid == 0);
  CHECK(reportOf(data.id).triangles == 13);
  CHECK(reportOf(data.id).duplicate_triangles == 1);
  CHECK(hasProblem(data.id, dGPUTRIMESH_PROBLEM_DUPLICATE_TRIANGLE, 1));
  CHECK(dGpuTriMeshDataGetRepairCount(data.id) == 0);
  CHECK(build(data.id, box, dGPUTRIMESH_REPAIR_ALL) == dGPUTRIMESH_OK);
  const dGpuTriMeshReport repaired = reportOf(data.id);
  CHECK(repaired.solid == 1);
  CHECK(repaired.triangles == 12);
  CHECK(repaired.dropped_duplicates == 1);
  CHECK(repaired.flipped_triangles == 1);
  CHECK(near(repaired.volume, 1, 1e-6));
  CHECK(near(repaired.area, 6, 1e-6));
  REQUIRE(dGpuTriMeshDataGetRepairCount(data.id) == 2);
  CHECK(std::strlen(dGpuTriMeshDataGetRepair(data.id, 1)) > 0);
  for (int kind = dGPUTRIMESH_PROBLEM_NULL_ARRAY; kind <= dGPUTRIMESH_PROBLEM_UNUSED_VERTEX; ++kind) {
    CHECK(std::strcmp(dGpuTriMeshProblemName(kind), "unknown problem") != 0);
  }
  CHECK(std::strcmp(dGpuTriMeshProblemName(99), "unknown problem") == 0);
}

TEST_CASE("moving vertices refits the mesh and marks its geoms as moved") {
  const OdeSession session;
  const scenes::MeshArrays sphere = scenes::makeSphere(1, 2);
  const Data data(sphere), other(scenes::makeBox({1, 1, 1}));
  const Geom geom(data), box(other);
  test::usePairwise(geom.id);
  dGeomSetPosition(box.id, 5, 0, 0);
  dReal aabb[6];
  dGeomGetAABB(geom.id, aabb);
  CHECK(test::collide(geom.id, box.id).empty());
  std::vector<double> moved;
  std::vector<dReal> simple;
  for (const Vec3f& v : sphere.vertices) {
    moved.insert(moved.end(), {v.x + 4.0, double(v.y), double(v.z)});
    simple.insert(simple.end(), {v.x, v.y, v.z + dReal(10), 0});
  }
  const int count = static_cast<int>(sphere.vertices.size());
  REQUIRE(dGpuTriMeshDataUpdateVerticesDouble(data.id, moved.data(), 24, count) == dGPUTRIMESH_OK);
  dGeomGetAABB(geom.id, aabb);
  CHECK(near(aabb[0], 3, 1e-5));
  CHECK(near(aabb[1], 5, 1e-5));
  const auto contacts = test::collide(geom.id, box.id);
  CHECK(!contacts.empty());
  for (const dContactGeom& c : contacts) CHECK(std::string(contactFault(c, 1e-5)) == "");
  CHECK(dGpuTriMeshDataUpdateVerticesDouble(data.id, moved.data(), 24, count - 1) == dGPUTRIMESH_ERROR_MESH);
  CHECK(dGpuTriMeshDataUpdateVerticesDouble(data.id, moved.data(), -24, count) == dGPUTRIMESH_ERROR_ARGUMENT);
  CHECK(dGpuTriMeshDataUpdateVerticesDouble(nullptr, moved.data(), 24, count) == dGPUTRIMESH_ERROR_ARGUMENT);
  moved[7] = std::numeric_limits<double>::quiet_NaN();
  CHECK(dGpuTriMeshDataUpdateVerticesDouble(data.id, moved.data(), 24, count) == dGPUTRIMESH_ERROR_MESH);
  CHECK(test::collide(geom.id, box.id).size() == contacts.size());  // unchanged by the refused ones
  REQUIRE(dGpuTriMeshDataUpdate(data.id, simple.data(), count) == dGPUTRIMESH_OK);
  CHECK(test::collide(geom.id, box.id).empty());
  dGeomGetAABB(geom.id, aabb);
  CHECK(near(aabb[5], 11, 1e-5));
  REQUIRE(dGpuTriMeshDataUpdateVerticesSingle(data.id, sphere.vertices.data(), 0, count) == dGPUTRIMESH_OK);
  dGeomGetAABB(geom.id, aabb);
  CHECK(near(aabb[5], 1, 1e-5));
  const dGpuTriMeshDataID unbuilt = dGpuTriMeshDataCreate();
  CHECK(dGpuTriMeshDataUpdate(unbuilt, simple.data(), count) == dGPUTRIMESH_ERROR_ARGUMENT);
  dGpuTriMeshDataDestroy(unbuilt);
}

TEST_CASE("building again reaches the geoms; destroying data leaves them alone") {
  const OdeSession session;
  dGpuTriMeshDataID data = dGpuTriMeshDataCreate();
  const dGeomID a = dCreateGpuTriMesh(nullptr, data);  // not built yet
  const dGeomID b = dCreateGpuTriMesh(nullptr, data);
  dGeomSetPosition(b, 0.5, 0.3, 0.2);
  dReal aabb[6];
  dGeomGetAABB(a, aabb);
  CHECK(aabb[0] == 0);
  CHECK(aabb[1] == 0);
  CHECK(test::collide(a, b).empty());
  CHECK(build(data, scenes::makeBox({1, 1, 1})) == dGPUTRIMESH_OK);
  dGeomGetAABB(a, aabb);
  CHECK(near(aabb[1], 0.5, 1e-6));
  const std::size_t before = test::collide(a, b).size();
  CHECK(before > 0);
  CHECK(dGeomGpuTriMeshGetData(a) == data);
  dGpuTriMeshDataDestroy(data);
  CHECK(dGeomGpuTriMeshGetData(a) == nullptr);
  CHECK(test::collide(a, b).size() == before);
  const Data other(scenes::makeBox({2, 2, 2}));
  CHECK(dGeomGpuTriMeshSetData(a, other.id) == dGPUTRIMESH_OK);
  CHECK(dGeomGpuTriMeshGetData(a) == other.id);
  dGeomGetAABB(a, aabb);
  CHECK(near(aabb[1], 1, 1e-6));
  CHECK(dGeomGpuTriMeshSetData(a, other.id) == dGPUTRIMESH_OK);
  CHECK(dGeomGpuTriMeshSetData(a, nullptr) == dGPUTRIMESH_OK);
  CHECK(dGeomGpuTriMeshGetTriangleCount(a) == 0);
  dGeomDestroy(a);
  CHECK(dGeomGpuTriMeshGetTriangleCount(b) == 12);
  dGeomDestroy(b);  // the last use of the destroyed data
}

TEST_CASE("the C++ header owns data by scope") {
  const OdeSession session;
  const scenes::MeshArrays box = scenes::makeBox({1, 1, 1});
  CHECK(initGpuTriMesh());
  dGeomID geom = nullptr;
  {
    GpuTriMeshData first;
    CHECK(first.build(&box.vertices[0].x, box.vertices.size(), box.triangles[0].v, box.triangles.size()) ==
          dGPUTRIMESH_OK);
    GpuTriMeshData second = std::move(first);
    CHECK(first.id() == nullptr);
    CHECK(second.report().solid == 1);
    CHECK(second.error().empty());
    geom = second.createGeom();
  }
  CHECK(dGeomGpuTriMeshGetTriangleCount(geom) == 12);
  dGeomDestroy(geom);
}

TEST_CASE("mass is ODE's own for a box, and equals dMassSetTrimesh where that is right") {
  const OdeSession session;
  const Data box(scenes::makeBox({1, 2, 3}));
  dMass own, ode;
  CHECK(dMassSetGpuTriMeshData(&own, 7, box.id) == dGPUTRIMESH_OK);
  dMassSetBox(&ode, 7, 1, 2, 3);
  CHECK(sameMass(own, ode, 1e-9));
  CHECK(dMassSetGpuTriMeshDataTotal(&own, 5, box.id) == dGPUTRIMESH_OK);
  dMassSetBoxTotal(&ode, 5, 1, 2, 3);
  CHECK(sameMass(own, ode, 1e-9));

  // A lump far from its frame's origin, against ODE's integration of the same triangles. ODE 0.16 adds the
  // parallel-axis term twice, so that its inertia is right only where the centre of mass is in the origin: both geoms
  // are moved there.
  const Transformd away{{0, -1, 0, 1, 0, 0, 0, 0, 1}, {3, 4, 5}};
  const scenes::MeshArrays lump = scenes::transformed(scenes::makeLump(0.5, 3, 0.2, 7), away);
  const Data lumpData(lump);
  const Geom geom(lumpData);
  const dTriMeshDataID odeData = dGeomTriMeshDataCreate();
  dGeomTriMeshDataBuildSingle(odeData, lump.vertices.data(), 12, static_cast<int>(lump.vertices.size()),
                              lump.triangles.data(), static_cast<int>(3 * lump.triangles.size()), 12);
  const dGeomID odeGeom = dCreateTriMesh(nullptr, odeData, nullptr, nullptr, nullptr);
  dMassSetTrimesh(&ode, 2, odeGeom);
  CHECK(dMassSetGpuTriMesh(&own, 2, geom.id) == dGPUTRIMESH_OK);
  CHECK(near(own.mass, ode.mass, 1e-6));
  for (int i = 0; i < 3; ++i) CHECK(near(own.c[i], ode.c[i], 1e-5));
  std::mt19937 random(5);
  dMatrix3 r;
  randomRotation(r, random);
  dVector3 turned;
  dMultiply0(turned, r, own.c, 3, 3, 1);
  for (const dGeomID g : {geom.id, odeGeom}) {
    dGeomSetRotation(g, r);
    dGeomSetPosition(g, -turned[0], -turned[1], -turned[2]);
  }
  dMassSetTrimesh(&ode, 2, odeGeom);
  CHECK(dMassSetGpuTriMesh(&own, 2, geom.id) == dGPUTRIMESH_OK);
  CHECK(sameMass(own, ode, 1e-6));
  // Away from there the parallel-axis theorem says what it has to be, and ODE's dMassTranslate has that right.
  for (const dGeomID g : {geom.id, odeGeom}) dGeomSetPosition(g, 1 - turned[0], -2 - turned[1], 3 - turned[2]);
  dMassTranslate(&ode, 1, -2, 3);
  CHECK(dMassSetGpuTriMesh(&own, 2, geom.id) == dGPUTRIMESH_OK);
  CHECK(sameMass(own, ode, 1e-6));
  CHECK(dMassSetGpuTriMeshTotal(&own, 9, geom.id) == dGPUTRIMESH_OK);
  CHECK(near(own.mass, 9, 1e-12));
  CHECK(dMassCheck(&own) == 1);

  // On a body the offset counts and the world pose does not.
  const dWorldID world = dWorldCreate();
  const dBodyID body = dBodyCreate(world);
  dGeomSetBody(geom.id, body);
  dBodySetPosition(body, 100, 0, 0);
  dMass plain, shifted;
  dMassSetGpuTriMeshData(&plain, 2, lumpData.id);
  CHECK(dMassSetGpuTriMesh(&own, 2, geom.id) == dGPUTRIMESH_OK);
  CHECK(sameMass(own, plain, 1e-9));
  dGeomSetOffsetPosition(geom.id, -plain.c[0], -plain.c[1], -plain.c[2]);

  CHECK(dMassSetGpuTriMesh(&shifted, 2, geom.id) == dGPUTRIMESH_OK);
  dMassTranslate(&plain, -plain.c[0], -plain.c[1], -plain.c[2]);

  CHECK(sameMass(shifted, plain, 1e-9));
  dGeomSetBody(geom.id, nullptr);
  dBodyDestroy(body);
  dWorldDestroy(world);
  dGeomDestroy(odeGeom);
  dGeomTriMeshDataDestroy(odeData);
}

TEST_CASE("what has no volume has no mass") {
  const OdeSession session;
  scenes::MeshArrays inward = scenes::makeBox({1, 1, 1});
  for (Triangle& t : inward.triangles) std::swap(t.v[0], t.v[1]);
  scenes::MeshArrays flat = scenes::makeBox({1, 1, 1});
  flat.triangles.resize(2);
  scenes::MeshArrays holed = scenes::makeSphere(1, 2);
  holed.triangles.pop_back();
  const Data inwardData(inward), flatData(flat), holedData(holed), box(scenes::makeBox({1, 1, 1}));
  const Geom geom(box);
  dMass m;
  dMassSetSphere(&m, 1, 1);
  const dMass before = m;
  CHECK(dMassSetGpuTriMeshData(&m, 1, inwardData.id) == dGPUTRIMESH_ERROR_MASS);
  CHECK(dMassSetGpuTriMeshData(&m, 1, flatData.id) == dGPUTRIMESH_ERROR_MASS);
  CHECK(dMassSetGpuTriMeshData(&m, 0, box.id) == dGPUTRIMESH_ERROR_ARGUMENT);
  CHECK(dMassSetGpuTriMeshData(&m, std::numeric_limits<dReal>::quiet_NaN(), box.id) == dGPUTRIMESH_ERROR_ARGUMENT);
  CHECK(dMassSetGpuTriMeshData(nullptr, 1, box.id) == dGPUTRIMESH_ERROR_ARGUMENT);
  CHECK(dMassSetGpuTriMesh(nullptr, 1, geom.id) == dGPUTRIMESH_ERROR_ARGUMENT);
  CHECK(dMassSetGpuTriMeshTotal(&m, -1, geom.id) == dGPUTRIMESH_ERROR_ARGUMENT);
  CHECK(dMassSetGpuTriMeshData(&m, 1, nullptr) == dGPUTRIMESH_ERROR_ARGUMENT);
  const dGeomID sphere = dCreateSphere(nullptr, 1);
  CHECK(dMassSetGpuTriMesh(&m, 1, sphere) == dGPUTRIMESH_ERROR_CLASS);
  dGeomDestroy(sphere);
  CHECK(sameMass(m, before, 0));
  CHECK(dMassSetGpuTriMeshData(&m, 1, holedData.id) == dGPUTRIMESH_NOT_SOLID);
  CHECK(near(m.mass, 4.19, 0.25));
}
