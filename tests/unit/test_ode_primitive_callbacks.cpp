// SPDX-License-Identifier: BSD-3-Clause
// Callbacks of a mesh that meets ODE's own geoms: who is asked about which triangles, and what a rejected one does.
// ODE's dTriMesh with the same triangles is asked beside it.
#include <algorithm>
#include <cmath>
#include <set>

#include "support/catch.h"
#include "support/draw.h"
#include "support/ode_world.h"

using namespace otg;
using namespace otg::test;

namespace {

struct Log {
  std::set<int> asked, reported, rejected;
  int times = 0, lists = 0;
  dGeomID other = nullptr;
  void clear() { *this = Log{}; }
};
Log ours, theirs;
std::vector<std::pair<char, int>> order;

int askOurs(dGeomID, dGeomID other, int triangle) {
  ours.other = other;
  ours.asked.insert(triangle);
  ++ours.times;
  order.emplace_back('t', triangle);
  return ours.rejected.count(triangle) == 0;
}
int askTheirs(dGeomID, dGeomID, int triangle) {
  theirs.asked.insert(triangle);
  return theirs.rejected.count(triangle) == 0;
}
void tellOurs(dGeomID, dGeomID, const int* triangles, int count) {
  CHECK(std::is_sorted(triangles, triangles + count));
  CHECK(ours.asked.empty());
  ours.reported.insert(triangles, triangles + count);
  ++ours.lists;
}
int askRay(dGeomID, dGeomID, int triangle, dReal, dReal) {
  order.emplace_back('r', triangle);
  return 1;
}
std::vector<std::pair<int, int>> merged;
int mergeOurs(dGeomID, int first, int second) {
  merged.emplace_back(first, second);
  return 1000000 + second;
}

/// A mesh of ours and a dTriMesh of ODE's with the same triangles.
struct Twins {
  scenes::MeshArrays arrays;
  Data data;
  Geom mesh;
  dTriMeshDataID odeData = dGeomTriMeshDataCreate();
  dGeomID native;
  explicit Twins(const scenes::MeshArrays& from) : arrays(from), data(from), mesh(data) {
    dGeomTriMeshDataBuildSingle(odeData, arrays.vertices.data(), sizeof(Vec3f),
                                static_cast<int>(arrays.vertices.size()), arrays.triangles.data(),
                                static_cast<int>(3 * arrays.triangles.size()), sizeof(Triangle));
    native = dCreateTriMesh(nullptr, odeData, &askTheirs, nullptr, nullptr);
  }
  ~Twins() {
    dGeomDestroy(native);
    dGeomTriMeshDataDestroy(odeData);
  }
  Twins(const Twins&) = delete;
  Twins& operator=(const Twins&) = delete;
};

std::vector<std::pair<const char*, dGeomID>> allPrimitives() {
  return {{"sphere", dCreateSphere(nullptr, 0.3)},
          {"box", dCreateBox(nullptr, 0.5, 0.4, 0.6)},
          {"capsule", dCreateCapsule(nullptr, 0.2, 0.5)},
          {"cylinder", dCreateCylinder(nullptr, 0.3, 0.5)}};
}

bool namesOnly(const std::vector<dContactGeom>& contacts, const std::set<int>& triangles) {
  return std::all_of(contacts.begin(), contacts.end(),
                     [&](const dContactGeom& c) { return triangles.count(c.side1) != 0; });
}

}  // namespace

