// SPDX-License-Identifier: BSD-3-Clause
// ODE's own shapes on meshes of every bad kind, beside stock ODE in the same scene.
#include <algorithm>
#include <cstdio>
#include <map>
#include <string>

#include "support/catch.h"
#include "support/hostile_meshes.h"

using namespace otg;
using namespace otg::test;

namespace {

constexpr std::array kShapes = {dSphereClass, dBoxClass, dCapsuleClass, dCylinderClass};
const char* nameOfShape(int shape) {
  return shape == dSphereClass ? "ball" : shape == dBoxClass ? "box" : shape == dCapsuleClass ? "capsule" : "cylinder";
}

struct Drop {
  scenes::MeshArrays ground;
  std::string name;
  int shape = 0;
  double radius = 0, half = 0;  ///< of a box: its largest half side and its smallest
  Transformd pose{};
};

dGeomID makeShape(const Drop& drop, dSpaceID space, dMass& mass) {
  const double r = drop.radius, h = drop.half;
  dMassSetBoxTotal(&mass, 1, 2 * r, 2 * r, 2 * h);
  switch (drop.shape) {
    case dSphereClass:
      dMassSetSphereTotal(&mass, 1, r);
      return dCreateSphere(space, r);
    case dBoxClass:
      return dCreateBox(space, 2 * r, 1.4 * r, 2 * h);
    case dCapsuleClass:
      return dCreateCapsule(space, r, 2 * h);
    default:
      return dCreateCylinder(space, r, 2 * h);
  }
}

Drop dropOn(const std::string& name, const scenes::MeshArrays& ground, int shape, double reach, Draw& draw) {
  Drop drop{ground, name, shape, draw.uniform(0.15, 0.5), draw.uniform(0.1, 0.4), {}};
  const Vec3d axis = draw.direction();
  const double angle = draw.uniform(0, 6.28);
  drop.pose = makePose(axis, angle, {draw.uniform(-reach, reach), draw.uniform(-reach, reach), 0});
  double highest = -10;
  for (const Vec3f& v : ground.vertices) {
    const double x = v.x - drop.pose.t.x, y = v.y - drop.pose.t.y;
    if (x * x + y * y < 1.5 || ground.vertices.size() < 100) highest = std::max(highest, double{v.z});
  }
  drop.pose.t.z = highest + drop.radius + drop.half + draw.uniform(0.05, 0.3);
  return drop;
}

constexpr double kThrown = 0.5;  ///< J/kg more than it had: it moves by 1 m/s more than by falling

struct Fate {
  bool isAtRest = false, isThrown = false;
};

Fate letGo(const Drop& drop, GeomForm form, int steps) {
  const ShellData ground(drop.ground, form);
  StepWorld world(1);
  ground.geom(world.space());
  dMass mass;
  const dGeomID geom = makeShape(drop, world.space(), mass);
  const dBodyID body = world.addBody(geom, mass);
  setPose(geom, drop.pose);
  dBodySetAngularDamping(body, 0.05);  // a ball on a plain comes to rest, too
  dBodySetLinearDamping(body, 0.01);
  Fate fate;
  Vec3d then{};
  for (int i = 0; i < steps; ++i) {
    world.step(1);
    const dReal *const v = dBodyGetLinearVel(body), *const x = dBodyGetPosition(body);
    const double height = x[2] - drop.pose.t.z;
    if (0.5 * (v[0] * v[0] + v[1] * v[1] + v[2] * v[2]) + 9.81 * height > kThrown) fate.isThrown = true;
    if (i == steps - 100) then = {x[0], x[1], x[2]};
  }
  const dReal* const x = dBodyGetPosition(body);
  fate.isAtRest = norm(Vec3d{x[0], x[1], x[2]} - then) < 0.05 && x[2] > -1.5;
  return fate;
}

/// Of stock ODE and of this library.
struct Sum {
  int rest[2] = {0, 0}, thrown[2] = {0, 0}, all = 0;

  void add(const Fate (&fates)[2]) {
    ++all;
    for (int side = 0; side < 2; ++side) {
      rest[side] += fates[side].isAtRest ? 1 : 0;
      thrown[side] += fates[side].isThrown ? 1 : 0;
    }
  }
};

void check(const std::string& name, const Sum& sum, int chance) {
  std::printf("%-14s of %4d: at rest %4d %4d, thrown %3d %3d\n", name.c_str(), sum.all, sum.rest[0], sum.rest[1],
              sum.thrown[0], sum.thrown[1]);
  INFO(name);
  CHECK(sum.rest[1] + chance >= sum.rest[0]);
  CHECK(sum.thrown[1] <= sum.thrown[0] + chance / 2);
}

}  // namespace

TEST_CASE("ODE's shapes on bad meshes: at rest as often as with ODE's, thrown no more often") {
  constexpr int kEach = 12, kSteps = 600;
  std::vector<Drop> drops;
  Draw draw(31);
  for (const int shape : kShapes) {
    for (int i = 0; i < kEach; ++i) {
      drops.push_back(dropOn("sheet", terrain(10, 1, 0), shape, 2, draw));
      drops.push_back(dropOn("terrain", terrain(10, 40, 0.05), shape, 2, draw));
      for (const Hostile below : kHostile) {
        const Vec3d size{draw.uniform(2, 5), draw.uniform(2, 5), draw.uniform(0.5, 1)};
        drops.push_back(dropOn(nameOf(below), makeHostile(below, size, draw), shape, 0.4, draw));
      }
    }
  }
  const OdeSession session;
  std::map<std::string, Sum> groups;
  Sum sum;
  for (const Drop& drop : drops) {
    const Fate fates[2] = {letGo(drop, GeomForm::kOde, kSteps), letGo(drop, GeomForm::kOurs, kSteps)};
    sum.add(fates);
    groups[drop.name].add(fates);
    groups[nameOfShape(drop.shape)].add(fates);
  }
  for (const auto& [name, group] : groups) check(name, group, 3);
  check("all", sum, 0);
}

namespace {

/// Houses without floors on a plain, all in one mesh. Most of the area is walls, which face all ways.
scenes::MeshArrays town(Draw& draw) {
  constexpr int kAcross = 8;
  scenes::MeshArrays mesh = flatSheet(20, 20, 4);
  for (int k = 0; k < kAcross * kAcross; ++k) {
    const double x = draw.uniform(0.3, 1), y = draw.uniform(0.3, 1), z = draw.uniform(1, 4);
    scenes::MeshArrays house = scenes::makeBox({x, y, z});
    std::erase_if(house.triangles, [&](const Triangle& t) {
      return std::all_of(t.v, t.v + 3, [&](std::uint32_t v) { return house.vertices[v].z < 0; });
    });
    append(mesh, house, {1.2 * (k % kAcross) - 4.2, 1.2 * (k / kAcross) - 4.2, z / 2 - 0.01});
  }
  return mesh;
}

}  // namespace

TEST_CASE("walls that face all ways hold ODE's shapes by their fronts alone") {
  constexpr int kEach = 100, kSteps = 600;
  Draw draw(7);
  const OdeSession session;
  for (const int shape : kShapes) {
    Sum sum;
    for (int i = 0; i < kEach; ++i) {
      const Drop drop = dropOn("town", town(draw), shape, 4, draw);
      sum.add({letGo(drop, GeomForm::kOde, kSteps), letGo(drop, GeomForm::kOurs, kSteps)});
    }
    check(nameOfShape(shape), sum, 5);
  }
}
