// SPDX-License-Identifier: BSD-3-Clause
// The geom among ODE's things: bounding box, offsets, transforms, spaces, destruction, triangle getters.
#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

#include "support/catch.h"
#include "support/ode_world.h"

#if defined(__GNUC__)
#pragma GCC diagnostic ignored "-Wdeprecated-declarations"  // dGeomTransform is, and has to work all the same
#endif

using namespace otg;
using namespace otg::test;

namespace {

struct Gathered {
  std::vector<std::pair<dGeomID, dGeomID>> pairs;
  std::size_t contacts = 0;
};

void gather(void* data, dGeomID o1, dGeomID o2) {
  auto* const gathered = static_cast<Gathered*>(data);
  const auto contacts = test::collide(o1, o2, 16);
  if (contacts.empty()) return;
  gathered->pairs.push_back(std::minmax(o1, o2));
  gathered->contacts += contacts.size();
}

bool boxHolds(const dReal aabb[6], const dVector3 p) {
  for (int i = 0; i < 3; ++i) {
    if (!(aabb[2 * i] <= p[i] && p[i] <= aabb[2 * i + 1])) return false;
  }
  return true;
}

}  // namespace

TEST_CASE("the bounding box holds every corner at any pose, and is the exact one when unturned") {
  const OdeSession session;
  const Data lump(scenes::makeLump(1, 3, 0.4, 21));
  const Geom geom(lump);
  std::mt19937 random(3);
  for (const double reach : {0.0, 1.0, 1e6}) {
    for (int i = 0; i < 20; ++i) {
      setRandomPose(geom.id, random, reach);
      dReal aabb[6];
      dGeomGetAABB(geom.id, aabb);
      bool all = true;
      for (int t = 0; t < dGeomGpuTriMeshGetTriangleCount(geom.id); ++t) {
        dVector3 v[3];
        dGeomGpuTriMeshGetTriangle(geom.id, t, &v[0], &v[1], &v[2]);
        for (const dVector3& p : v) all = all && boxHolds(aabb, p);
      }
      REQUIRE(all);
      // The diagonal of the mesh's own box bounds each side.
      for (int k = 0; k < 3; ++k) REQUIRE(aabb[2 * k + 1] - aabb[2 * k] < 2.9 * std::sqrt(3.0));
    }
  }
  const Data box(scenes::makeBox({1, 2, 3}));
  const Geom unturned(box);
  dGeomSetPosition(unturned.id, 10, 20, 30);
  dReal aabb[6];
  dGeomGetAABB(unturned.id, aabb);
  const double expected[6] = {9.5, 10.5, 19, 21, 28.5, 31.5};
  for (int i = 0; i < 6; ++i) {
    CHECK(std::abs(aabb[i] - expected[i]) < 1e-12);
    CHECK((i % 2 == 0 ? aabb[i] <= expected[i] : aabb[i] >= expected[i]));
  }
}

TEST_CASE("the bounding box is finite whatever the pose, and for a geom without triangles") {
  const OdeSession session;
  const Data box(scenes::makeBox({1, 1, 1})), none(scenes::MeshArrays{});
  const Geom geom(box), empty(none);
  const dReal nan = std::numeric_limits<dReal>::quiet_NaN(), inf = std::numeric_limits<dReal>::infinity();
  const auto isFinite = [](dGeomID g) {
    dReal aabb[6];
    dGeomGetAABB(g, aabb);
    return std::all_of(aabb, aabb + 6, [](dReal x) { return std::isfinite(x); }) && aabb[0] <= aabb[1] &&
           aabb[2] <= aabb[3] && aabb[4] <= aabb[5];
  };
  for (const dReal x : {nan, inf, -inf, std::numeric_limits<dReal>::max()}) {
    dGeomSetPosition(geom.id, 0, x, 0);
    dGeomSetPosition(empty.id, 0, x, 0);
    CHECK(isFinite(geom.id));
    CHECK(isFinite(empty.id));
  }
  dMatrix3 r = {1, 0, 0, 0, 0, nan, 0, 0, 0, 0, 1, 0};
  dGeomSetPosition(geom.id, 0, 0, 0);
  dGeomSetRotation(geom.id, r);
  CHECK(isFinite(geom.id));
  dGeomSetPosition(empty.id, 1, 2, 3);
  dReal aabb[6];
  dGeomGetAABB(empty.id, aabb);
  CHECK(aabb[0] == 1);
  CHECK(aabb[5] == 3);
}

