// SPDX-License-Identifier: BSD-3-Clause
// Shapes of ODE's at the rims of open meshes and over convex edges, beside a dBox with the same edge; and wheels.
#include <cmath>
#include <functional>

#include "base/vectors.h"
#include "scenes/convex_geom.h"
#include "support/catch.h"
#include "support/draw.h"
#include "support/ode_world.h"
#include "support/step_world.h"

using namespace otg;
using namespace otg::test;

namespace {

Vec3d toVec(const dReal* p) {
  return {p[0], p[1], p[2]};
}

/// An open square in the plane z = 0, from -half to half, that faces up.
scenes::MeshArrays makeSheet(double half, int cells) {
  scenes::MeshArrays sheet;
  const auto n = static_cast<std::uint32_t>(cells) + 1;
  for (std::uint32_t y = 0; y < n; ++y) {
    for (std::uint32_t x = 0; x < n; ++x) {
      sheet.vertices.push_back({float(half * (2.0 * x / cells - 1)), float(half * (2.0 * y / cells - 1)), 0});
    }
  }
  for (std::uint32_t y = 0; y + 1 < n; ++y) {
    for (std::uint32_t x = 0; x + 1 < n; ++x) {
      const std::uint32_t v = n * y + x;
      sheet.triangles.push_back({{v, v + 1, v + n + 1}});
      sheet.triangles.push_back({{v, v + n + 1, v + n}});
    }
  }
  return sheet;
}

/// A table of 4 x 4 with its top at z = 0.
enum class Table { kBox, kSheet, kSlab };

struct Run {
  std::function<dGeomID(dSpaceID)> make;
  dMass mass;
  Vec3d position, velocity, spin;
  double angle = 0;  ///< about x
};

struct State {
  Vec3d position, velocity, up;
};

State letGo(Table table, const Run& run, int steps) {
  const Data sheet(makeSheet(2, 16)), slab(scenes::makeGround(4, 1, 16));
  StepWorld world(1);
  if (table == Table::kBox) dGeomSetPosition(dCreateBox(world.space(), 4, 4, 1), 0, 0, -0.5);
  if (table == Table::kSheet) dCreateGpuTriMesh(world.space(), sheet.id);
  if (table == Table::kSlab) dCreateGpuTriMesh(world.space(), slab.id);
  const dBodyID body = world.addBody(run.make(world.space()), run.mass);
  dMatrix3 r;
  dRFromAxisAndAngle(r, 1, 0, 0, run.angle);
  dBodySetRotation(body, r);
  dBodySetPosition(body, run.position.x, run.position.y, run.position.z);
  dBodySetLinearVel(body, run.velocity.x, run.velocity.y, run.velocity.z);
  dBodySetAngularVel(body, run.spin.x, run.spin.y, run.spin.z);
  world.step(steps);
  const dReal* const m = dBodyGetRotation(body);
  return {toVec(dBodyGetPosition(body)), toVec(dBodyGetLinearVel(body)), {m[2], m[6], m[10]}};
}

}  // namespace

TEST_CASE("a sphere at a rim is pushed away from the nearest point of the rim, and not at all from behind") {
  const OdeSession session;
  const Data data(makeSheet(1, 8));
  const Geom sheet(data);
  const dGeomID sphere = dCreateSphere(nullptr, 0.3);
  dGeomGpuTriMeshEnableTC(sheet.id, dSphereClass, 0);  // each pose by itself
  Draw draw(3);
  int touching = 0;
  for (int i = 0; i < 2000; ++i) {
    // Around one side of the square.
    const Vec3d p{1 + draw.uniform(-0.1, 0.35), draw.uniform(-0.8, 0.8), draw.uniform(0.01, 0.35)};
    dGeomSetPosition(sphere, p.x, p.y, p.z);
    const Vec3d nearest{std::min(p.x, 1.0), p.y, 0};
    const double distance = norm(otgSub(p, nearest));
    const auto contacts = test::collide(sphere, sheet.id);
    REQUIRE(contacts.size() == (distance < 0.3 ? 1 : 0));
    if (contacts.empty()) continue;
    ++touching;
    REQUIRE(std::abs(contacts[0].depth - (0.3 - distance)) < 1e-7);
    REQUIRE(norm(otgSub(toVec(contacts[0].normal), otgScale(otgSub(p, nearest), 1 / distance))) < 1e-6);
    // From beyond the rim and below its plane.
    dGeomSetPosition(sphere, 1.05, p.y, -p.z);
    REQUIRE(test::collide(sphere, sheet.id).empty());
  }
  CHECK(touching > 500);
  dGeomDestroy(sphere);
}

