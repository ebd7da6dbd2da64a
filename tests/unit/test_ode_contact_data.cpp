// SPDX-License-Identifier: BSD-3-Clause
// dGpuTriMeshCollideEx: the contacts of dCollide with their data, and names that stay in a world that rests.
#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <set>

#include "support/catch.h"
#include "support/ode_world.h"

using namespace otg;
using namespace otg::test;

namespace {

struct Known {
  std::vector<dContactGeom> contacts;
  std::vector<dGpuTriMeshContactData> data;
  std::set<duint64> ids() const {
    std::set<duint64> all;
    for (const auto& d : data) all.insert(d.id);
    return all;
  }
};

Known collideEx(dGeomID o1, dGeomID o2, int capacity = 256) {
  Known known;
  known.contacts.resize(static_cast<std::size_t>(capacity));
  known.data.resize(static_cast<std::size_t>(capacity));
  const int n = dGpuTriMeshCollideEx(o1, o2, capacity, known.contacts.data(), sizeof(dContactGeom), known.data.data(),
                                     sizeof(dGpuTriMeshContactData));
  REQUIRE(n >= 0);
  known.contacts.resize(static_cast<std::size_t>(n));
  known.data.resize(static_cast<std::size_t>(n));
  return known;
}

dVector3* cornersOf(dGeomID g, int triangle, dVector3* v) {
  REQUIRE(dGeomGpuTriMeshGetTriangle(g, triangle, &v[0], &v[1], &v[2]) == dGPUTRIMESH_OK);
  return v;
}

}  // namespace

TEST_CASE("the contacts are dCollide's, and the data go with them in both orders") {
  const OdeSession session;
  const Data sphere(scenes::makeSphere(1, 2)), lump(scenes::makeLump(1, 2, 0.3, 9));
  const Geom a(sphere), b(lump);
  std::mt19937 random(5);
  std::size_t seen = 0;
  for (int i = 0; i < 40; ++i) {
    setRandomPose(a.id, random, 0.8);
    setRandomPose(b.id, random, 0.8);
    const int capacity = i % 2 ? 256 : 5;
    const Known forward = collideEx(a.id, b.id, capacity), backward = collideEx(b.id, a.id, capacity);
    REQUIRE(sameContacts(forward.contacts, test::collide(a.id, b.id, capacity)));
    REQUIRE(sameContacts(backward.contacts, mirrored(forward.contacts)));
    CHECK(forward.ids().size() == forward.data.size());  // no name twice
    for (std::size_t k = 0; k < forward.data.size(); ++k) {
      const dGpuTriMeshContactData &f = forward.data[k], &g = backward.data[k];
      REQUIRE(f.id == g.id);
      REQUIRE(f.id != 0);
      REQUIRE(f.region == g.region);
      REQUIRE(f.coherence == g.coherence);
      REQUIRE(f.flags == g.flags);
      REQUIRE(f.feature == g.feature);
      REQUIRE((f.feature_side == 0 ? 0 : 3 - f.feature_side) == g.feature_side);
      REQUIRE(f.vertex1 == g.vertex1);
      REQUIRE(f.vertex2 == g.vertex2);
      REQUIRE(f.triangle1 == g.triangle2);
      REQUIRE(f.triangle2 == g.triangle1);
      REQUIRE(f.triangle1 == forward.contacts[k].side1);
      REQUIRE(f.triangle2 == forward.contacts[k].side2);
      ++seen;
    }
  }
  CHECK(seen > 200);
}

TEST_CASE("features are numbered as the mesh data are") {
  // A tetrahedron stands on its tip, vertex 0, a little inside the ground.
  const OdeSession session;
  const Data ground(scenes::makeGround(20, 1, 2)),
      tip(scenes::makeTetrahedron({0, 0, 0}, {1, 0, 2}, {-1, 1, 2}, {-1, -1, 2}));
  const Geom floor(ground), upper(tip);
  dGeomSetPosition(upper.id, 1.3, 0.7, -0.01);
  const Known known = collideEx(floor.id, upper.id);
  REQUIRE_FALSE(known.data.empty());
  const dGpuTriMeshContactData& deepest = known.data.front();
  CHECK(deepest.feature == dGPUTRIMESH_FEATURE_VERTEX);
  CHECK(deepest.feature_side == 2);
  CHECK(deepest.vertex2 == -1);
  CHECK(deepest.flags == dGPUTRIMESH_CONTACT_INSIDE);
  CHECK(deepest.region == 0);
  dVector3 v[3];
  cornersOf(upper.id, deepest.triangle2, v);
  CHECK(std::min({v[0][2], v[1][2], v[2][2]}) == Approx(-0.01));
  cornersOf(floor.id, deepest.triangle1, v);
  CHECK(std::max({v[0][2], v[1][2], v[2][2]}) == 0);
}