TEST_CASE("a geom with an offset collides where body and offset put it") {
  const OdeSession session;
  const Data sphere(scenes::makeSphere(1, 2)), lump(scenes::makeLump(1, 2, 0.3, 9));
  const Geom a(sphere), offset(lump), plain(lump);
  test::usePairwise(a.id);  // the object-level model may choose other places for poses that differ by rounding
  const dWorldID world = dWorldCreate();
  const dBodyID body = dBodyCreate(world);
  dGeomSetBody(offset.id, body);
  std::mt19937 random(8);
  std::size_t seen = 0;
  for (int i = 0; i < 10; ++i) {
    dMatrix3 bodyR, offsetR, worldR;
    randomRotation(bodyR, random);
    randomRotation(offsetR, random);
    dBodySetPosition(body, 0.1, -0.2, 0.1 * i);
    dBodySetRotation(body, bodyR);
    dGeomSetOffsetPosition(offset.id, 0.3, 0.5, -0.4);
    dGeomSetOffsetRotation(offset.id, offsetR);
    dMultiply0(worldR, bodyR, offsetR, 3, 3, 3);
    dVector3 p;
    dBodyGetRelPointPos(body, 0.3, 0.5, -0.4, p);
    dGeomSetPosition(plain.id, p[0], p[1], p[2]);
    dGeomSetRotation(plain.id, worldR);
    const auto with = test::collide(a.id, offset.id), without = test::collide(a.id, plain.id);
    REQUIRE(with.size() == without.size());
    for (std::size_t k = 0; k < with.size(); ++k) {
      ++seen;
      CHECK(with[k].side1 == without[k].side1);
      CHECK(with[k].side2 == without[k].side2);
      for (int d = 0; d < 3; ++d) CHECK(std::abs(with[k].pos[d] - without[k].pos[d]) < 1e-9);
    }
  }
  CHECK(seen > 20);
  dGeomSetBody(offset.id, nullptr);
  dBodyDestroy(body);
  dWorldDestroy(world);
}

TEST_CASE("geoms of one body do not collide, and neither does a geom with itself") {
  const OdeSession session;
  const Data box(scenes::makeBox({1, 1, 1}));
  const Geom a(box), b(box);
  const dWorldID world = dWorldCreate();
  const dBodyID body = dBodyCreate(world);
  dGeomSetPosition(b.id, 0.5, 0.2, 0.1);
  CHECK(!test::collide(a.id, b.id).empty());
  CHECK(test::collide(a.id, a.id).empty());
  dGeomSetBody(a.id, body);
  dGeomSetBody(b.id, body);
  dGeomSetOffsetPosition(b.id, 0.5, 0.2, 0.1);
  CHECK(test::collide(a.id, b.id).empty());
  dGeomSetBody(a.id, nullptr);
  dGeomSetBody(b.id, nullptr);
  dBodyDestroy(body);
  dWorldDestroy(world);
}

TEST_CASE("inside a dGeomTransform the geom collides where the transform puts it, with either info mode") {
  const OdeSession session;
  const Data sphere(scenes::makeSphere(1, 2)), lump(scenes::makeLump(1, 2, 0.3, 9));
  const Geom a(sphere), plain(lump);
  const dGeomID inner = dCreateGpuTriMesh(nullptr, lump.id);
  const dGeomID wrapper = dCreateGeomTransform(nullptr);
  dGeomTransformSetCleanup(wrapper, 1);
  dGeomTransformSetGeom(wrapper, inner);
  dGeomSetPosition(inner, 0.5, 0, 0);
  dGeomSetPosition(wrapper, 0.4, 0.5, 0.2);
  dGeomSetPosition(plain.id, 0.9, 0.5, 0.2);
  const auto expected = test::collide(a.id, plain.id);
  REQUIRE(!expected.empty());
  for (const int info : {0, 1}) {
    dGeomTransformSetInfo(wrapper, info);
    const auto forward = test::collide(a.id, wrapper);
    REQUIRE(forward.size() == expected.size());
    for (std::size_t i = 0; i < forward.size(); ++i) {
      CHECK(forward[i].g1 == a.id);
      CHECK(forward[i].g2 == (info == 1 ? wrapper : inner));
      CHECK(forward[i].side1 == expected[i].side1);
      CHECK(forward[i].side2 == expected[i].side2);
      for (int d = 0; d < 3; ++d) CHECK(std::abs(forward[i].pos[d] - expected[i].pos[d]) < 1e-12);
      for (int d = 0; d < 3; ++d) CHECK(std::abs(forward[i].normal[d] - expected[i].normal[d]) < 1e-12);
    }
    CHECK(sameContacts(forward, mirrored(test::collide(wrapper, a.id))));
  }
  dReal outer[6], direct[6];
  dGeomGetAABB(wrapper, outer);
  dGeomGetAABB(plain.id, direct);
  for (int i = 0; i < 6; ++i) CHECK(std::abs(outer[i] - direct[i]) < 1e-9);
  // The inner geom is back at its own place.
  CHECK(dGeomGetPosition(inner)[0] == dReal(0.5));
  dGeomDestroy(wrapper);  // and the inner geom with it
}

