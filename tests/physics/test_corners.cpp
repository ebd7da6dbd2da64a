// SPDX-License-Identifier: BSD-3-Clause
// Inner corners: the overlap of a body with two walls is one region, and each wall must push by its own depth.
#include <algorithm>
#include <cmath>

#include <ode_trimesh_gpu/ode_trimesh_gpu.h>

#include "physics/rig.h"
#include "physics/suite.h"
#include "scenes/concave_meshes.h"
#include "support/catch.h"
#include "support/draw.h"

using namespace otg;
using namespace otg::physics;
using otg::test::Draw;

namespace {

constexpr double kWall = 0.3;

ShapePointer makeL(int levels) {
  return makeStaticShape(scenes::subdivided(scenes::makeCorner(1, kWall, 0.8), levels));
}

double alongWalls(const Contact& contact) {
  return std::max(std::abs(contact.normal.x()), std::abs(contact.normal.z()));
}

Vec randomAxis(Draw& draw) {
  return Vec(draw.uniform(-1, 1), draw.uniform(-1, 1), draw.uniform(-1, 1));
}

}  // namespace

TEST_CASE("In an inner corner no contact is deeper than the overlap, and both walls push") {
  const OdeSession session;
  const int levels = GENERATE(0, 1);
  const ShapePointer corner = makeL(levels);
  Draw draw(11);
  int bothWalls = 0, tilted = 0, all = 0;
  for (int i = 0; i < 150; ++i) {
    Case run;
    run.model = Model::kSolid;
    run.order = i % 2 == 0 ? Order::kAsMade : Order::kReversed;
    Rig rig(run);
    rig.addStatic(corner, {0, 0, 0});
    const Vec size(draw.uniform(0.2, 0.6), draw.uniform(0.2, 0.6), draw.uniform(0.2, 0.6));
    const double intoWall = std::pow(10, draw.uniform(-6, -2)), intoFloor = std::pow(10, draw.uniform(-6, -2));
    const double degrees = i % 5 == 0 ? 0 : draw.uniform(0, 0.02);
    const Vec place = Vec(kWall - intoWall, 0, kWall - intoFloor) + 0.5 * size.cwiseProduct(Vec(1, 0, 1));
    rig.addBody(makeShape(scenes::subdivided(scenes::makeBox({size.x(), size.y(), size.z()}), levels)), place,
                about(randomAxis(draw), degrees));
    const double overlap = std::max(intoWall, intoFloor) + degrees * 3.14159 / 180 * size.norm();
    const std::vector<Contact> contacts = rig.contactsNow();
    CAPTURE(i, levels, intoWall, intoFloor, degrees);
    REQUIRE_FALSE(contacts.empty());
    bool wall = false, floor = false;
    for (const Contact& contact : contacts) {
      CHECK(contact.depth < 1.5 * overlap);
      ++all;
      tilted += alongWalls(contact) < std::cos(5 * 3.14159 / 180);
      wall = wall || std::abs(contact.normal.x()) > 0.9;
      floor = floor || std::abs(contact.normal.z()) > 0.9;
    }
    bothWalls += wall && floor;
  }
  CHECK(bothWalls >= 135);
  CHECK(tilted < all / 10);
}

TEST_CASE("A body is not thrown out of an inner corner") {
  const OdeSession session;
  for (const char* name : {"corner", "corner_fine", "corner_cylinder", "corner_room", "corner_room_fine", "tray",
                           "slot", "slot_fine", "bin", "vblock"}) {
    const Scene* scene = findScene(name);
    REQUIRE(scene);
    for (const Stepping stepping : {kQ20, kW}) {
      Case run = runsOf(*scene, Form::kOurs, Model::kSolid, Extent::kPlain).front();
      run.stepping = stepping;
      const Result result = runCase(*scene, run);
      INFO(name);
      CHECK(result.error.empty());
      CHECK(result.measures.at("thrown") == 0);
      CHECK(result.measures.at("finite") == 1);
    }
  }
}

TEST_CASE("ODE's box is not thrown out of an inner corner of a mesh") {
  const OdeSession session;
  Draw draw(12);
  const scenes::MeshArrays mesh = scenes::makeCorner(1, kWall, 0.8);
  const dGpuTriMeshDataID data = dGpuTriMeshDataCreate();
  REQUIRE(dGpuTriMeshDataBuildSingle(data, mesh.vertices.data(), 0, static_cast<int>(mesh.vertices.size()),
                                     mesh.triangles.data(), static_cast<int>(3 * mesh.triangles.size()),
                                     0) == dGPUTRIMESH_OK);
  for (int i = 0; i < 30; ++i) {
    const dWorldID world = dWorldCreate();
    const dSpaceID space = dSimpleSpaceCreate(nullptr);
    const dJointGroupID joints = dJointGroupCreate(0);
    dWorldSetGravity(world, 0, 0, -9.81);
    dWorldSetERP(world, 0.2);
    dWorldSetCFM(world, 1e-5);
    dCreateGpuTriMesh(space, data);
    const Vec size(draw.uniform(0.2, 0.6), draw.uniform(0.2, 0.6), draw.uniform(0.2, 0.6));
    const dBodyID body = dBodyCreate(world);
    const dGeomID box = dCreateBox(space, size.x(), size.y(), size.z());
    dMass mass;
    dMassSetBoxTotal(&mass, 1, size.x(), size.y(), size.z());
    dBodySetMass(body, &mass);
    dGeomSetBody(box, body);
    dBodySetPosition(body, kWall + size.x() / 2 + 0.01, 0, kWall + size.z() / 2 + 1e-3);
    dBodySetLinearVel(body, -draw.uniform(0.2, 0.6), 0, 0);
    struct Step {
      dWorldID world;
      dJointGroupID joints;
    } step{world, joints};
    double before = 1, thrown = 0;
    for (int k = 0; k < 240; ++k) {
      dSpaceCollide(space, &step, [](void* self, dGeomID a, dGeomID b) {
        const Step& at = *static_cast<Step*>(self);
        dContact contacts[32];
        const int count = dCollide(a, b, 32, &contacts[0].geom, sizeof(dContact));
        for (int c = 0; c < count; ++c) {
          contacts[c].surface = {};
          contacts[c].surface.mode = dContactApprox1;
          contacts[c].surface.mu = 0.5;
          dJointAttach(dJointCreateContact(at.world, at.joints, &contacts[c]), dGeomGetBody(contacts[c].geom.g1),
                       dGeomGetBody(contacts[c].geom.g2));
        }
      });
      dWorldQuickStep(world, 1.0 / 240);
      dJointGroupEmpty(joints);
      const dReal* v = dBodyGetLinearVel(body);
      const double now = std::hypot(v[0], v[1], v[2]);
      thrown = std::max(thrown, now - before);
      before = now;
    }
    CAPTURE(i);
    CHECK(thrown < 0.3);
    dJointGroupDestroy(joints);
    dSpaceDestroy(space);
    dWorldDestroy(world);
  }
  dGpuTriMeshDataDestroy(data);
}