TEST_CASE("names stay in a stack that rests, and are not those of another contact") {
  const OdeSession session;
  const Data box(scenes::makeBox({1, 1, 1}, 2)), ground(scenes::makeGround(8, 1, 6));
  const dWorldID world = dWorldCreate();
  dWorldSetGravity(world, 0, 0, -9.81);
  dWorldSetERP(world, 0.2);
  dWorldSetCFM(world, 1e-5);
  const dJointGroupID joints = dJointGroupCreate(0);
  std::vector<dGeomID> geoms{dCreateGpuTriMesh(nullptr, ground.id)};
  for (int i = 0; i < 4; ++i) {
    const dBodyID body = dBodyCreate(world);
    dMass mass;
    REQUIRE(dMassSetGpuTriMeshDataTotal(&mass, 1, box.id) == dGPUTRIMESH_OK);
    dBodySetMass(body, &mass);
    geoms.push_back(dCreateGpuTriMesh(nullptr, box.id));
    dGeomSetBody(geoms.back(), body);
    // A little apart: at exact touch all of the stepper's equations tie, and it says "LCP internal error".
    dBodySetPosition(body, 0.31 + 0.05 * i, 0.27, 0.5 + 1.0001 * i);
    dMatrix3 turn;
    dRFromAxisAndAngle(turn, 0, 0, 1, 0.2 * i);
    dBodySetRotation(body, turn);
  }
  std::vector<std::set<duint64>> before(geoms.size());
  std::size_t kept = 0, all = 0;
  for (int step = 0; step < 400; ++step) {
    dJointGroupEmpty(joints);
    for (std::size_t i = 0; i + 1 < geoms.size(); ++i) {
      const Known known = collideEx(geoms[i], geoms[i + 1], 64);
      const std::set<duint64> ids = known.ids();
      REQUIRE(ids.size() == known.data.size());
      if (step >= 200) {
        for (const duint64 id : before[i]) kept += ids.count(id);
        all += before[i].size();
        REQUIRE(known.data.size() >= 4);
      }
      before[i] = ids;
      for (const dContactGeom& geom : known.contacts) {
        dContact contact{};
        contact.surface.mode = dContactApprox1;
        contact.surface.mu = 1;
        contact.geom = geom;
        dJointAttach(dJointCreateContact(world, joints, &contact), dGeomGetBody(geom.g1), dGeomGetBody(geom.g2));
      }
    }
    dWorldStep(world, 0.005);
  }
  INFO(kept << " of " << all << " names stayed");
  CHECK(kept >= 0.95 * static_cast<double>(all));
  CHECK(dBodyGetPosition(dGeomGetBody(geoms.back()))[2] == Approx(3.5).margin(0.01));
  dJointGroupDestroy(joints);
  for (const dGeomID geom : geoms) dGeomDestroy(geom);
  dWorldDestroy(world);
}

TEST_CASE("contacts per region are limited by the smaller number of the two geoms") {
  const OdeSession session;
  // Four corners of one box in the other, equally deep: none of them is dropped for being shallow.
  const Data large(scenes::makeBox({4, 4, 4}, 1)), small(scenes::makeBox({1, 1, 1}, 1));
  const Geom a(large), b(small);
  dGeomSetPosition(b.id, 1, 0.5, 2.49);
  dGpuTriMeshParams params;
  dGpuTriMeshParamsInit(&params);
  CHECK(params.contacts_per_region == 16);
  CHECK(collideEx(a.id, b.id).data.size() >= 4);
  for (const int limit : {1, 2, 3, 4}) {
    params.contacts_per_region = limit;
    for (const dGeomID g : {a.id, b.id}) {
      REQUIRE(dGeomGpuTriMeshSetParams(g, &params) == dGPUTRIMESH_OK);
      CHECK(collideEx(a.id, b.id).data.size() == static_cast<std::size_t>(limit));
      CHECK(collideEx(b.id, a.id).data.size() == static_cast<std::size_t>(limit));
      dGpuTriMeshParams defaults;
      dGpuTriMeshParamsInit(&defaults);
      REQUIRE(dGeomGpuTriMeshSetParams(g, &defaults) == dGPUTRIMESH_OK);
    }
  }
  for (const int wrong : {0, -1, 65}) {
    params.contacts_per_region = wrong;
    CHECK(dGeomGpuTriMeshSetParams(a.id, &params) == dGPUTRIMESH_ERROR_ARGUMENT);
  }
}

