// SPDX-License-Identifier: BSD-3-Clause
// Queries that are asked again and again: they take no memory.
#include <cmath>

#include "base/vectors.h"
#include "scenes/concave_meshes.h"
#include "support/catch.h"
#include "support/counted_memory.h"
#include "support/draw.h"
#include "support/ode_world.h"

using namespace otg;
using namespace otg::test;

namespace {

/// Contacts of a pair that is asked about many times, in a place that has changed a little each time.
int askWarm(dGeomID still, dGeomID moving, const Vec3d& at, const char* what) {
  INFO(what);
  dContactGeom contacts[64];
  int found = 0;
  const auto ask = [&](int i) {
    if (dGeomGetClass(moving) != dPlaneClass) {
      const double by = 1e-5 * (i % 7);
      dGeomSetPosition(moving, at.x + by, at.y - by, at.z + 0.5 * by);
    }
    found = dCollide(still, moving, 64, contacts, sizeof(dContactGeom));
  };
  for (int i = 0; i < 50; ++i) ask(i);
  const std::size_t before = allocations;
  for (int i = 0; i < 200; ++i) ask(i);
  CHECK(allocations == before);
  return found;
}

}  // namespace

TEST_CASE("a warm dCollide of a convex pair or a plane takes no memory") {
  const OdeSession session;
  const Data box(scenes::makeBox({1, 1, 1})), ball(scenes::makeSphere(0.5, 3)), can(scenes::makeCylinder(0.5, 1, 48));
  const Geom box1(box), box2(box), ball1(ball), ball2(ball), can1(can), can2(can);
  CHECK(askWarm(box1.id, box2.id, {0.1, 0.2, 0.999}, "boxes") == 4);
  CHECK(askWarm(ball1.id, ball2.id, {0, 0, 0.99}, "balls") > 0);
  CHECK(askWarm(box1.id, ball2.id, {0.1, 0.2, 0.99}, "box and ball") > 0);
  CHECK(askWarm(can1.id, can2.id, {0, 0, 0.999}, "cylinders") > 2);
  const dGeomID plane = dCreatePlane(nullptr, 0, 0, 1, -0.499);
  CHECK(askWarm(box1.id, plane, {0, 0, 0}, "plane") == 4);
  dGeomDestroy(plane);
}

TEST_CASE("a warm dCollide of bodies that do not meet takes no memory") {
  const OdeSession session;
  const Data box(scenes::makeBox({1, 1, 1})), ball(scenes::makeSphere(0.5, 3)),
      torus(scenes::makeTorus(0.4, 0.1, 36, 16)),
      ground(
          scenes::makeGround(4, 0.2, 12, [](double x, double y) { return 0.1 * std::sin(3 * x) * std::cos(2 * y); }));
  const Geom box1(box), box2(box), ball1(ball), ball2(ball), torus1(torus), torus2(torus), below(ground);
  CHECK(askWarm(box1.id, box2.id, {1.01, 0.3, 0.2}, "boxes") == 0);
  CHECK(askWarm(ball1.id, ball2.id, {0.6, 0.6, 0.6}, "balls") == 0);
  dMatrix3 up;
  dRFromAxisAndAngle(up, 1, 0, 0, M_PI / 2);
  dGeomSetRotation(torus2.id, up);
  CHECK(askWarm(torus1.id, torus2.id, {0.4, 0, 0}, "links of a chain") == 0);
  CHECK(askWarm(torus1.id, ball2.id, {0, 0, 0.75}, "a ball above a hole") == 0);
  CHECK(askWarm(below.id, torus1.id, {0, 0, 0.22}, "a torus above hills") == 0);
}

