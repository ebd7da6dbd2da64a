// SPDX-License-Identifier: BSD-3-Clause
// Mesh geoms with ODE's box, capsule, cylinder and convex: against the analytic pair, mirrored, over edges, and in a
// stepping world.
#include <cmath>
#include <functional>
#include <thread>

#include "base/vectors.h"
#include "scenes/convex_geom.h"
#include "support/catch.h"
#include "support/draw.h"
#include "support/ode_trimesh.h"
#include "support/ode_world.h"
#include "support/step_world.h"
#include "truth/convex_separation.h"

using namespace otg;
using namespace otg::test;

namespace {

Vec3d toVec(const dReal* p) {
  return {p[0], p[1], p[2]};
}
const dContactGeom* deepest(const std::vector<dContactGeom>& contacts) {
  const dContactGeom* best = nullptr;
  for (const dContactGeom& c : contacts) {
    if (best == nullptr || c.depth > best->depth) best = &c;
  }
  return best;
}
/// A geom of ODE's as a body whose way out of another one is known by other means.
truth::ConvexBody bodyOf(dGeomID g) {
  truth::ConvexBody body;
  const dReal* r = dGeomGetRotation(g);
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column) body.pose.r[3 * row + column] = r[4 * row + column];
  }
  body.pose.t = toVec(dGeomGetPosition(g));
  dReal radius = 0, length = 0;
  switch (dGeomGetClass(g)) {
    case dBoxClass: {
      dVector3 side;
      dGeomBoxGetLengths(g, side);
      body.kind = truth::ConvexBody::Kind::kBox;
      body.half = otgScale(toVec(side), 0.5);
      return body;
    }
    case dCapsuleClass:
      dGeomCapsuleGetParams(g, &radius, &length);
      body.kind = truth::ConvexBody::Kind::kCapsule;
      break;
    default:
      dGeomCylinderGetParams(g, &radius, &length);
      body.kind = truth::ConvexBody::Kind::kCylinder;
  }
  body.radius = radius;
  body.length = 0.5 * length;
  return body;
}

/// How far a point is outside of a box, capsule or cylinder; not positive inside.
double outside(const truth::ConvexBody& body, const Vec3d& point) {
  const Vec3d p = otgRotateBack(body.pose, otgSub(point, body.pose.t));
  const double along = std::abs(p.z) - body.length, across = std::hypot(p.x, p.y);
  switch (body.kind) {
    case truth::ConvexBody::Kind::kBox:
      return std::max({std::abs(p.x) - body.half.x, std::abs(p.y) - body.half.y, std::abs(p.z) - body.half.z});
    case truth::ConvexBody::Kind::kCapsule:
      return std::hypot(across, std::max(along, 0.0)) - body.radius;
    default:
      return std::max(across - body.radius, along);
  }
}

void copyPose(dGeomID from, dGeomID to) {
  const dReal* p = dGeomGetPosition(from);
  dGeomSetPosition(to, p[0], p[1], p[2]);
  dGeomSetRotation(to, dGeomGetRotation(from));
}

}  // namespace