TEST_CASE("a capsule at a rim is pushed away from what of the rim is nearest to its axis") {
  const OdeSession session;
  const Data data(makeSheet(1, 8));
  const Geom sheet(data);
  const dGeomID capsule = dCreateCapsule(nullptr, 0.3, 0.8);
  dGeomGpuTriMeshEnableTC(sheet.id, dCapsuleClass, 0);  // each pose by itself
  Draw draw(3);
  int touching = 0;
  for (int i = 0; i < 1000; ++i) {
    // Its axis along the rim (y), to within two degrees.
    const double slope = draw.uniform(-0.035, 0.035);
    const Vec3d p{1 + draw.uniform(-0.1, 0.35), draw.uniform(-0.3, 0.3), draw.uniform(0.05, 0.35)};
    dMatrix3 r;
    dRFromAxisAndAngle(r, 1, 0, 0, M_PI / 2 + slope);
    dGeomSetRotation(capsule, r);
    dGeomSetPosition(capsule, p.x, p.y, p.z);
    const Vec3d axis{r[2], r[6], r[10]};
    double least = 1;
    for (const double end : {-0.4, 0.4}) {  // the sheet is flat: an end of the axis is nearest
      const Vec3d q = otgAdd(p, otgScale(axis, end));
      least = std::min(least, norm(otgSub(q, Vec3d{std::min(q.x, 1.0), q.y, 0})));
    }
    const auto contacts = test::collide(capsule, sheet.id);
    REQUIRE(contacts.empty() == !(least < 0.3));
    if (contacts.empty()) continue;
    ++touching;
    REQUIRE(std::abs(contacts[0].depth - (0.3 - least)) < 1e-7);
    // The direction to the rim turns along an axis that is tilted, by more than 3 degrees where it is near.
    REQUIRE(contacts.size() <= 9);
    for (const dContactGeom& c : contacts) {
      INFO("axis through " << p.x << " " << p.y << " " << p.z << " slope " << slope << ": normal " << c.normal[0] << " "
                           << c.normal[1] << " " << c.normal[2] << " depth " << c.depth << " at " << c.pos[0] << " "
                           << c.pos[1] << " " << c.pos[2]);
      REQUIRE(c.normal[2] > 0);
      REQUIRE(c.normal[0] > -1e-6);
      REQUIRE(std::abs(c.normal[1]) < 0.05);
    }
  }
  CHECK(touching > 300);
  dGeomDestroy(capsule);
}

TEST_CASE("a sphere and a capsule that roll over a rim fall off as they do over the edge of a dBox") {
  const OdeSession session;
  Run ball{[](dSpaceID s) { return dCreateSphere(s, 0.3); }, {}, {1, 0.1, 0.3}, {1, 0, 0}, {0, 1 / 0.3, 0}};
  dMassSetSphereTotal(&ball.mass, 1, 0.3);
  Run roller{
      [](dSpaceID s) { return dCreateCapsule(s, 0.3, 0.8); }, {}, {1, 0.1, 0.3}, {1, 0, 0}, {0, 1 / 0.3, 0}, M_PI / 2};
  dMassSetCapsuleTotal(&roller.mass, 1, 3, 0.3, 0.8);
  for (const Run& run : {ball, roller}) {
    CHECK(letGo(Table::kBox, run, 300).position.z < -0.5);
    // On the flat, at the edge, and after it has left.
    for (const int steps : {150, 220, 300}) {
      const State box = letGo(Table::kBox, run, steps);
      for (const Table table : {Table::kSheet, Table::kSlab}) {
        const State mesh = letGo(table, run, steps);
        INFO("table " << static_cast<int>(table) << ", rolled by " << run.angle << ", steps " << steps);
        CHECK(norm(otgSub(mesh.position, box.position)) < 0.01);
        CHECK(norm(otgSub(mesh.velocity, box.velocity)) < 0.05);
      }
    }
  }
}

