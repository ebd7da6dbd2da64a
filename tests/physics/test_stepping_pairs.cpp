// SPDX-License-Identifier: BSD-3-Clause
// Bodies of meshes on ODE's heightfield, and dTriMesh geoms that collide through this library, in a stepping world: at
// rest, sliding and rolling, beside ODE's own bodies.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <functional>
#include <memory>
#include <string>

#include "base/vectors.h"
#include "scenes/heightfield_geom.h"
#include "support/catch.h"
#include "support/ode_trimesh.h"
#include "support/ode_world.h"
#include "support/step_world.h"

using namespace otg;
using namespace otg::test;

namespace {

constexpr double kRadius = 0.4;
constexpr double kGravity = 9.81;

Vec3d toVec(const dReal* p) {
  return {p[0], p[1], p[2]};
}

struct Start {
  Vec3d position{0, 0, 0}, velocity{0, 0, 0}, spin{0, 0, 0};
  double tilt = 0;  ///< about x
  double mu = 1;
  int steps = 400;
};

struct End {
  Vec3d position{0, 0, 0}, velocity{0, 0, 0}, spin{0, 0, 0};
  double energy = 0;      ///< at the end
  double mostEnergy = 0;  ///< at any step
};

using Maker = std::function<dGeomID(dSpaceID)>;

double energyOf(dBodyID body, const dMass& mass) {
  const Vec3d v = toVec(dBodyGetLinearVel(body)), w = toVec(dBodyGetAngularVel(body));
  dVector3 own;
  dBodyVectorFromWorld(body, w.x, w.y, w.z, own);
  double spin = 0;
  for (int k = 0; k < 3; ++k) spin += mass.I[5 * k] * own[k] * own[k];
  return 0.5 * mass.mass * otgDot(v, v) + 0.5 * spin + mass.mass * kGravity * dBodyGetPosition(body)[2];
}

End letGo(const Maker& ground, const Maker& body, const dMass& mass, const Start& start) {
  StepWorld world(start.mu, -kGravity);
  ground(world.space());
  const dBodyID moving = world.addBody(body(world.space()), mass);
  dMatrix3 r;
  dRFromAxisAndAngle(r, 1, 0, 0, start.tilt);
  dBodySetRotation(moving, r);
  dBodySetPosition(moving, start.position.x, start.position.y, start.position.z);
  dBodySetLinearVel(moving, start.velocity.x, start.velocity.y, start.velocity.z);
  dBodySetAngularVel(moving, start.spin.x, start.spin.y, start.spin.z);
  End end;
  end.mostEnergy = energyOf(moving, mass);
  for (int i = 0; i < start.steps; ++i) {
    world.step(1);
    end.energy = energyOf(moving, mass);
    end.mostEnergy = std::max(end.mostEnergy, end.energy);
  }
  end.position = toVec(dBodyGetPosition(moving));
  end.velocity = toVec(dBodyGetLinearVel(moving));
  end.spin = toVec(dBodyGetAngularVel(moving));
  return end;
}

/// Ground of 60 x 24 cells of 0.25 that falls by `slope` along x, with its middle at height 0.
scenes::HeightGrid makeGrid(double slope) {
  scenes::HeightGrid grid;
  grid.columns = 61;
  grid.rows = 25;
  grid.sizeX = 15;
  grid.sizeY = 6;
  scenes::setHeights(grid, [slope](double x, double) { return -slope * x; });
  return grid;
}

std::string describe(const End& e) {
  char text[256];
  std::snprintf(text, sizeof text, "at %.6f %.6f %.6f, velocity %.6f %.6f %.6f, energy %.6f, at most %.6f",
                e.position.x, e.position.y, e.position.z, e.velocity.x, e.velocity.y, e.velocity.z, e.energy,
                e.mostEnergy);
  return text;
}

/// A body or ground as ODE's own shape, as a dTriMesh and as a geom of the library's class.
struct Thing {
  Maker native, trimesh, own;
  Thing(const Maker& all) : native(all), trimesh(all), own(all) {}
  Thing(const Maker& shape, const OdeMesh& mesh, const Data& data)
      : native(shape),
        trimesh([&mesh](dSpaceID space) {
          const dGeomID geom = dCreateTriMesh(space, mesh.id, nullptr, nullptr, nullptr);
          dGpuTriMeshOverrideForgetGeom(geom);  // the one that was at this address
          return geom;
        }),
        own([&data](dSpaceID space) { return dCreateGpuTriMesh(space, data.id); }) {}
};

/// The ball's mesh is a polygon of so many sides all around. One that tips over its corners without bouncing keeps
/// 1 - 5/7 (1 - cos(2 pi / n)) of its speed each time (docs/primitives.md).
constexpr int kSides = 160;
/// The part of its speed that such a polygon loses for each metre, at most.
double lossPerMetre() {
  return 5.0 / 7 * (1 - std::cos(2 * M_PI / kSides)) / (2 * M_PI * kRadius / kSides);
}

}  // namespace

