// SPDX-License-Identifier: BSD-3-Clause
// Mesh geoms with ODE's plane and sphere: against the analytic pair, mirrored, at edges, and in a stepping world.
#include <algorithm>
#include <cmath>

#include "base/vectors.h"
#include "collide/shortest_translation.h"
#include "scenes/concave_meshes.h"
#include "support/catch.h"
#include "support/draw.h"
#include "support/mirror.h"
#include "support/ode_world.h"
#include "support/step_world.h"

using namespace otg;
using namespace otg::test;

namespace {

Vec3d toVec(const dReal* p) {
  return {p[0], p[1], p[2]};
}
double deepest(const std::vector<dContactGeom>& contacts) {
  double most = 0;
  for (const dContactGeom& c : contacts) most = std::max(most, double(c.depth));
  return most;
}

/// An open, flat, tessellated ground whose triangles face up.
scenes::MeshArrays makeSheet(int cells, double cell, const std::function<double(double, double)>& height = {}) {
  scenes::MeshArrays sheet;
  for (int y = 0; y <= cells; ++y) {
    for (int x = 0; x <= cells; ++x) {
      const double px = cell * (x - 0.5 * cells), py = cell * (y - 0.5 * cells);
      sheet.vertices.push_back({float(px), float(py), float(height ? height(px, py) : 0)});
    }
  }
  const auto n = static_cast<std::uint32_t>(cells) + 1;
  for (std::uint32_t y = 0; y + 1 < n; ++y) {
    for (std::uint32_t x = 0; x + 1 < n; ++x) {
      const std::uint32_t v = n * y + x;
      sheet.triangles.push_back({{v, v + 1, v + n + 1}});
      sheet.triangles.push_back({{v, v + n + 1, v + n}});
    }
  }
  return sheet;
}

}  // namespace

TEST_CASE("a box mesh and a plane have the contacts of dBox and the plane, negative offsets included") {
  const OdeSession session;
  const Data data(scenes::makeBox({1, 0.7, 0.4}, 3));
  const Geom mesh(data);
  const dGeomID box = dCreateBox(nullptr, 1, 0.7, 0.4), plane = dCreatePlane(nullptr, 0, 0, 1, 0);
  std::mt19937 random(3);
  Draw draw(5);
  int touching = 0;
  for (int i = 0; i < 2000; ++i) {
    const Vec3d n = draw.direction();
    dGeomPlaneSetParams(plane, n.x, n.y, n.z, draw.uniform(-1, 0.5));
    setRandomPose(mesh.id, random, 0.5);
    dGeomSetPosition(box, dGeomGetPosition(mesh.id)[0], dGeomGetPosition(mesh.id)[1], dGeomGetPosition(mesh.id)[2]);
    dGeomSetRotation(box, dGeomGetRotation(mesh.id));
    const auto ours = test::collide(mesh.id, plane), native = test::collide(box, plane, 64);
    REQUIRE(ours.empty() == native.empty());
    REQUIRE(sameContacts(test::collide(plane, mesh.id), mirrored(ours)));
    if (ours.empty()) continue;
    ++touching;
    REQUIRE(std::abs(deepest(ours) - deepest(native)) < 1e-7);
    for (const dContactGeom& c : ours) {
      REQUIRE(norm(otgSub(toVec(c.normal), n)) < 1e-12);
      REQUIRE(c.side1 >= 0);
      REQUIRE(c.side2 == -1);
      REQUIRE(c.g1 == mesh.id);
    }
    // ODE gives the corners that are deepest; each of them is one of ours.
    for (const dContactGeom& c : native) {
      double nearest = 1;
      for (const dContactGeom& o : ours) nearest = std::min(nearest, norm(otgSub(toVec(o.pos), toVec(c.pos))));
      REQUIRE(nearest < 1e-6);
    }
    REQUIRE(ours.size() <= 8);  // corners alone, though each side has 16 vertices
  }
  CHECK(touching > 500);
  dGeomDestroy(box);
  dGeomDestroy(plane);
}