TEST_CASE("with ODE's shapes array and triangle callbacks get the triangles that are touched, as they do from ODE") {
  const OdeSession session;
  const Twins twins(scenes::makeGround(4, 0.5, 24, [](double x, double y) { return 0.1 * std::sin(3 * x) * y; }));
  std::mt19937 random(7);
  for (const auto& [name, shape] : allPrimitives()) {
    INFO(name);
    int touching = 0;
    for (int i = 0; i < 60; ++i) {
      setRandomPose(shape, random, 0.4);
      // Outside of the mesh for the most part: what ODE does with shapes deep inside is another matter.
      dGeomSetPosition(shape, dGeomGetPosition(shape)[0], dGeomGetPosition(shape)[1],
                       0.25 + 0.1 * dGeomGetPosition(shape)[2]);
      dGeomGpuTriMeshForgetHistory(twins.mesh.id);
      dGeomGpuTriMeshSetCallback(twins.mesh.id, nullptr);
      dGeomGpuTriMeshSetArrayCallback(twins.mesh.id, nullptr);
      const auto plain = test::collide(twins.mesh.id, shape);
      dGeomGpuTriMeshSetCallback(twins.mesh.id, &askOurs);
      dGeomGpuTriMeshSetArrayCallback(twins.mesh.id, &tellOurs);
      ours.clear();
      theirs.clear();
      REQUIRE(sameContacts(test::collide(twins.mesh.id, shape), plain));  // none was rejected
      const auto native = test::collide(twins.native, shape);
      if (native.empty() || plain.empty()) continue;
      ++touching;
      REQUIRE(ours.lists == 1);
      REQUIRE(ours.other == shape);
      REQUIRE(ours.reported == ours.asked);
      REQUIRE(ours.times == static_cast<int>(ours.asked.size()));  // each once
      REQUIRE(std::includes(theirs.asked.begin(), theirs.asked.end(), ours.asked.begin(), ours.asked.end()));
      REQUIRE(namesOnly(plain, ours.asked));
      REQUIRE(namesOnly(native, ours.asked));
      // Every one rejected: nothing, in either order of the call.
      const std::set<int> all = ours.asked;
      ours.clear();
      ours.rejected = all;
      REQUIRE(test::collide(twins.mesh.id, shape).empty());
      ours.asked.clear();
      REQUIRE(test::collide(shape, twins.mesh.id).empty());
      // All but those under one half: contacts with these alone.
      std::set<int> half;
      for (const int t : all) {
        if (t % 2 == 0) half.insert(t);
      }
      ours.clear();
      ours.rejected = half;
      const auto rest = test::collide(twins.mesh.id, shape);
      for (const dContactGeom& c : rest) {
        REQUIRE(half.count(c.side1) == 0);
        REQUIRE(all.count(c.side1) == 1);
      }
    }
    CHECK(touching > 30);
    dGeomDestroy(shape);
  }
}

TEST_CASE("a hole that a callback makes lets a ball fall, and its rim holds a larger one") {
  const OdeSession session;
  // Four quads in a row; the two triangles of one are rejected.
  scenes::MeshArrays strip;
  for (int i = 0; i <= 4; ++i) {
    for (const float y : {-2.0f, 2.0f}) strip.vertices.push_back({float(i), y, 0});
  }
  for (std::uint32_t i = 0; i < 4; ++i) {
    strip.triangles.push_back({{2 * i, 2 * i + 2, 2 * i + 3}});
    strip.triangles.push_back({{2 * i, 2 * i + 3, 2 * i + 1}});
  }
  const Data data(strip);
  const Geom mesh(data);
  dGeomGpuTriMeshSetCallback(mesh.id, &askOurs);
  ours.clear();
  ours.rejected = {2, 3};  // from x = 1 to x = 2
  const dGeomID ball = dCreateSphere(nullptr, 0.4);
  dGeomSetPosition(ball, 1.5, 0, 0.3);
  CHECK(test::collide(mesh.id, ball).empty());
  dGeomSetPosition(ball, 0.5, 0, 0.3);
  const auto onTop = test::collide(mesh.id, ball);
  REQUIRE(onTop.size() == 1);
  CHECK(onTop[0].depth == Approx(0.1));
  dGeomSphereSetRadius(ball, 1);
  dGeomSetPosition(ball, 1.5, 0, 0.8);
  const auto onRim = test::collide(mesh.id, ball);
  REQUIRE(onRim.size() == 2);  // at either edge of the hole
  for (const dContactGeom& c : onRim) {
    CHECK(c.depth == Approx(1 - std::hypot(0.5, 0.8)));
    CHECK(std::abs(c.pos[0] - 1.5) == Approx(0.5));
    CHECK(c.pos[2] == Approx(0).margin(1e-9));
  }
  dGeomDestroy(ball);
}