TEST_CASE("all four spaces find the colliding pairs, step after step, and clean up") {
  const OdeSession session;
  const dVector3 center = {0, 0, 0, 0}, extents = {20, 20, 20, 0};
  for (int kind = 0; kind < 4; ++kind) {
    const Data sphere(scenes::makeSphere(1, 2)), box(scenes::makeBox({1.5, 1.5, 1.5}));
    const dSpaceID space = kind == 0   ? dSimpleSpaceCreate(nullptr)
                           : kind == 1 ? dHashSpaceCreate(nullptr)
                           : kind == 2 ? dSweepAndPruneSpaceCreate(nullptr, dSAP_AXES_XYZ)
                                       : dQuadTreeSpaceCreate(nullptr, center, extents, 4);
    if (kind == 1) dHashSpaceSetLevels(space, -3, 6);
    std::vector<dGeomID> geoms;
    for (int i = 0; i < 8; ++i) geoms.push_back(dCreateGpuTriMesh(space, i % 2 ? sphere.id : box.id));
    const dGeomID lost = dCreateGpuTriMesh(space, sphere.id);
    dGeomSetPosition(lost, std::numeric_limits<dReal>::quiet_NaN(), 0, 0);
    const dGeomID empty = dCreateGpuTriMesh(space, nullptr);
    CHECK(dSpaceGetNumGeoms(space) == 10);
    std::mt19937 random(static_cast<unsigned>(40 + kind));
    std::size_t found = 0;
    for (int step = 0; step < 10; ++step) {
      for (const dGeomID g : geoms) setRandomPose(g, random, 3);
      Gathered expected, gathered;
      for (std::size_t i = 0; i < geoms.size(); ++i) {
        for (std::size_t j = i + 1; j < geoms.size(); ++j) gather(&expected, geoms[i], geoms[j]);
      }
      dSpaceCollide(space, &gathered, &gather);
      std::sort(expected.pairs.begin(), expected.pairs.end());
      std::sort(gathered.pairs.begin(), gathered.pairs.end());
      REQUIRE(gathered.pairs == expected.pairs);
      REQUIRE(gathered.contacts == expected.contacts);
      found += gathered.contacts;
    }
    CHECK(found > 0);
    // Colliding a geom with a whole space goes through ODE's own collider and must reach ours.
    const dGeomID probe = dCreateGpuTriMesh(nullptr, box.id);
    const dReal* const p = dGeomGetPosition(geoms[0]);
    dGeomSetPosition(probe, p[0] + 0.3, p[1], p[2]);
    CHECK(!test::collide(probe, reinterpret_cast<dGeomID>(space), 64).empty());
    dGeomDestroy(probe);
    dGeomDestroy(geoms[3]);
    dGeomDestroy(empty);
    CHECK(dSpaceGetNumGeoms(space) == 8);
    dSpaceDestroy(space);  // destroys the geoms; the data are still ours
    dGpuTriMeshReport report;
    dGpuTriMeshReportInit(&report);
    CHECK(dGpuTriMeshDataGetReport(sphere.id, &report) == dGPUTRIMESH_OK);
    CHECK(report.triangles == 320);
  }
}