TEST_CASE("of many vertices below a plane few are chosen: the deepest and the outermost") {
  const OdeSession session;
  const Data data(scenes::makeSphere(1, 4));
  const Geom mesh(data);
  const dGeomID plane = dCreatePlane(nullptr, 0, 0, 1, -0.8);
  const auto contacts = test::collide(mesh.id, plane);
  CHECK(contacts.size() == 16);
  CHECK(contacts[0].depth == Approx(0.2).margin(1e-3));
  double x[2] = {0, 0}, y[2] = {0, 0};
  for (const dContactGeom& c : contacts) {
    x[0] = std::min(x[0], double(c.pos[0]));
    x[1] = std::max(x[1], double(c.pos[0]));
    y[0] = std::min(y[0], double(c.pos[1]));
    y[1] = std::max(y[1], double(c.pos[1]));
  }
  CHECK(x[1] - x[0] > 1);  // the circle at the plane has a radius of 0.6
  CHECK(y[1] - y[0] > 1);
  const auto two = test::collide(mesh.id, plane, 2);
  REQUIRE(two.size() == 2);
  CHECK(sameContact(two[0], contacts[0]));
  dGeomDestroy(plane);
}

TEST_CASE("a box mesh and a sphere have the contact of dBox and the sphere") {
  const OdeSession session;
  const Data data(scenes::makeBox({1, 0.7, 0.4}, 3));
  const Geom mesh(data);
  const dGeomID box = dCreateBox(nullptr, 1, 0.7, 0.4), sphere = dCreateSphere(nullptr, 0.3);
  std::mt19937 random(3);
  int touching = 0, within = 0;
  for (int i = 0; i < 5000; ++i) {
    setRandomPose(mesh.id, random, 0.5);
    setRandomPose(sphere, random, 0.5);
    dGeomSphereSetRadius(sphere, i % 2 == 0 ? 0.3 : 0.05);
    dGeomSetPosition(box, dGeomGetPosition(mesh.id)[0], dGeomGetPosition(mesh.id)[1], dGeomGetPosition(mesh.id)[2]);
    dGeomSetRotation(box, dGeomGetRotation(mesh.id));
    const auto ours = test::collide(mesh.id, sphere), native = test::collide(box, sphere);
    REQUIRE(ours.size() == native.size());
    REQUIRE(sameContacts(test::collide(sphere, mesh.id), mirrored(ours)));
    if (ours.empty()) continue;
    ++touching;
    within += native[0].depth > dGeomSphereGetRadius(sphere) ? 1 : 0;
    REQUIRE(std::abs(ours[0].depth - native[0].depth) < 1e-6);
    // Inside the box two ways out may be equally long to within the rounding of the mesh's vertices.
    if (norm(otgSub(toVec(ours[0].normal), toVec(native[0].normal))) > 1e-5) {
      REQUIRE(native[0].depth > dGeomSphereGetRadius(sphere));
    }
  }
  CHECK(touching > 1000);
  CHECK(within > 200);
  dGeomDestroy(box);
  dGeomDestroy(sphere);
}

TEST_CASE("a finely tessellated sphere mesh and a sphere have the contact of two spheres") {
  const OdeSession session;
  const Data data(scenes::makeSphere(1, 5));
  const Geom mesh(data);
  const dGeomID ball = dCreateSphere(nullptr, 1), sphere = dCreateSphere(nullptr, 0.5);
  std::mt19937 random(3);
  int touching = 0;
  for (int i = 0; i < 2000; ++i) {
    setRandomPose(mesh.id, random, 0.2);
    setRandomPose(sphere, random, 1.2);
    dGeomSetPosition(ball, dGeomGetPosition(mesh.id)[0], dGeomGetPosition(mesh.id)[1], dGeomGetPosition(mesh.id)[2]);
    const auto ours = test::collide(mesh.id, sphere), native = test::collide(ball, sphere);
    if (native.empty() || native[0].depth < 2e-3) continue;  // the facets' sagitta
    REQUIRE(ours.size() == 1);
    ++touching;
    REQUIRE(std::abs(ours[0].depth - native[0].depth) < 1.2e-3);
    if (native[0].depth < 0.5) {
      // The facets turn the normal by their own angle at most.
      REQUIRE(otgDot(toVec(ours[0].normal), toVec(native[0].normal)) > std::cos(2.5 * M_PI / 180));
    }
  }
  CHECK(touching > 500);
  dGeomDestroy(ball);
  dGeomDestroy(sphere);
}