TEST_CASE("regions that come near to each other count as one on demand") {
  const OdeSession session;
  // A table on two soles of 4 x 4 feet, 0.3 from foot to foot. From the last foot of one sole to the first of the other
  // it is 1.9.
  std::vector<scenes::MeshArrays> parts{scenes::makeBox({4, 1.2, 0.2}, 1)};
  for (int i = 0; i < 8; ++i) {
    for (int j = 0; j < 4; ++j) {
      const double x = 0.3 * (i % 4) + (i < 4 ? -1.85 : 0.95);
      parts.push_back(scenes::transformed(scenes::makeBox({0.1, 0.1, 0.2}, 1),
                                          {{1, 0, 0, 0, 1, 0, 0, 0, 1}, {x, 0.3 * j - 0.45, -0.19}}));
    }
  }
  const Data ground(scenes::makeGround(8, 1, 3)), table(scenes::merge(parts));
  dGpuTriMeshParams params;
  dGpuTriMeshParamsInit(&params);
  CHECK(params.region_merge == 0);
  for (const dReal wrong : {dReal(-1), std::numeric_limits<dReal>::infinity(), dReal(std::nan(""))}) {
    const Geom geom(table);
    params.region_merge = wrong;
    CHECK(dGeomGpuTriMeshSetParams(geom.id, &params) == dGPUTRIMESH_ERROR_ARGUMENT);
  }
  struct Expected {
    dReal merge;
    std::size_t regions, contacts;
  };
  // The feet's corners are 0.1 apart within a foot, and 0.2 from foot to foot.
  for (const Expected& expected : {Expected{0, 32, 128}, {0.15, 32, 128}, {0.21, 2, 32}, {1.5, 2, 32}, {2, 1, 16}}) {
    const dWorldID world = dWorldCreate();
    dWorldSetGravity(world, 0, 0, -9.81);
    dWorldSetERP(world, 0.2);
    dWorldSetCFM(world, 1e-5);
    const dJointGroupID joints = dJointGroupCreate(0);
    const Geom floor(ground), body(table);
    params.region_merge = expected.merge;
    REQUIRE(dGeomGpuTriMeshSetParams(body.id, &params) == dGPUTRIMESH_OK);
    params.region_merge = 100;  // the smaller of the two counts
    REQUIRE(dGeomGpuTriMeshSetParams(floor.id, &params) == dGPUTRIMESH_OK);
    const dBodyID b = dBodyCreate(world);
    dMass mass;
    dMassSetBoxTotal(&mass, 1, 4, 1.2, 0.4);
    dBodySetMass(b, &mass);
    dGeomSetBody(body.id, b);
    dBodySetPosition(b, 0.03, 0.02, 0.2899);
    const auto regionsOf = [](const Known& known) {
      std::set<int> regions;
      for (const auto& d : known.data) regions.insert(d.region);
      return regions.size();
    };
    const Known all = collideEx(body.id, floor.id);
    CHECK(regionsOf(all) == expected.regions);
    CHECK(all.contacts.size() == expected.contacts);
    for (int step = 0; step < 400; ++step) {
      dJointGroupEmpty(joints);
      const Known known = collideEx(body.id, floor.id);
      REQUIRE(known.contacts.size() <= expected.contacts);  // a foot may be off the floor by rounding
      for (const dContactGeom& geom : known.contacts) {
        dContact contact{};
        contact.surface.mode = dContactApprox1;
        contact.surface.mu = 1;
        contact.geom = geom;
        dJointAttach(dJointCreateContact(world, joints, &contact), dGeomGetBody(geom.g1), dGeomGetBody(geom.g2));
      }
      dWorldQuickStep(world, 0.005);
    }
    const dReal* x = dBodyGetPosition(b);
    const dReal* r = dBodyGetRotation(b);
    CHECK(std::hypot(x[0] - 0.03, x[1] - 0.02) < 1e-4);
    CHECK(std::fabs(x[2] - 0.29) < 1e-3);
    CHECK(r[10] > 1 - 1e-8);
    dJointGroupDestroy(joints);
    dGeomSetBody(body.id, nullptr);
    dWorldDestroy(world);
  }
}