TEST_CASE("a box and a cylinder over a rim have the contacts that they have over the edge of a slab") {
  const OdeSession session;
  const Data sheetData(makeSheet(2, 16)), slabData(scenes::makeGround(4, 1, 16));
  const Geom sheet(sheetData), slab(slabData);
  Draw draw(4);
  for (const dGeomID shape : {dCreateBox(nullptr, 1, 0.6, 0.3), dCreateCylinder(nullptr, 0.3, 0.8)}) {
    int touching = 0, different = 0;
    for (int i = 0; i < 500; ++i) {
      const Transformd pose = makePose(draw.direction(), draw.uniform(-3, 3),
                                       {2 + draw.uniform(-0.3, 0.3), draw.uniform(-1, 1), draw.uniform(0, 0.5)});
      dMatrix3 r{};
      for (int row = 0; row < 3; ++row) {
        for (int column = 0; column < 3; ++column) r[4 * row + column] = pose.r[3 * row + column];
      }
      dGeomSetRotation(shape, r);
      dGeomSetPosition(shape, pose.t.x, pose.t.y, pose.t.z);
      const auto over = test::collide(shape, sheet.id), expected = test::collide(shape, slab.id);
      double depth[2] = {0, 0};
      Vec3d normal[2] = {{0, 0, 0}, {0, 0, 0}};
      for (int k = 0; k < 2; ++k) {
        for (const dContactGeom& c : k == 0 ? over : expected) {
          if (c.depth <= depth[k]) continue;
          depth[k] = c.depth;
          normal[k] = toVec(c.normal);
        }
      }
      if (depth[1] > 0.05 || expected.empty()) continue;
      ++touching;
      const bool same = std::abs(depth[0] - depth[1]) < 1e-3 && norm(otgSub(normal[0], normal[1])) < 0.02;
      different += same ? 0 : 1;
      if (!same && different < 6) {
        UNSCOPED_INFO("pose " << i << " depth " << depth[0] << " of slab " << depth[1] << " normal " << normal[0].x
                              << " " << normal[0].y << " " << normal[0].z << " of slab " << normal[1].x << " "
                              << normal[1].y << " " << normal[1].z << " contacts " << over.size() << " "
                              << expected.size());
      }
    }
    CHECK(touching > 25);
    CHECK(different <= touching / 50);
    dGeomDestroy(shape);
  }
}

TEST_CASE("a box over a rim rests with its middle inside and tips with its middle outside, as on a dBox") {
  const OdeSession session;
  Run box{[](dSpaceID s) { return dCreateBox(s, 1, 0.6, 0.3); }, {}, {1.9, 0.1, 0.15}, {0, 0, 0}, {0, 0, 0}};
  dMassSetBoxTotal(&box.mass, 1, 1, 0.6, 0.3);
  for (const Table table : {Table::kSheet, Table::kSlab}) {
    INFO("table " << static_cast<int>(table));
    box.position.x = 1.9;
    const State resting = letGo(table, box, 400);
    CHECK(norm(otgSub(resting.position, Vec3d{1.9, 0.1, 0.15})) < 2e-3);
    CHECK(resting.up.z > 0.9999);
    box.position.x = 2.1;
    // Until it has left the edge: below it a box has a side, and a sheet has none.
    const State native = letGo(Table::kBox, box, 120), tipping = letGo(table, box, 120);
    CHECK(native.up.z < 0.9);
    CHECK(std::abs(std::acos(native.up.z) - std::acos(tipping.up.z)) < 0.1);
    CHECK(norm(otgSub(native.position, tipping.position)) < 0.05);
  }
}

TEST_CASE("a mesh box comes to rest on planes with negative offsets where a dBox does") {
  const OdeSession session;
  dMass mass;
  dMassSetBoxTotal(&mass, 1, 0.6, 0.5, 0.4);
  const Data data(scenes::makeBox({0.6, 0.5, 0.4}, 3));
  const auto run = [&](bool isMesh) {
    StepWorld world(1);
    dCreatePlane(world.space(), 0, 0, 1, -2);
    dCreatePlane(world.space(), 1, 0, 0, -1);
    const dBodyID body = world.addBody(
        isMesh ? dCreateGpuTriMesh(world.space(), data.id) : dCreateBox(world.space(), 0.6, 0.5, 0.4), mass);
    dBodySetPosition(body, -0.5, 0, -1.6);
    dBodySetLinearVel(body, -2, 0, 0);
    world.step(600);
    return toVec(dBodyGetPosition(body));
  };
  const Vec3d mesh = run(true), native = run(false);
  CHECK(std::abs(mesh.z + 1.8) < 1e-3);
  CHECK(mesh.x > -0.7 - 1e-2);
  CHECK(norm(otgSub(mesh, native)) < 5e-3);
}