TEST_CASE("a sphere on a flat tessellated ground, open or closed, has the ground's normal wherever it is") {
  const OdeSession session;
  const Data sheetData(makeSheet(8, 0.25)), slabData(scenes::makeGround(2, 0.5, 8));
  const Geom sheet(sheetData), slab(slabData);
  const dGeomID sphere = dCreateSphere(nullptr, 0.3);
  Draw draw(5);
  for (int i = 0; i < 1000; ++i) {
    // Over edges and corners of the tessellation, too.
    const double x = i % 3 == 0 ? 0.25 : draw.uniform(-0.7, 0.7), y = i % 5 == 0 ? 0.5 : draw.uniform(-0.7, 0.7);
    const double z = draw.uniform(-0.2, 0.299);
    dGeomSetPosition(sphere, x, y, z);
    for (const dGeomID ground : {sheet.id, slab.id}) {
      const auto contacts = test::collide(sphere, ground);
      REQUIRE(contacts.size() == 1);
      REQUIRE(std::abs(contacts[0].depth - (0.3 - z)) < 1e-7);
      REQUIRE(norm(otgSub(toVec(contacts[0].normal), Vec3d{0, 0, 1})) < 1e-6);
    }
  }
  // Below a sheet as a whole there is nothing; inside a solid there is a way out.
  dGeomSetPosition(sphere, 0.1, 0.1, -0.4);
  CHECK(test::collide(sphere, sheet.id).empty());
  dGeomSphereSetRadius(sphere, 0.05);
  dGeomSetPosition(sphere, 0.1, 0.1, -0.2);
  const auto inside = test::collide(sphere, slab.id);
  REQUIRE(inside.size() == 1);
  CHECK(inside[0].depth == Approx(0.25));
  CHECK(inside[0].normal[2] == Approx(1));
  dGeomDestroy(sphere);
}

TEST_CASE("a sphere over a convex edge has one contact along the line to the edge, in a groove two") {
  const OdeSession session;
  // A ridge along y at the origin, 90 degrees; its mirror image is a groove.
  const auto ridge = [](double x, double) { return -std::abs(x); };
  const auto groove = [](double x, double) { return std::abs(x); };
  const Data ridgeData(makeSheet(8, 0.5, ridge)), grooveData(makeSheet(8, 0.5, groove));
  const Geom over(ridgeData), in(grooveData);
  const dGeomID sphere = dCreateSphere(nullptr, 0.3);
  for (int i = 0; i <= 20; ++i) {
    const double angle = (i - 10) * 4 * M_PI / 180;  // up to 40 degrees to either side: within the edge's own range
    dGeomSetPosition(sphere, 0.29 * std::sin(angle), 0.013 * i, 0.29 * std::cos(angle));
    const auto contacts = test::collide(sphere, over.id);
    REQUIRE(contacts.size() == 1);
    CHECK(contacts[0].depth == Approx(0.01).margin(1e-7));
    CHECK(contacts[0].normal[0] == Approx(std::sin(angle)).margin(1e-6));
    CHECK(contacts[0].normal[2] == Approx(std::cos(angle)).margin(1e-6));
  }
  dGeomSetPosition(sphere, 0.001, 0.13, 0.4);
  const auto contacts = test::collide(sphere, in.id);
  REQUIRE(contacts.size() == 2);
  for (const dContactGeom& c : contacts) {
    CHECK(std::abs(c.normal[0]) == Approx(std::sqrt(0.5)));
    CHECK(c.normal[2] == Approx(std::sqrt(0.5)));
  }
  CHECK(contacts[0].normal[0] * contacts[1].normal[0] < 0);
  dGeomDestroy(sphere);
}