TEST_CASE("a plane, which ODE asks nobody about, and a heightfield are asked about as well") {
  const OdeSession session;
  const Data data(scenes::makeBox({1, 1, 1}, 2));
  const Geom mesh(data);
  const dGeomID plane = dCreatePlane(nullptr, 0, 0, 1, -0.4);
  const float heights[4] = {0, 0, 0, 0};
  const dHeightfieldDataID field = dGeomHeightfieldDataCreate();
  REQUIRE(dGpuTriMeshHeightfieldDataBuildSingle(field, heights, 0, 4, 4, 2, 2, 1, 0, 1, 0) == dGPUTRIMESH_OK);
  const dGeomID ground = dCreateHeightfield(nullptr, field, 1);
  dMatrix3 upright;
  dRFromAxisAndAngle(upright, 1, 0, 0, M_PI / 2);
  dGeomSetRotation(ground, upright);
  dGeomSetPosition(ground, 0, 0, -0.4);
  for (const dGeomID other : {plane, ground}) {
    dGeomGpuTriMeshSetCallback(mesh.id, nullptr);
    const auto plain = test::collide(mesh.id, other);
    REQUIRE(plain.size() == 4);
    dGeomGpuTriMeshSetCallback(mesh.id, &askOurs);
    dGeomGpuTriMeshSetArrayCallback(mesh.id, &tellOurs);
    ours.clear();
    CHECK(sameContacts(test::collide(mesh.id, other), plain));
    dGeomGpuTriMeshSetArrayCallback(mesh.id, nullptr);
    CHECK(ours.reported.size() ==
          (other == plane ? 8u : 0u) + 16u);  // the foot of the walls; below a plane the bottom, too
    CHECK(namesOnly(plain, ours.asked));
    const int wall = *ours.reported.rbegin();
    const std::set<int> all = ours.asked;
    ours.clear();
    ours.rejected = all;
    CHECK(test::collide(mesh.id, other).empty());
    // All but one.
    ours.rejected.erase(wall);
    const auto one = test::collide(mesh.id, other);
    CHECK(!one.empty());
    for (const dContactGeom& c : one) CHECK(c.side1 == wall);
  }
  dGeomDestroy(plane);
  dGeomDestroy(ground);
  dGpuTriMeshHeightfieldDataDestroy(field);
}

TEST_CASE("a ray passes a rejected triangle; its own callback is asked first, as in ODE") {
  const OdeSession session;
  const Data data(scenes::makeBox({1, 1, 1}));
  const Geom mesh(data);
  const dGeomID ray = dCreateRay(nullptr, 5);
  dGeomRaySet(ray, 0.1, 0.2, 2, 0, 0, -1);
  dGeomRaySetClosestHit(ray, 1);
  const auto top = test::collide(mesh.id, ray);
  REQUIRE(top.size() == 1);
  CHECK(top[0].depth == Approx(1.5));
  dGeomGpuTriMeshSetCallback(mesh.id, &askOurs);
  dGeomGpuTriMeshSetRayCallback(mesh.id, &askRay);
  ours.clear();
  order.clear();
  CHECK(sameContacts(test::collide(mesh.id, ray), top));
  // Triangles come in any order, the two callbacks of each in this one.
  const auto first = std::find(order.begin(), order.end(), std::make_pair('r', top[0].side1));
  REQUIRE(order.end() - first >= 2);
  CHECK(first[1] == std::make_pair('t', top[0].side1));
  CHECK(std::count(order.begin(), order.end(), std::make_pair('t', top[0].side1)) == 1);
  ours.rejected = {top[0].side1};
  const auto bottom = test::collide(mesh.id, ray);
  REQUIRE(bottom.size() == 1);
  CHECK(bottom[0].depth == Approx(2.5));
  dGeomDestroy(ray);
}

TEST_CASE("contacts that do not fit are stood for by the nearest one, with ODE's shapes, too") {
  const OdeSession session;
  const Data data(scenes::makeGround(4, 0.5, 8));
  const Geom mesh(data);
  dGeomGpuTriMeshSetTriMergeCallback(mesh.id, &mergeOurs);
  const dGeomID box = dCreateBox(nullptr, 1.2, 1.2, 1);
  dGeomSetPosition(box, 0.1, 0.1, 0.45);
  merged.clear();
  const auto all = test::collide(mesh.id, box);
  REQUIRE(all.size() >= 4);
  CHECK(merged.empty());
  const auto one = test::collide(mesh.id, box, 1);
  REQUIRE(one.size() == 1);
  REQUIRE(!merged.empty());
  std::set<int> others;
  for (const dContactGeom& c : all) others.insert(c.side1);
  CHECK(merged.size() + 1 == others.size());
  CHECK(one[0].side1 == 1000000 + merged.back().second);
  CHECK(std::is_sorted(merged.begin() + 1, merged.end(),
                       [](const auto& x, const auto& y) { return x.second < y.second; }));
  dGeomDestroy(box);
}