TEST_CASE("building data again marks geoms in a space as moved") {
  const OdeSession session;
  const dSpaceID space = dHashSpaceCreate(nullptr);
  const dGpuTriMeshDataID data = dGpuTriMeshDataCreate();
  const Data box(scenes::makeBox({1, 1, 1}));
  dCreateGpuTriMesh(space, data);
  const dGeomID other = dCreateGpuTriMesh(space, box.id);
  dGeomSetPosition(other, 4, 0, 0);
  Gathered before, after;
  dSpaceCollide(space, &before, &gather);
  CHECK(before.pairs.empty());
  const scenes::MeshArrays large = scenes::makeSphere(4, 2);
  CHECK(dGpuTriMeshDataBuildSingle(data, large.vertices.data(), 0, static_cast<int>(large.vertices.size()),
                                   large.triangles.data(), static_cast<int>(3 * large.triangles.size()),
                                   0) == dGPUTRIMESH_OK);
  dSpaceCollide(space, &after, &gather);
  CHECK(after.pairs.size() == 1);
  dGpuTriMeshDataDestroy(data);  // before the geom that uses it
  dSpaceDestroy(space);
}

TEST_CASE("triangles and points are given in world coordinates; bad indices write nothing") {
  const OdeSession session;
  const scenes::MeshArrays mesh = scenes::makeLump(1, 1, 0.3, 2);
  const Data data(mesh);
  const Geom geom(data);
  std::mt19937 random(6);
  setRandomPose(geom.id, random, 5);
  const int count = dGeomGpuTriMeshGetTriangleCount(geom.id);
  REQUIRE(count == static_cast<int>(mesh.triangles.size()));
  for (int t = 0; t < count; ++t) {
    dVector3 v[3];
    REQUIRE(dGeomGpuTriMeshGetTriangle(geom.id, t, &v[0], &v[1], &v[2]) == dGPUTRIMESH_OK);
    dVector3 expectedPoint = {0, 0, 0, 0};
    const double weights[3] = {0.2, 0.3, 0.5};
    for (int k = 0; k < 3; ++k) {
      const Vec3f own = mesh.vertices[mesh.triangles[static_cast<std::size_t>(t)].v[k]];
      dVector3 expected;
      dGeomGetRelPointPos(geom.id, own.x, own.y, own.z, expected);  // ODE's word on what the pose means
      for (int d = 0; d < 3; ++d) {
        CHECK(std::abs(v[k][d] - expected[d]) < 1e-12);
        expectedPoint[d] += weights[k] * expected[d];
      }
      CHECK(v[k][3] == 0);
    }
    dVector3 point;
    CHECK(dGeomGpuTriMeshGetPoint(geom.id, t, 0.3, 0.5, point) == dGPUTRIMESH_OK);
    for (int d = 0; d < 3; ++d) CHECK(std::abs(point[d] - expectedPoint[d]) < 1e-12);
    CHECK(point[3] == 0);
  }
  dVector3 untouched = {1, 2, 3, 4};
  for (const int index : {-1, count, std::numeric_limits<int>::max(), std::numeric_limits<int>::min()}) {
    CHECK(dGeomGpuTriMeshGetTriangle(geom.id, index, &untouched, nullptr, nullptr) == dGPUTRIMESH_ERROR_ARGUMENT);
    CHECK(dGeomGpuTriMeshGetPoint(geom.id, index, 0, 0, untouched) == dGPUTRIMESH_ERROR_ARGUMENT);
  }
  CHECK(dGeomGpuTriMeshGetPoint(geom.id, 0, 0, 0, nullptr) == dGPUTRIMESH_ERROR_ARGUMENT);
  CHECK(dGeomGpuTriMeshGetTriangle(nullptr, 0, &untouched, nullptr, nullptr) == dGPUTRIMESH_ERROR_CLASS);
  CHECK(untouched[0] == 1);
  CHECK(untouched[3] == 4);
  CHECK(dGeomGpuTriMeshGetTriangle(geom.id, 0, nullptr, nullptr, &untouched) == dGPUTRIMESH_OK);
  CHECK(untouched[3] == 0);
  const dGeomID bare = dCreateGpuTriMesh(nullptr, nullptr);
  CHECK(dGeomGpuTriMeshGetTriangleCount(bare) == 0);
  CHECK(dGeomGpuTriMeshGetTriangle(bare, 0, &untouched, nullptr, nullptr) == dGPUTRIMESH_ERROR_ARGUMENT);
  CHECK(dGeomGpuTriMeshGetData(bare) == nullptr);
  dGeomDestroy(bare);
}