TEST_CASE("a sphere rolls over a tessellated ground mesh as it does over a plane") {
  const OdeSession session;
  dMass mass;
  dMassSetSphereTotal(&mass, 1, 0.3);
  const auto roll = [&](bool mesh) {
    StepWorld world;
    const Data ground(makeSheet(40, 0.25));
    if (mesh)
      dCreateGpuTriMesh(world.space(), ground.id);
    else
      dCreatePlane(world.space(), 0, 0, 1, 0);
    const dBodyID body = world.addBody(dCreateSphere(world.space(), 0.3), mass);
    dBodySetPosition(body, -4, -0.5, 0.3);
    dBodySetLinearVel(body, 2, 0.3, 0);
    dBodySetAngularVel(body, -0.3 / 0.3, 2 / 0.3, 0);
    world.step(600);
    std::vector<double> state;
    for (int k = 0; k < 3; ++k) state.push_back(dBodyGetPosition(body)[k]);
    for (int k = 0; k < 3; ++k) state.push_back(dBodyGetLinearVel(body)[k]);
    return state;
  };
  const auto onPlane = roll(false), onMesh = roll(true);
  for (std::size_t k = 0; k < 6; ++k) CHECK(onMesh[k] == Approx(onPlane[k]).margin(1e-4));
  CHECK(onMesh[0] > 1.5);
}

TEST_CASE("a box mesh rests on a plane and slides down a slope as dBox does") {
  const OdeSession session;
  dMass mass;
  dMassSetBoxTotal(&mass, 1, 0.6, 0.5, 0.4);
  const auto run = [&](bool mesh, double slope, double mu) {
    StepWorld world(mu);
    const Data box(scenes::makeBox({0.6, 0.5, 0.4}, 3));
    dCreatePlane(world.space(), std::sin(slope), 0, std::cos(slope), -0.25);
    const dGeomID geom = mesh ? dCreateGpuTriMesh(world.space(), box.id) : dCreateBox(world.space(), 0.6, 0.5, 0.4);
    const dBodyID body = world.addBody(geom, mass);
    dMatrix3 r;
    dRFromAxisAndAngle(r, 0, 1, 0, slope);
    dBodySetRotation(body, r);
    dBodySetPosition(body, -0.05 * std::sin(slope), 0, -0.05 * std::cos(slope));  // 0.2 above the plane
    world.step(400);
    return toVec(dBodyGetPosition(body));
  };
  const Vec3d rest = run(true, 0, 1), nativeRest = run(false, 0, 1);
  CHECK(norm(otgSub(rest, nativeRest)) < 1e-6);
  const double slope = 30 * M_PI / 180;
  const Vec3d slid = run(true, slope, 0.3), nativeSlid = run(false, slope, 0.3);
  CHECK(norm(nativeSlid) > 1);
  CHECK(norm(otgSub(slid, nativeSlid)) < 0.005 * norm(nativeSlid));
}

namespace {

/// Whether every contact of the one list is the image of one of the other.
bool areImages(const std::vector<dContactGeom>& contacts, const std::vector<dContactGeom>& images, double tolerance) {
  if (contacts.size() != images.size()) return false;
  return std::all_of(contacts.begin(), contacts.end(), [&](const dContactGeom& c) {
    return std::any_of(images.begin(), images.end(), [&](const dContactGeom& d) {
      return norm(otgSub(mirror(toVec(c.pos)), toVec(d.pos))) < tolerance &&
             norm(otgSub(mirror(toVec(c.normal)), toVec(d.normal))) < tolerance &&
             std::abs(c.depth - d.depth) < tolerance;
    });
  });
}

}  // namespace