TEST_CASE("a box mesh meets box, capsule and cylinder as the box would: the least way out, by its exact depth") {
  const OdeSession session;
  const Data data(scenes::makeBox({1, 0.7, 0.4}, 2));
  const Geom mesh(data);
  const dGeomID box = dCreateBox(nullptr, 1, 0.7, 0.4);
  const dGeomID others[] = {dCreateBox(nullptr, 0.5, 0.6, 0.7), dCreateCapsule(nullptr, 0.2, 0.6),
                            dCreateCylinder(nullptr, 0.2, 0.6)};
  for (const dGeomID other : others) {
    std::mt19937 random(3);
    int shallow = 0, inaccurate = 0;
    for (int i = 0; i < 3000; ++i) {
      setRandomPose(mesh.id, random, 0.8);
      setRandomPose(other, random, 0.8);
      copyPose(mesh.id, box);
      const auto ours = test::collide(mesh.id, other, 64);
      if (i % 10 == 0) REQUIRE(sameContacts(test::collide(other, mesh.id, 64), mirrored(ours)));
      const dContactGeom* const c = deepest(ours);
      if (c != nullptr && c->depth > 0.04) continue;
      const double least = truth::leastSeparation(bodyOf(box), bodyOf(other));
      INFO("class " << dGeomGetClass(other) << " pose " << i << " least way out " << least);
      if (c == nullptr) {
        REQUIRE(least < 1e-6);
        continue;
      }
      REQUIRE(least > -1e-6);
      if (least > 0.04) continue;
      ++shallow;
      // Moving the other body against the normal by the depth takes it out, and no other way is much shorter.
      const Vec3d d = otgScale(toVec(c->normal), -1.0);
      const double along = truth::separation(bodyOf(box), bodyOf(other), d);
      // A pair of edges must be better than a face by 5 %, as in dBoxBox.
      const bool accurate = c->depth < along + 1e-6 && c->depth > 0.95 * along - 1e-6 && along < 1.05 * least + 1e-6;
      inaccurate += accurate ? 0 : 1;
      for (const dContactGeom& x : ours) {
        // In the overlap, or beside it by less than they are deep.
        REQUIRE(std::max(outside(bodyOf(box), toVec(x.pos)), outside(bodyOf(other), toVec(x.pos))) < x.depth);
        REQUIRE(x.side1 >= 0);
        REQUIRE(x.side2 == -1);
        REQUIRE(std::abs(norm(toVec(x.normal)) - 1) < 1e-12);
        REQUIRE(x.depth > 0);
      }
    }
    CHECK(shallow > 80);
    CHECK(inaccurate == 0);
  }
  for (const dGeomID other : others) dGeomDestroy(other);
  dGeomDestroy(box);
}