TEST_CASE("a geom that dCreateGeom made of our class is harmless") {
  const OdeSession session;
  const Data box(scenes::makeBox({1, 1, 1}));
  const Geom geom(box);
  const dGeomID raw = dCreateGeom(dGpuTriMeshGetClass());
  dReal aabb[6];
  dGeomGetAABB(raw, aabb);
  CHECK(aabb[1] == 0);
  CHECK(test::collide(raw, geom.id).empty());
  CHECK(dGeomGpuTriMeshSetData(raw, box.id) == dGPUTRIMESH_ERROR_CLASS);
  dGeomDestroy(raw);
}

TEST_CASE("a geom whose data hold no mesh touches none of ODE's shapes") {
  const OdeSession session;
  const dGpuTriMeshDataID data = dGpuTriMeshDataCreate();
  const dGeomID mesh = dCreateGpuTriMesh(nullptr, data);
  REQUIRE(mesh != nullptr);
  const dGeomID ray = dCreateRay(nullptr, 2);
  dGeomRaySet(ray, 0, 0, 1, 0, 0, -1);
  const dGeomID shapes[] = {dCreateSphere(nullptr, 1),           dCreateBox(nullptr, 1, 1, 1),
                            dCreateCapsule(nullptr, 1, 1),       dCreateCylinder(nullptr, 1, 1),
                            dCreatePlane(nullptr, 0, 0, 1, 0.5), ray};
  for (const dGeomID shape : shapes) {
    CAPTURE(dGeomGetClass(shape));
    CHECK(test::collide(mesh, shape, 8).empty());
    CHECK(test::collide(shape, mesh, 8).empty());
    dGeomDestroy(shape);
  }
  dGeomDestroy(mesh);
  dGpuTriMeshDataDestroy(data);
}

TEST_CASE("a world that is built and stepped twice has the same contacts and ends in the same bytes") {
  const OdeSession session;
  const auto simulate = [] {
    const Data ground(scenes::makeGround(10, 1, 4)), lump(scenes::makeLump(0.5, 2, 0.2, 4));
    const dWorldID world = dWorldCreate();
    dWorldSetGravity(world, 0, 0, -9.81);
    const dSpaceID space = dHashSpaceCreate(nullptr);
    const dJointGroupID group = dJointGroupCreate(0);
    dCreateGpuTriMesh(space, ground.id);
    std::vector<dBodyID> bodies;
    for (int i = 0; i < 3; ++i) {
      const dBodyID body = dBodyCreate(world);
      dMass mass;
      dMassSetSphere(&mass, 1, 0.5);
      dBodySetMass(body, &mass);
      dGeomSetBody(dCreateGpuTriMesh(space, lump.id), body);
      dBodySetPosition(body, 0.1 * i, 0.2 * i, 0.7 + 0.9 * i);
      bodies.push_back(body);
    }
    struct Step {
      dWorldID world;
      dJointGroupID group;
      std::size_t contacts;
    } step{world, group, 0};
    for (int n = 0; n < 100; ++n) {
      dSpaceCollide(space, &step, [](void* data, dGeomID o1, dGeomID o2) {
        auto* const s = static_cast<Step*>(data);
        for (const dContactGeom& c : test::collide(o1, o2, 16)) {
          dContact contact{};
          contact.surface.mu = 0.5;
          contact.geom = c;
          dJointAttach(dJointCreateContact(s->world, s->group, &contact), dGeomGetBody(o1), dGeomGetBody(o2));
          ++s->contacts;
        }
      });
      dWorldStep(world, 0.005);
      dJointGroupEmpty(group);
    }
    std::vector<dReal> state = {dReal(step.contacts)};
    for (const dBodyID body : bodies) {
      state.insert(state.end(), dBodyGetPosition(body), dBodyGetPosition(body) + 3);
      state.insert(state.end(), dBodyGetQuaternion(body), dBodyGetQuaternion(body) + 4);
    }
    dJointGroupDestroy(group);
    dSpaceDestroy(space);
    dWorldDestroy(world);
    return state;
  };
  const auto first = simulate();
  // Other addresses for the second run, so that an order by address would show.
  const Data filler(scenes::makeSphere(1, 3));
  std::vector<dGeomID> fillers;
  for (int i = 0; i < 57; ++i) fillers.push_back(dCreateGpuTriMesh(nullptr, filler.id));
  for (std::size_t i = 0; i < fillers.size(); i += 2) dGeomDestroy(fillers[i]);
  const auto second = simulate();
  for (std::size_t i = 1; i < fillers.size(); i += 2) dGeomDestroy(fillers[i]);
  CHECK(first[0] > 50);
  CHECK(first == second);
}