TEST_CASE("mirrored planes and rays have mirrored contacts, and exchanged geoms negated ones") {
  const OdeSession session;
  const scenes::MeshArrays lump = scenes::makeLump(0.5, 1, 0.3, 3);
  const Data data(lump), mirroredData(mirror(lump));
  const Geom mesh(data), image(mirroredData);
  const dGeomID plane = dCreatePlane(nullptr, 0, 0, 1, 0), otherPlane = dCreatePlane(nullptr, 0, 0, 1, 0);
  const dGeomID ray = dCreateRay(nullptr, 3), otherRay = dCreateRay(nullptr, 3);
  Draw draw(11);
  int touching = 0, whole = 0, hits = 0;
  for (int i = 0; i < 1000; ++i) {
    const Transformd pose = makePose(draw.direction(), draw.uniform(-3, 3), draw.inBox(0.45));
    setPose(mesh.id, pose);
    setPose(image.id, mirror(pose));
    const Vec3d n = draw.direction(), m = mirror(n);
    const double offset = draw.uniform(-0.8, 0.4);
    dGeomPlaneSetParams(plane, n.x, n.y, n.z, offset);
    dGeomPlaneSetParams(otherPlane, m.x, m.y, m.z, offset);
    const auto below = test::collide(mesh.id, plane);
    const auto there = test::collide(image.id, otherPlane);
    INFO("pose " << i);
    // Where more than 16 are below, those kept depend on the numbers of vertices, which are other ones in the image:
    // the first of them is any that is within 2 % of the deepest.
    const bool isWhole = below.size() < 16;
    whole += isWhole && !below.empty() ? 1 : 0;
    REQUIRE(below.size() == there.size());
    CHECK((!isWhole || areImages(below, there, 1e-6)));
    CHECK(std::abs(deepest(below) - deepest(there)) <= 0.02 / 0.98 * deepest(below) + 1e-6);
    REQUIRE(sameContacts(test::collide(plane, mesh.id), mirrored(below)));
    touching += below.empty() ? 0 : 1;

    const Vec3d from = draw.inBox(1.2), along = otgSub(draw.inBox(0.5), from), turned = mirror(along);
    dGeomRaySet(ray, from.x, from.y, from.z, along.x, along.y, along.z);
    dGeomRaySet(otherRay, -from.x, from.y, from.z, turned.x, turned.y, turned.z);
    const auto seen = test::collide(mesh.id, ray), seenThere = test::collide(image.id, otherRay);
    REQUIRE(areImages(seen, seenThere, 1e-6));
    REQUIRE(sameContacts(test::collide(ray, mesh.id), mirrored(seen)));
    for (std::size_t k = 0; k < seen.size(); ++k) CHECK(seen[k].side1 == seenThere[k].side1);
    hits += seen.empty() ? 0 : 1;
  }
  CHECK(touching > 300);
  CHECK(whole > 150);
  CHECK(hits > 200);
  for (const dGeomID geom : {plane, otherPlane, ray, otherRay}) dGeomDestroy(geom);
}

TEST_CASE("a round shape that is in one wall of a groove names the other where the way out leads into it") {
  const OdeSession session;
  Draw draw(3);
  int named = 0, left = 0;
  for (int i = 0; i < 300; ++i) {
    const double lean = draw.uniform(0.1, 0.7), bottom = draw.uniform(0.02, 0.1), s = bottom + 0.5 * std::tan(lean);
    const Data data(scenes::makeProfile(
        {{-1, -0.2}, {1, -0.2}, {1, 0.5}, {s, 0.5}, {bottom, 0}, {-bottom, 0}, {-s, 0.5}, {-1, 0.5}}, 1));
    const double radius = bottom + draw.uniform(0.02, 0.1), depth = draw.uniform(1e-4, 1e-3);
    const double gap = draw.uniform(0, depth);
    // The walls' normals point into the groove; both planes are as far from the origin.
    const Vec3d walls[2] = {{std::cos(lean), 0, std::sin(lean)}, {-std::cos(lean), 0, std::sin(lean)}};
    const double offset = -bottom * std::cos(lean);
    const Vec3d at{-0.5 * (depth + gap) / std::cos(lean), 0, (radius + offset + 0.5 * (gap - depth)) / std::sin(lean)};
    if (at.z > 0.45) continue;  // it would lie on the rims
    const dGeomID mesh = dCreateGpuTriMesh(nullptr, data.id);
    const dGeomID shape = i % 3 == 0   ? dCreateSphere(nullptr, radius)
                          : i % 3 == 1 ? dCreateCapsule(nullptr, radius, 0.4)
                                       : dCreateCylinder(nullptr, radius, 0.4);
    dMatrix3 turn;
    dRFromZAxis(turn, 0, 1, 0);
    dGeomSetRotation(shape, turn);
    dGeomSetPosition(shape, at.x, at.y, at.z);
    ShortestTranslation way;
    for (const dContactGeom& c : collide(mesh, shape, 16)) {
      CHECK(way.add({c.normal[0], c.normal[1], c.normal[2]}, c.depth));
      named += -c.normal[0] * walls[1].x > 0 && c.depth == 0;
    }
    for (const Vec3d& wall : walls) {
      left += otgDot(wall, otgSub(at, way.value())) - offset < radius - 1e-3 * depth;
    }
    dGeomDestroy(mesh);
    dGeomDestroy(shape);
  }
  CHECK(named > 50);
  CHECK(left == 0);
}