TEST_CASE("a ball that is a mesh rolls on a heightfield as far as dSphere does, and never gains energy") {
  const OdeSession session;
  const Data ball(scenes::makeSphere(kRadius, 5));
  dMass mass;
  dMassSetSphereTotal(&mass, 1, kRadius);
  const Maker mesh = [&](dSpaceID s) { return dCreateGpuTriMesh(s, ball.id); };
  const Maker sphere = [](dSpaceID s) { return dCreateSphere(s, kRadius); };
  for (const double slope : {0.0, 0.05}) {
    const scenes::HeightfieldData data(makeGrid(slope));
    const Maker field = [&](dSpaceID s) {
      return data.makeGeom(s, Transformd{{1, 0, 0, 0, 1, 0, 0, 0, 1}, {0, 0, 0}});
    };
    Start start;
    start.position = {-4, 0.13, 4 * slope + kRadius * std::sqrt(1 + slope * slope)};
    start.velocity = {2, 0, -2 * slope};
    start.spin = {0, norm(start.velocity) / kRadius, 0};
    const End ours = letGo(field, mesh, mass, start), native = letGo(field, sphere, mass, start);
    INFO("slope " << slope << "\n ours   " << describe(ours) << "\n native " << describe(native));
    const double far = native.position.x - start.position.x, way = ours.position.x - start.position.x;
    const double kept = std::exp(-lossPerMetre() * far);
    CHECK(far > 3.9);
    CHECK(way > kept * far);
    CHECK(way < far + 1e-3);
    CHECK(std::abs(ours.position.y - native.position.y) < 0.01 * far);
    CHECK(std::abs(ours.position.z - (kRadius * std::sqrt(1 + slope * slope) - slope * ours.position.x)) < 1e-3);
    // No step gains any, and tipping over its edges costs it no more than it does the polygon.
    const double kinetic = 0.7 * otgDot(native.velocity, native.velocity);
    CHECK(ours.mostEnergy < native.mostEnergy + 1e-3);
    CHECK(native.energy - ours.energy < 2 * lossPerMetre() * far * kinetic + 1e-3);
    CHECK(native.energy - ours.energy > -1e-3);
  }
}

