// SPDX-License-Identifier: BSD-3-Clause
// Bodies that come to a sheet from behind, against the side that its triangles face: they are held there.
#include <functional>
#include <string>
#include <vector>

#include "base/vectors.h"
#include "support/bodies.h"
#include "support/catch.h"
#include "support/shell_scenes.h"

using namespace otg;
using namespace otg::test;

namespace {

constexpr double kHalf = 0.15, kRound = 0.05;  // of all bodies, along z; of capsules

/// Gravity draws the body up, to the back of what lies above it.
class Lift {
 public:
  Lift(const Body& what, const Vec3d& from) : world_(1, 9.81), geom_(what.make(world_.space())) {
    dMass mass;
    dMassSetBoxTotal(&mass, 1, 0.4, 0.3, 2 * kHalf);
    body_ = world_.addBody(geom_, mass);
    dBodySetPosition(body_, from.x, from.y, from.z);
    dBodySetAngularDamping(body_, 0.02);
  }
  dSpaceID space() const { return world_.space(); }
  Vec3d position() const {
    const dReal* const p = dBodyGetPosition(body_);
    return {p[0], p[1], p[2]};
  }
  /// The highest that it comes to.
  double run(int steps) {
    double highest = position().z;
    for (int i = 0; i < steps; ++i) {
      world_.step(1, 1.0 / 120);
      highest = std::max(highest, position().z);
    }
    return highest;
  }

 private:
  StepWorld world_;
  dGeomID geom_;
  dBodyID body_;
};

/// A flat sheet that faces up, and bodies in no world.
struct OnFlatSheet {
  OdeSession session;
  Data data{terrain(4, 5, 0)};
  Geom sheet{data};
  Bodies bodies{kHalf, kRound};
};

}  // namespace

TEST_CASE("bodies that come to a flat sheet from behind rest there") {
  const OdeSession session;
  const Data sheet(terrain(4, 5, 0));
  const Bodies bodies(kHalf, kRound);
  for (const Body& body : bodies.all()) {
    for (const Vec3d& from : {Vec3d{0.1, 0.2, -0.5}, Vec3d{0.03, -0.31, -0.7}}) {
      Lift lift(body, from);
      dCreateGpuTriMesh(lift.space(), sheet.id);
      const double highest = lift.run(400);
      INFO(body.name);
      CHECK(highest < -kHalf + 0.03);
      CHECK(std::abs(lift.position().z + kHalf) < 0.005);
    }
  }
}

TEST_CASE("and on the back of a terrain none gets through or gains height") {
  const OdeSession session;
  const Data ground(terrain(6, 40, 0.03));
  const Bodies bodies(kHalf, kRound);
  for (const Body& body : bodies.all()) {
    for (int k = 0; k < 6; ++k) {
      Lift lift(body, {-1 + 0.4 * k, 0.3 * k - 0.7, -1.2});
      dCreateGpuTriMesh(lift.space(), ground.id);
      const double highest = lift.run(600);
      INFO(body.name << " " << k);
      CHECK(highest < 0.2);  // of the terrain's own bumps
    }
  }
}

TEST_CASE("a ball in the groove of two pieces that face opposite ways rests on both") {
  const OdeSession session;
  // Two sides of a groove along y, one turned over.
  scenes::MeshArrays mesh;
  mesh.vertices = {{0, -2, 0}, {0, 2, 0}, {1, -2, 1}, {1, 2, 1}, {0, -2, 0}, {0, 2, 0}, {-1, -2, 1}, {-1, 2, 1}};
  mesh.triangles = {{{0, 2, 3}}, {{0, 3, 1}}, {{4, 6, 7}}, {{4, 7, 5}}};
  const Data groove(mesh);
  StepWorld world(1);
  dCreateGpuTriMesh(world.space(), groove.id);
  dMass mass;
  dMassSetSphereTotal(&mass, 1, 0.2);
  const dBodyID body = world.addBody(dCreateSphere(world.space(), 0.2), mass);
  dBodySetPosition(body, 0.02, 0, 0.6);
  world.step(800);
  const dReal* const p = dBodyGetPosition(body);
  CHECK(std::abs(p[0]) < 0.03);
  CHECK(std::abs(p[2] - 0.2 * std::sqrt(2.0)) < 0.01);
}