TEST_CASE("a sphere and a convex rest and slide on a mesh as they do on a plane") {
  const OdeSession session;
  const scenes::ConvexData polygons(scenes::makeBox({0.6, 0.5, 0.4}));
  dMass sphereMass, boxMass;
  dMassSetSphereTotal(&sphereMass, 1, 0.2);
  dMassSetBoxTotal(&boxMass, 1, 0.6, 0.5, 0.4);
  const Data sheet(makeSheet(5, 40));
  const auto run = [&](bool onMesh, bool convex, double speed) {
    const double mu = 0.3;
    StepWorld world(mu);
    if (onMesh)
      dCreateGpuTriMesh(world.space(), sheet.id);
    else
      dCreatePlane(world.space(), 0, 0, 1, 0);
    const dGeomID geom = convex ? polygons.makeGeom(world.space()) : dCreateSphere(world.space(), 0.2);
    const dBodyID body = world.addBody(geom, convex ? boxMass : sphereMass);
    dBodySetPosition(body, -3, 0.07, 0.2);
    dBodySetLinearVel(body, speed, 0, 0);
    world.step(100);
    return State{toVec(dBodyGetPosition(body)), toVec(dBodyGetLinearVel(body)), {0, 0, 1}};
  };
  for (const bool convex : {false, true}) {
    for (const double speed : {0.0, 2.0}) {
      const State plane = run(false, convex, speed), mesh = run(true, convex, speed);
      INFO((convex ? "convex" : "sphere") << " at " << speed);
      CHECK(norm(otgSub(mesh.position, plane.position)) < 1e-3);
      CHECK(norm(otgSub(mesh.velocity, plane.velocity)) < 1e-3);
      // Friction takes mu g t of the speed, from a sphere until it rolls at 5/7 of it.
      const double expected = speed == 0 ? 0 : convex ? std::max(0.0, 2 - 0.3 * 9.81 * 0.5) : 2 * 5.0 / 7;
      CHECK(std::abs(mesh.velocity.x - expected) < 0.03);
    }
  }
}

TEST_CASE("a mesh wheel rolls on a mesh road as a dConvex of the same corners rolls on ODE's plane") {
  const OdeSession session;
  constexpr int kSides = 64;
  constexpr double kRadius = 0.3, kHalf = 0.1;
  // ODE's own polygon: planes, points and polygons, to which it keeps pointers.
  std::vector<dReal> planes, points;
  std::vector<unsigned int> polygons;
  for (int i = 0; i < kSides; ++i) {
    const double angle = 2 * M_PI * i / kSides, middle = angle + M_PI / kSides;
    for (const double z : {-kHalf, kHalf}) {
      for (const double x : {kRadius * std::cos(angle), kRadius * std::sin(angle), z}) points.push_back(x);
    }
    for (const double x : {std::cos(middle), std::sin(middle), 0.0, kRadius * std::cos(M_PI / kSides)}) {
      planes.push_back(x);
    }
    const auto a = static_cast<unsigned>(2 * i), b = static_cast<unsigned>(2 * ((i + 1) % kSides));
    for (const unsigned v : {4u, a, b, b + 1, a + 1}) polygons.push_back(v);
  }
  for (const double z : {-1.0, 1.0}) {
    for (const double x : {0.0, 0.0, z, kHalf}) planes.push_back(x);
    polygons.push_back(kSides);
    for (unsigned i = 0; i < kSides; ++i) polygons.push_back(z > 0 ? 2 * i + 1 : 2 * (kSides - 1 - i));
  }
  const Data wheel(scenes::makeCylinder(kRadius, 2 * kHalf, kSides, 1)), road(makeSheet(5, 40));
  dMass mass;
  dMassSetCylinderTotal(&mass, 1, 3, kRadius, 2 * kHalf);
  const auto roll = [&](bool native) {
    StepWorld world;
    dGeomID geom = nullptr;
    if (native) {
      dCreatePlane(world.space(), 0, 0, 1, 0);
      geom = dCreateConvex(world.space(), planes.data(), kSides + 2, points.data(), 2 * kSides, polygons.data());
    } else {
      dCreateGpuTriMesh(world.space(), road.id);
      geom = dCreateGpuTriMesh(world.space(), wheel.id);
    }
    const dBodyID body = world.addBody(geom, mass);
    dMatrix3 r;
    dRFromAxisAndAngle(r, 1, 0, 0, M_PI / 2);
    dBodySetRotation(body, r);
    dBodySetPosition(body, -3, 0.07, kRadius);
    dBodySetLinearVel(body, 2, 0, 0);
    dBodySetAngularVel(body, 0, 2 / kRadius, 0);
    world.step(400);
    return State{toVec(dBodyGetPosition(body)), toVec(dBodyGetLinearVel(body)), {0, 0, 1}};
  };
  const State native = roll(true), mesh = roll(false);
  INFO("way " << mesh.position.x + 3 << " native " << native.position.x + 3 << ", speed " << mesh.velocity.x
              << " native " << native.velocity.x << " y " << mesh.position.y << " z " << mesh.position.z);
  // Facets brake both: ODE's polygon on a plane loses a seventh of its speed on this way.
  CHECK(mesh.position.x + 3 == Approx(native.position.x + 3).epsilon(0.05));
  CHECK(mesh.velocity.x == Approx(native.velocity.x).epsilon(0.1));
  CHECK(mesh.velocity.x < 2);
  CHECK(std::abs(mesh.position.y - 0.07) < 0.01);
  CHECK(std::abs(mesh.position.z - kRadius) < 2e-3);
}