namespace {

enum class Ground { kPlane, kSheet, kSlab, kTwoTriangles };

scenes::MeshArrays makeSheet(int cells, double cell) {
  scenes::MeshArrays sheet;
  const auto n = static_cast<std::uint32_t>(cells) + 1;
  for (std::uint32_t y = 0; y < n; ++y) {
    for (std::uint32_t x = 0; x < n; ++x) {
      sheet.vertices.push_back({float(cell * (x - 0.5 * cells)), float(cell * (y - 0.5 * cells)), 0});
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

struct End {
  Vec3d position, velocity, spin;
};

/// Puts a body on a ground with its top at z = 0, and lets it go. A ground that is a mesh has 40 x 40 cells of 0.25.
End letGo(Ground ground, const std::function<dGeomID(dSpaceID)>& make, const dMass& mass, double height, const Vec3d& v,
          const Vec3d& spin, double tilt, int steps, double mu = 1) {
  const Data sheet(makeSheet(40, 0.25)), slab(scenes::makeGround(10, 1, 40)), large(makeSheet(1, 400));
  StepWorld world(mu);
  if (ground == Ground::kPlane) dCreatePlane(world.space(), 0, 0, 1, 0);
  if (ground == Ground::kSheet) dCreateGpuTriMesh(world.space(), sheet.id);
  if (ground == Ground::kTwoTriangles) dCreateGpuTriMesh(world.space(), large.id);
  if (ground == Ground::kSlab) dCreateGpuTriMesh(world.space(), slab.id);
  const dBodyID body = world.addBody(make(world.space()), mass);
  dMatrix3 r;
  dRFromAxisAndAngle(r, 1, 0, 0, tilt);
  dBodySetRotation(body, r);
  dBodySetPosition(body, -3, 0.07, height);
  dBodySetLinearVel(body, v.x, v.y, v.z);
  dBodySetAngularVel(body, spin.x, spin.y, spin.z);
  world.step(steps);
  CHECK(world.mostContacts() <= 16);
  return {toVec(dBodyGetPosition(body)), toVec(dBodyGetLinearVel(body)), toVec(dBodyGetAngularVel(body))};
}

}  // namespace

TEST_CASE("cylinder, capsule and box rest, slide and roll on a tessellated ground as on a plane") {
  const OdeSession session;
  dMass cylinder, box, capsule;
  dMassSetCylinderTotal(&cylinder, 1, 3, 0.3, 0.8);
  dMassSetCapsuleTotal(&capsule, 1, 3, 0.3, 0.8);
  dMassSetBoxTotal(&box, 1, 0.6, 0.5, 0.4);
  const auto makeCylinder = [](dSpaceID s) { return dCreateCylinder(s, 0.3, 0.8); };
  const auto makeCapsule = [](dSpaceID s) { return dCreateCapsule(s, 0.3, 0.8); };
  const auto makeBox = [](dSpaceID s) { return dCreateBox(s, 0.6, 0.5, 0.4); };
  const double across = M_PI / 2;
  const double rolling = 4e-4;  // a ten-thousandth of the way
  struct Run {
    const char* name;
    std::function<End(Ground)> run;
    double tolerance;
  };
  const Run runs[] = {
      {"cylinder rolling",
       [&](Ground g) {
         return letGo(g, makeCylinder, cylinder, 0.3, {2, 0, 0}, {0, 2 / 0.3, 0}, across, 400);
       },
       rolling},
      {"cylinder standing",
       [&](Ground g) {
         return letGo(g, makeCylinder, cylinder, 0.4, {0, 0, 0}, {0, 0, 0}, 0, 400);
       },
       1e-4},
      {"cylinder sliding on its end",
       [&](Ground g) {
         return letGo(g, makeCylinder, cylinder, 0.4, {2, 0, 0}, {0, 0, 0}, 0, 100, 0.2);
       },
       1e-3},
      {"cylinder dropped on its rim",
       [&](Ground g) {
         return letGo(g, makeCylinder, cylinder, 0.6, {0, 0, 0}, {0, 0, 0}, 0.7, 600);
       },
       1e-3},
      {"capsule rolling",
       [&](Ground g) {
         return letGo(g, makeCapsule, capsule, 0.3, {2, 0, 0}, {0, 2 / 0.3, 0}, across, 400);
       },
       rolling},
      {"capsule sliding",
       [&](Ground g) {
         return letGo(g, makeCapsule, capsule, 0.3, {0, 2, 0}, {0, 0, 0}, across, 100, 0.2);
       },
       2e-3},
      {"box sliding",
       [&](Ground g) {
         return letGo(g, makeBox, box, 0.2, {2, 0, 0}, {0, 0, 0}, 0, 100, 0.2);
       },
       1e-4},
      {"box dropped on its edge",
       [&](Ground g) {
         return letGo(g, makeBox, box, 0.6, {0, 0, 0}, {0, 0, 0}, 0.5, 600);
       },
       5e-3},
  };
  for (const Run& run : runs) {
    const End native = run.run(Ground::kPlane);
    for (const Ground ground : {Ground::kSheet, Ground::kSlab, Ground::kTwoTriangles}) {
      const End ours = run.run(ground);
      INFO(run.name << ", ground " << static_cast<int>(ground));
      CHECK(norm(otgSub(ours.position, native.position)) < run.tolerance);
      CHECK(norm(otgSub(ours.velocity, native.velocity)) < run.tolerance);
      CHECK(norm(otgSub(ours.spin, native.spin)) < run.tolerance);
    }
  }
}

TEST_CASE("a dConvex and a box of the same size have the same contacts with a mesh, at any pose") {
  const OdeSession session;
  const scenes::ConvexData polygons(scenes::makeBox({0.5, 0.6, 0.7}));
  const dGeomID convex = polygons.makeGeom(nullptr);
  const dGeomID box = dCreateBox(nullptr, 0.5, 0.6, 0.7);
  const Data data(scenes::makeLump(0.5, 3, 0.3, 3));
  const Geom mesh(data);
  std::mt19937 random(3);
  int touching = 0;
  for (int i = 0; i < 300; ++i) {
    setRandomPose(mesh.id, random, 0.6);
    setRandomPose(convex, random, 0.6);
    copyPose(convex, box);
    const auto ours = test::collide(mesh.id, convex), boxes = test::collide(mesh.id, box);
    REQUIRE(ours.empty() == boxes.empty());
    if (ours.empty()) continue;
    ++touching;
    REQUIRE(sameContacts(test::collide(convex, mesh.id), mirrored(ours)));
    REQUIRE(std::abs(deepest(ours)->depth - deepest(boxes)->depth) < 1e-6);
  }
  CHECK(touching > 50);
  dGeomDestroy(convex);
  dGeomDestroy(box);
}

TEST_CASE("a small shape wholly inside a mesh is pushed out, and an inner box leaves") {
  const OdeSession session;
  const Data data(scenes::makeBox({2, 2, 2}, 2));
  const Geom mesh(data);
  for (const dGeomID shape :
       {dCreateBox(nullptr, 0.2, 0.2, 0.2), dCreateCapsule(nullptr, 0.1, 0.2), dCreateCylinder(nullptr, 0.1, 0.2)}) {
    dGeomSetPosition(shape, 0.1, 0.2, 0.7);
    const auto contacts = test::collide(shape, mesh.id);
    REQUIRE(!contacts.empty());
    CHECK(contacts[0].normal[2] > 0.9);
    CHECK(contacts[0].depth > 0);
    dGeomDestroy(shape);
  }
}

TEST_CASE("geoms of any class wrapped in a dGeomTransform meet a mesh, wrapped or not, as they do bare") {
  const OdeSession session;
  const Data data(scenes::makeBox({1, 1, 1}, 2)), groundData(scenes::makeGround(4, 1, 4));
  const Geom mesh(data), ground(groundData);
  dGeomSetPosition(mesh.id, 0, 0, 0.49);
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wdeprecated-declarations"  // by ODE, which still has them
  const auto wrap = [](dGeomID inner) {
    const dGeomID outer = dCreateGeomTransform(nullptr);
    dGeomTransformSetGeom(outer, inner);
    dGeomTransformSetInfo(outer, 1);
    dGeomTransformSetCleanup(outer, 1);
    return outer;
  };
#pragma GCC diagnostic pop
  const std::function<dGeomID()> makers[] = {
      [] { return dCreateSphere(nullptr, 0.3); }, [] { return dCreateBox(nullptr, 0.5, 0.4, 0.6); },
      [] { return dCreateCapsule(nullptr, 0.2, 0.3); }, [] { return dCreateCylinder(nullptr, 0.2, 0.6); }};
  for (const auto& make : makers) {
    const dGeomID bare = make(), inner = make(), outer = wrap(inner);
    dGeomSetPosition(bare, 0.1, 0.2, 0.29);
    dGeomSetPosition(inner, 0.1, 0, 0.29);
    dGeomSetPosition(outer, 0, 0.2, 0);
    const auto expected = test::collide(bare, ground.id), wrapped = test::collide(outer, ground.id);
    REQUIRE(!expected.empty());
    REQUIRE(wrapped.size() == expected.size());
    for (std::size_t i = 0; i < wrapped.size(); ++i) {
      CHECK(wrapped[i].g1 == outer);
      CHECK(wrapped[i].g2 == ground.id);
      CHECK(std::abs(wrapped[i].depth - expected[i].depth) < 1e-12);
      CHECK(norm(otgSub(toVec(wrapped[i].pos), toVec(expected[i].pos))) < 1e-9);
    }
    dGeomDestroy(bare);
    dGeomDestroy(outer);
  }
  // The mesh on the inside.
  const dGeomID outer = wrap(dCreateGpuTriMesh(nullptr, data.id)), plane = dCreatePlane(nullptr, 0, 0, 1, 0);
  dGeomSetPosition(outer, 0, 0, 0.49);
  for (const dGeomID other : {plane, ground.id}) {
    const auto expected = test::collide(mesh.id, other), wrapped = test::collide(outer, other);
    REQUIRE(wrapped.size() == expected.size());
    REQUIRE(!wrapped.empty());
    CHECK(wrapped[0].g1 == outer);
    CHECK(std::abs(wrapped[0].depth - 0.01) < 1e-6);
  }
  dGeomDestroy(outer);
  dGeomDestroy(plane);
}

TEST_CASE("a mesh wheel rolls on a mesh road as it does on ODE's plane") {
  const OdeSession session;
  dMass mass;
  dMassSetCylinderTotal(&mass, 1, 3, 0.3, 0.2);
  const Data wheel(scenes::makeCylinder(0.3, 0.2, 64, 1));
  const auto make = [&](dSpaceID s) { return dCreateGpuTriMesh(s, wheel.id); };
  const auto roll = [&](Ground g) { return letGo(g, make, mass, 0.3, {2, 0, 0}, {0, 2 / 0.3, 0}, M_PI / 2, 400); };
  const End plane = roll(Ground::kPlane);
  for (const Ground ground : {Ground::kSheet, Ground::kSlab, Ground::kTwoTriangles}) {
    const End road = roll(ground);
    INFO("ground " << static_cast<int>(ground));
    CHECK(road.position.x + 3 > 0.97 * (plane.position.x + 3));  // the way that it went
    CHECK(std::abs(road.position.y - 0.07) < 0.02);              // straight on
    CHECK(std::abs(road.position.z - 0.3) < 2e-3);
    CHECK(road.velocity.x < 2);
    CHECK(road.velocity.x > 0.9 * plane.velocity.x);
  }
  // Its 64 facets brake it on the plane, too.
  CHECK(plane.velocity.x > 1.6);
}

TEST_CASE("a mesh and a dTriMesh of ODE's have the contacts of two meshes") {
  const OdeSession session;
  const OdeMesh lump(scenes::makeLump(0.5, 3, 0.3, 3));
  const Data data(scenes::makeTorus(0.5, 0.2, 20, 12)), sameData(lump.arrays);
  const Geom mesh(data), same(sameData);
  const OdeGeom other(lump);
  std::mt19937 random(3);
  int touching = 0;
  for (int i = 0; i < 3000; ++i) {
    setRandomPose(mesh.id, random, 0.6);
    setRandomPose(other.id, random, 0.6);
    copyPose(other.id, same.id);
    for (const dGeomID g : {mesh.id, same.id, other.id}) dGeomGpuTriMeshForgetHistory(g);
    auto ours = test::collide(mesh.id, other.id);
    if (i % 10 == 0) REQUIRE(sameContacts(test::collide(other.id, mesh.id), mirrored(ours)));
    for (dContactGeom& c : ours) {
      REQUIRE(c.g2 == other.id);
      c.g2 = same.id;
    }
    REQUIRE(sameContacts(ours, test::collide(mesh.id, same.id)));
    touching += ours.empty() ? 0 : 1;
  }
  CHECK(touching > 1500);
}

TEST_CASE("any number of threads collide the same mesh with shapes of ODE's as one thread does") {
  const OdeSession session;
  const Data data(scenes::makeLump(0.6, 3, 0.3, 3));
  const Geom mesh(data);
  dGpuTriMeshParams params;
  dGpuTriMeshParamsInit(&params);
  params.history = dGPUTRIMESH_HISTORY_OFF;
  REQUIRE(dGeomGpuTriMeshSetParams(mesh.id, &params) == dGPUTRIMESH_OK);
  std::vector<dGeomID> shapes;
  std::mt19937 random(3);
  for (int i = 0; i < 40; ++i) {
    const double size = 0.2 + 0.01 * (i % 7);  // shapes that are kept and shapes that are new
    const dGeomID made[] = {dCreateSphere(nullptr, size), dCreateBox(nullptr, size, 0.3, 0.4),
                            dCreateCapsule(nullptr, size, 0.3), dCreateCylinder(nullptr, size, 0.3),
                            dCreateRay(nullptr, 2)};
    for (const dGeomID shape : made) {
      if (dGeomGetClass(shape) != dRayClass) setRandomPose(shape, random, 0.6);
      shapes.push_back(shape);
    }
  }
  std::vector<std::vector<dContactGeom>> expected(shapes.size());
  std::vector<std::vector<std::vector<dContactGeom>>> found(4);
  std::vector<std::thread> threads;
  for (auto& results : found) {
    threads.emplace_back([&] {
      for (const dGeomID shape : shapes) results.push_back(test::collide(mesh.id, shape));
    });
  }
  for (std::thread& thread : threads) thread.join();
  std::size_t seen = 0;
  for (std::size_t i = 0; i < shapes.size(); ++i) {
    expected[i] = test::collide(mesh.id, shapes[i]);
    seen += expected[i].size();
    for (const auto& results : found) REQUIRE(sameContacts(results[i], expected[i]));
    dGeomDestroy(shapes[i]);
  }
  CHECK(seen > 100);
}