TEST_CASE("without history a query depends on its pose alone") {
  const OdeSession session;
  const Data large(scenes::makeBox({4, 4, 4}, 1)), small(scenes::makeBox({1, 1, 1}, 1));
  dGpuTriMeshParams params;
  dGpuTriMeshParamsInit(&params);
  CHECK(params.history == dGPUTRIMESH_HISTORY_ON);
  // A contained box wanders past the middle: the nearest way out is to the left at first, then to the right.
  const auto walk = [&](int historyOfA, int historyOfB) {
    const Geom a(large), b(small);
    params.history = historyOfA;
    REQUIRE(dGeomGpuTriMeshSetParams(a.id, &params) == dGPUTRIMESH_OK);
    params.history = historyOfB;
    REQUIRE(dGeomGpuTriMeshSetParams(b.id, &params) == dGPUTRIMESH_OK);
    int differences = 0;
    for (int i = 0; i <= 10; ++i) {
      const Geom freshA(large), freshB(small);
      for (const dGeomID g : {b.id, freshB.id}) dGeomSetPosition(g, -0.5 + 0.1 * i, 0.1, 0.2);
      const Known known = collideEx(a.id, b.id), fresh = collideEx(freshA.id, freshB.id);
      REQUIRE_FALSE(known.contacts.empty());
      REQUIRE(known.contacts.size() == fresh.contacts.size());
      for (std::size_t k = 0; k < known.contacts.size(); ++k) {
        const dReal *n = known.contacts[k].normal, *f = fresh.contacts[k].normal;
        differences += !std::equal(n, n + 3, f);
      }
    }
    return differences;
  };
  CHECK(walk(dGPUTRIMESH_HISTORY_ON, dGPUTRIMESH_HISTORY_ON) > 0);
  CHECK(walk(dGPUTRIMESH_HISTORY_OFF, dGPUTRIMESH_HISTORY_ON) == 0);
  CHECK(walk(dGPUTRIMESH_HISTORY_ON, dGPUTRIMESH_HISTORY_OFF) == 0);
  params.history = 2;
  const Geom a(large);
  CHECK(dGeomGpuTriMeshSetParams(a.id, &params) == dGPUTRIMESH_ERROR_ARGUMENT);
}

TEST_CASE("arguments of dGpuTriMeshCollideEx") {
  const OdeSession session;
  const Data sphere(scenes::makeSphere(1, 2));
  const Geom a(sphere), b(sphere);
  dGeomSetPosition(b.id, 1.8, 0, 0);
  const dGeomID other = dCreateSphere(nullptr, 1);
  dContact contacts[8];
  dGpuTriMeshContactData data[8];
  const auto call = [&](dGeomID o1, dGeomID o2, int flags, dContactGeom* contact, int skip, dGpuTriMeshContactData* to,
                        int dataSkip) { return dGpuTriMeshCollideEx(o1, o2, flags, contact, skip, to, dataSkip); };
  constexpr int kSkip = sizeof(dContact), kDataSkip = sizeof(dGpuTriMeshContactData);
  const int n = call(a.id, b.id, 8, &contacts[0].geom, kSkip, data, kDataSkip);
  CHECK(n > 0);
  CHECK(n <= 8);
  CHECK(call(a.id, b.id, 8, &contacts[0].geom, kSkip, nullptr, 0) == n);
  CHECK(call(a.id, a.id, 8, &contacts[0].geom, kSkip, data, kDataSkip) == 0);
  CHECK(call(a.id, other, 8, &contacts[0].geom, kSkip, data, kDataSkip) == dGPUTRIMESH_ERROR_CLASS);
  CHECK(call(nullptr, b.id, 8, &contacts[0].geom, kSkip, data, kDataSkip) == dGPUTRIMESH_ERROR_CLASS);
  CHECK(call(a.id, b.id, 0, &contacts[0].geom, kSkip, data, kDataSkip) == dGPUTRIMESH_ERROR_ARGUMENT);
  CHECK(call(a.id, b.id, 8, nullptr, kSkip, data, kDataSkip) == dGPUTRIMESH_ERROR_ARGUMENT);
  CHECK(call(a.id, b.id, 8, &contacts[0].geom, 8, data, kDataSkip) == dGPUTRIMESH_ERROR_ARGUMENT);
  CHECK(call(a.id, b.id, 8, &contacts[0].geom, kSkip, data, kDataSkip - 1) == dGPUTRIMESH_ERROR_ARGUMENT);
  // Wider elements than needed: what lies between stays as it is.
  struct Wide {
    dGpuTriMeshContactData data;
    double mine;
  } wide[8];
  for (Wide& w : wide) w.mine = 42;
  CHECK(call(a.id, b.id, 8, &contacts[0].geom, kSkip, &wide[0].data, sizeof(Wide)) == n);
  for (int i = 0; i < n; ++i) {
    CHECK(wide[i].data.id == data[i].id);
    CHECK(wide[i].mine == 42);
  }
  // "Any contacts": pairs of triangles, named by these.
  const int flags = static_cast<int>(8u | CONTACTS_UNIMPORTANT);
  const int any = call(a.id, b.id, flags, &contacts[0].geom, kSkip, data, kDataSkip);
  REQUIRE(any > 0);
  for (int i = 0; i < any; ++i) {
    CHECK((data[i].feature == dGPUTRIMESH_FEATURE_FACE || data[i].feature == dGPUTRIMESH_FEATURE_COPLANAR));
    CHECK(data[i].coherence == -1);
    CHECK(data[i].vertex1 == -1);
  }
  dGeomDestroy(other);
}