TEST_CASE("dTriMesh bodies and grounds that collide through the library rest, slide and roll as ODE's own bodies do") {
  const OdeSession session;
  REQUIRE(dGpuTriMeshOverrideTriMeshWith(dGPUTRIMESH_OVERRIDE_ALL) == dGPUTRIMESH_OK);
  const OdeMesh slabMesh(scenes::makeGround(16, 1, 64)), boxMesh(scenes::makeBox({0.6, 0.5, 0.4}, 2)),
      ballMesh(scenes::makeSphere(kRadius, 5));
  const Data slabData(slabMesh.arrays), boxData(boxMesh.arrays), ballData(ballMesh.arrays);
  const scenes::HeightfieldData flat(makeGrid(0));
  const Maker dPlane = [](dSpaceID s) { return dCreatePlane(s, 0, 0, 1, 0); };
  const Maker dBox = [](dSpaceID s) { return dCreateBox(s, 0.6, 0.5, 0.4); };
  const Maker dSphere = [](dSpaceID s) { return dCreateSphere(s, kRadius); };
  const Maker dCylinder = [](dSpaceID s) { return dCreateCylinder(s, 0.3, 0.8); };
  const Thing plane(dPlane), slab(dPlane, slabMesh, slabData);
  Thing field([&](dSpaceID s) { return flat.makeGeom(s, Transformd{{1, 0, 0, 0, 1, 0, 0, 0, 1}, {0, 0, 0}}); });
  field.native = dPlane;
  const Thing box(dBox, boxMesh, boxData), ball(dSphere, ballMesh, ballData);
  dMass boxMass, ballMass, cylinderMass;
  dMassSetBoxTotal(&boxMass, 1, 0.6, 0.5, 0.4);
  dMassSetSphereTotal(&ballMass, 1, kRadius);
  dMassSetCylinderTotal(&cylinderMass, 1, 3, 0.3, 0.8);
  const Start rest{{-3, 0.07, 0.201}}, sliding{{-3, 0.07, 0.2}, {2, 0, 0}, {0, 0, 0}, 0, 0.2, 100};
  const Start rolling{{-3, 0.07, kRadius}, {2, 0, 0}, {0, 2 / kRadius, 0}};
  const Start wheel{{-3, 0.07, 0.3}, {2, 0, 0}, {0, 2 / 0.3, 0}, M_PI / 2};
  const double ofFacets = 4 * (1 - std::exp(-4 * lossPerMetre()));
  struct Run {
    const char* name;
    const Thing &ground, &body;
    const dMass& mass;
    const Start& start;
    double tolerance;  ///< of places and speeds in the end, against ODE's own body on ODE's plane
  };
  const Run runs[] = {
      {"a box at rest on a plane", plane, box, boxMass, rest, 1e-4},
      {"a box at rest on a ground", slab, box, boxMass, rest, 1e-3},
      {"a box at rest on a heightfield", field, box, boxMass, rest, 1e-3},
      {"dBox at rest on a ground", slab, dBox, boxMass, rest, 1e-4},
      {"a box sliding on a plane", plane, box, boxMass, sliding, 1e-3},
      {"a box sliding on a ground", slab, box, boxMass, sliding, 1e-3},
      {"a box sliding on a heightfield", field, box, boxMass, sliding, 1e-3},
      {"dBox sliding on a ground", slab, dBox, boxMass, sliding, 1e-4},
      {"dSphere rolling on a ground", slab, dSphere, ballMass, rolling, 4e-4},
      {"dCylinder rolling on a ground", slab, dCylinder, cylinderMass, wheel, 4e-4},
      {"a ball rolling on a plane", plane, ball, ballMass, rolling, ofFacets},
      {"a ball rolling on a ground", slab, ball, ballMass, rolling, ofFacets},
      {"a ball rolling on a heightfield", field, ball, ballMass, rolling, ofFacets},
  };
  const auto sums = [] {
    dGpuTriMeshOverrideStats stats;
    dGpuTriMeshOverrideStatsInit(&stats);
    REQUIRE(dGpuTriMeshOverrideGetStats(&stats) == dGPUTRIMESH_OK);
    return stats;
  };
  for (const Run& run : runs) {
    const duint64 before = sums().queries;
    const End native = letGo(run.ground.native, run.body.native, run.mass, run.start);
    const End trimesh = letGo(run.ground.trimesh, run.body.trimesh, run.mass, run.start);
    CHECK(sums().queries >= before + static_cast<duint64>(run.start.steps) - 20);
    const End own = letGo(run.ground.own, run.body.own, run.mass, run.start);
    INFO(run.name << "\n dTriMesh " << describe(trimesh) << "\n own      " << describe(own) << "\n native   "
                  << describe(native));
    CHECK(norm(otgSub(trimesh.position, native.position)) < run.tolerance);
    CHECK(norm(otgSub(trimesh.velocity, native.velocity)) < run.tolerance);
    CHECK(trimesh.mostEnergy < native.mostEnergy + 1e-3);
    CHECK(norm(otgSub(trimesh.position, own.position)) < 1e-9);
    CHECK(norm(otgSub(trimesh.velocity, own.velocity)) < 1e-9);
  }
}