TEST_CASE("a warm dCollide of solids that are not convex takes no memory") {
  const OdeSession session;
  const Data torus(scenes::makeTorus(0.4, 0.1, 36, 16)), fine(scenes::makeTorus(0.4, 0.1, 144, 64)),
      corner(scenes::makeCorner(1, 0.3, 0.8)), box(scenes::makeBox({0.4, 0.4, 0.4})), ball(scenes::makeSphere(0.5, 3)),
      ground(
          scenes::makeGround(4, 0.2, 12, [](double x, double y) { return 0.1 * std::sin(3 * x) * std::cos(2 * y); }));
  const Geom torus1(torus), torus2(torus), fine1(fine), fine2(fine), corner1(corner), box1(box), ball1(ball),
      below(ground);
  CHECK(askWarm(torus1.id, torus2.id, {0.4, 0.3, 0.05}, "tori across each other") > 0);
  CHECK(askWarm(fine1.id, fine2.id, {0.4, 0.3, 0.05}, "fine tori across each other") > 0);
  CHECK(askWarm(torus1.id, ball1.id, {0, 0, 0.4}, "a ball on a torus") > 0);
  CHECK(askWarm(torus1.id, ball1.id, {0.4, 0, 0.05}, "a ball around a tube") > 0);
  CHECK(askWarm(corner1.id, box1.id, {0.499, 0, 0.499}, "a box in an inner corner") > 2);
  CHECK(askWarm(below.id, torus1.id, {0, 0, 0.15}, "a torus on hills") > 0);
  CHECK(askWarm(below.id, box1.id, {0.1, 0, 0.2}, "a box on hills") > 0);
}

TEST_CASE("a warm dCollide of one of ODE's shapes and a mesh takes no memory") {
  const OdeSession session;
  const Data corner(scenes::makeCorner(1, 0.3, 0.8)), ground(scenes::makeGround(4, 0.2, 12, [](double x, double y) {
    return 0.1 * std::sin(3 * x) * std::cos(2 * y);
  }));
  const Data slab(scenes::makeBox({4, 4, 1}, 8));
  const Geom corner1(corner), below(ground), convex(slab);
  const dGeomID shapes[] = {dCreateBox(nullptr, 0.4, 0.4, 0.4), dCreateCylinder(nullptr, 0.2, 0.4),
                            dCreateCapsule(nullptr, 0.2, 0.4), dCreateSphere(nullptr, 0.2)};
  const char* const names[] = {"a box", "a cylinder", "a capsule", "a sphere"};
  for (int i = 0; i < 4; ++i) {
    INFO(names[i]);
    CHECK(askWarm(below.id, shapes[i], {0.1, 0, i == 2 ? 0.38 : 0.19}, "on hills") > 0);
    CHECK(askWarm(corner1.id, shapes[i], {0.499, 0, 0.499}, "in an inner corner") > 1);
    CHECK(askWarm(convex.id, shapes[i], {0.1, 0, i == 2 ? 0.89 : 0.69}, "on a slab") > 0);
    dGeomDestroy(shapes[i]);
  }
}

TEST_CASE("the first collision of prepared geoms makes nothing of their meshes") {
  const OdeSession session;
  const scenes::MeshArrays lump = scenes::makeLump(1, 5, 0.2, 3);
  const std::size_t triangles = lump.triangles.size();
  const auto bytesOf = [](const auto& work) {
    const std::size_t before = allocatedBytes;
    work();
    return allocatedBytes - before;
  };
  for (const double factor : {1.0, -1.0}) {
    INFO("factor along x " << factor);
    std::vector<dContactGeom> contacts[2];
    for (const int prepared : {0, 1}) {
      const Data data(lump);
      const Geom a(data), b(data);
      REQUIRE(dGeomGpuTriMeshSetScale(b.id, factor, 1, 1.5) == dGPUTRIMESH_OK);
      dGeomSetPosition(b.id, 1.2, 0.3, 0.1);
      const auto prepare = [&] {
        for (const dGeomID g : {a.id, b.id}) REQUIRE(dGeomGpuTriMeshPrepare(g) == dGPUTRIMESH_OK);
      };
      if (prepared != 0) {
        CHECK(bytesOf(prepare) > 100 * triangles);
        CHECK(bytesOf(prepare) == 0);
      }
      const std::size_t bytes = bytesOf([&] { contacts[prepared] = test::collide(a.id, b.id, 64); });
      CHECK((bytes < 10 * triangles) == (prepared != 0));
    }
    REQUIRE(contacts[0].size() > 4);
    CHECK(sameContacts(contacts[0], contacts[1]));
  }
}