TEST_CASE_METHOD(OnFlatSheet,
                 "a body that has gone through the front is held from there, also after a query without contacts") {
  for (const Body& body : bodies.all()) {
    const dGeomID geom = body.make(nullptr);
    for (int step = 0; step < 12; ++step) {  // down, and up again
      const double z = step < 6 ? 0.19 - 0.07 * step : -0.16 + 0.012 * (step - 5);
      dGeomSetPosition(geom, 0.1, 0.2, z);
      const auto contacts = test::collide(sheet.id, geom);
      INFO(body.name << " at " << z);
      REQUIRE(contacts.empty() == (std::abs(z) > kHalf));
      if (contacts.empty()) continue;
      for (const dContactGeom& c : contacts) CHECK(c.normal[2] < -0.9);
    }
    dGeomDestroy(geom);
  }
}

TEST_CASE("a body between two storeys of a sheet falls on the lower one") {
  const OdeSession session;
  const auto storeys = [](float height) {
    scenes::MeshArrays upper = terrain(4, 3, 0);
    for (Vec3f& v : upper.vertices) v.z += height;
    return scenes::merge({terrain(10, 3, 0), upper});
  };
  Draw draw(7);
  for (int i = 0; i < 400; ++i) {
    // A cylinder or a box, turned, half-way between the two.
    const double radius = draw.uniform(0.1, 0.3), half = radius * draw.uniform(0.1, 2);
    const double reach = std::sqrt(2 * radius * radius + half * half), height = reach * draw.uniform(1.4, 2.6);
    const Data data(storeys(static_cast<float>(height)));
    StepWorld world(1);
    dCreateGpuTriMesh(world.space(), data.id);
    dMass mass;
    dMassSetBoxTotal(&mass, 1, 2 * radius, 2 * radius, 2 * half);
    const dGeomID geom = i % 2 == 0 ? dCreateCylinder(world.space(), radius, 2 * half)
                                    : dCreateBox(world.space(), 2 * radius, 2 * radius, 2 * half);
    const dBodyID body = world.addBody(geom, mass);
    const Vec3d axis = draw.direction();
    const double angle = draw.uniform(0, 6.28);
    setPose(geom, makePose(axis, angle, {draw.uniform(-1, 1), draw.uniform(-1, 1), 0.55 * height}));
    world.step(60, 1.0 / 60);
    INFO(i << ", " << height << " for " << reach);
    CHECK(dBodyGetPosition(body)[2] > -0.1);
  }
}

TEST_CASE_METHOD(OnFlatSheet, "a body that is put in front of the sheet is pushed to the front, wherever it was") {
  for (const Body& body : bodies.all()) {
    const dGeomID geom = body.make(nullptr);
    const auto normalAt = [&](double z) {
      dGeomSetPosition(geom, 0.1, 0.2, z);
      const auto contacts = test::collide(sheet.id, geom);
      return contacts.empty() ? 0.0 : contacts[0].normal[2];  // it pushes the sheet
    };
    INFO(body.name);
    CHECK(normalAt(-kHalf - 0.02) == 0.0);
    CHECK(normalAt(-kHalf + 0.01) > 0.9);
    CHECK(normalAt(kHalf + 0.5) == 0.0);
    CHECK(normalAt(kHalf - 0.01) < -0.9);
    dGeomDestroy(geom);
  }
}

TEST_CASE_METHOD(OnFlatSheet, "without temporal coherence what is behind a sheet is drawn to its front") {
  for (const int geomClass : {dSphereClass, dBoxClass, dCapsuleClass, dCylinderClass}) {
    dGeomGpuTriMeshEnableTC(sheet.id, geomClass, 0);
  }
  for (const Body& body : bodies.all()) {
    if (body.name == "mesh" || body.name == "convex") continue;
    const dGeomID geom = body.make(nullptr);
    for (const double z : {-kHalf - 0.02, -kHalf + 0.01}) {
      dGeomSetPosition(geom, 0.1, 0.2, z);
      const auto contacts = test::collide(sheet.id, geom);
      INFO(body.name << " " << z);
      CHECK(contacts.empty() == (z < -kHalf));
      if (!contacts.empty()) CHECK(contacts[0].normal[2] < -0.9);
    }
    dGeomDestroy(geom);
  }
}