TEST_CASE("for pairs of triangles alone a geom prepares no lists of its solid, and without a mesh nothing") {
  const OdeSession session;
  const dGeomID empty = dCreateGpuTriMesh(nullptr, nullptr);
  CHECK(dGeomGpuTriMeshPrepare(empty) == dGPUTRIMESH_ERROR_MESH);
  dGeomDestroy(empty);
  const scenes::MeshArrays lump = scenes::makeLump(1, 5, 0.2, 3);
  const Data data(lump);
  const Geom geom(data);
  dGpuTriMeshParams params;
  dGpuTriMeshParamsInit(&params);
  params.contact_model = dGPUTRIMESH_CONTACTS_PAIRWISE;
  REQUIRE(dGeomGpuTriMeshSetParams(geom.id, &params) == dGPUTRIMESH_OK);
  const std::size_t before = allocatedBytes;
  CHECK(dGeomGpuTriMeshPrepare(geom.id) == dGPUTRIMESH_OK);
  const std::size_t pairwise = allocatedBytes - before;
  dGpuTriMeshParamsInit(&params);
  REQUIRE(dGeomGpuTriMeshSetParams(geom.id, &params) == dGPUTRIMESH_OK);
  CHECK(dGeomGpuTriMeshPrepare(geom.id) == dGPUTRIMESH_OK);
  CHECK(allocatedBytes - before > pairwise + 100 * lump.triangles.size());
}

TEST_CASE("a convex mesh meets a plane at the vertices that all of its vertices say") {
  const OdeSession session;
  Draw draw(5);
  for (const scenes::MeshArrays& mesh : {scenes::makeBox({1, 0.5, 2}), scenes::makeBox({1, 1, 1}, 6),
                                         scenes::makeTetrahedron({0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0.1, 0.2, 0.7}),
                                         scenes::makeSphere(0.5, 2), scenes::makeCylinder(0.5, 1, 20)}) {
    const Data data(mesh);
    const Geom geom(data);
    const dGeomID plane = dCreatePlane(nullptr, 0, 0, 1, 0);
    for (int i = 0; i < 200; ++i) {
      const Vec3d n = unit(Vec3d{draw.uniform(-1, 1), draw.uniform(-1, 1), draw.uniform(-1, 1)});
      const double offset = draw.uniform(-1, 0.3);
      dGeomPlaneSetParams(plane, n.x, n.y, n.z, offset);
      double deepest = -1;
      for (const Vec3f& v : mesh.vertices) deepest = std::max(deepest, offset - otgDot(n, Vec3d{v.x, v.y, v.z}));
      const auto contacts = test::collide(geom.id, plane);
      REQUIRE(contacts.empty() == (deepest < 0));
      if (contacts.empty()) continue;
      // Vertices whose depths differ by less than 2 % count as equally deep.
      CHECK(contacts[0].depth <= deepest + 1e-6);
      CHECK(contacts[0].depth >= 0.98 * deepest - 1e-6);
      for (const dContactGeom& c : contacts) {
        CHECK(c.depth == Approx(offset - otgDot(n, Vec3d{c.pos[0], c.pos[1], c.pos[2]})).margin(1e-9));
        const Triangle& t = mesh.triangles[static_cast<std::size_t>(c.side1)];
        const bool isCorner = std::any_of(t.v, t.v + 3, [&](std::uint32_t v) {
          const Vec3f& p = mesh.vertices[v];
          return norm(Vec3d{p.x - c.pos[0], p.y - c.pos[1], p.z - c.pos[2]}) < 1e-12;
        });
        CHECK(isCorner);
      }
    }
    dGeomDestroy(plane);
  }
}
