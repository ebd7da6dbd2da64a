// SPDX-License-Identifier: BSD-3-Clause
// Random meshes of every bad kind, on and in each other, beside stock ODE in the same scene.
#include <cstdio>
#include <map>
#include <string>

#include "base/vectors.h"
#include "collide/pair_history.h"
#include "support/catch.h"
#include "support/hostile_meshes.h"

using namespace otg;
using namespace otg::test;

namespace {

/// Whose contacts: ODE's own, ours for dTriMesh geoms, ours for geoms of our class.
enum class Side { kStock, kOverride, kOurs };
constexpr std::array kSides = {Side::kStock, Side::kOverride, Side::kOurs};

class SideSession {
 public:
  explicit SideSession(Side side) {
    if (side == Side::kOverride) REQUIRE(dGpuTriMeshOverrideTriMesh() == dGPUTRIMESH_OK);
  }

 private:
  OdeSession session_;
};

GeomForm formOf(Side side) {
  return side == Side::kOurs ? GeomForm::kOurs : GeomForm::kOde;
}

struct Scene {
  scenes::MeshArrays ground;
  ShellDrop drop;
};

/// J/kg that a body has more than when it was let go: it moves by 1 m/s more than by falling.
constexpr double kThrown = 0.5;

struct Fate {
  bool isAtRest = false, isThrown = false;
  int missed = 0;  ///< of the steps looked at, those in which triangles meet without a contact
};

Fate letGoOn(const Scene& scene, Side side, int steps, const CollisionMesh& groundMesh, const CollisionMesh& bodyMesh) {
  const ShellData ground(scene.ground, formOf(side)), data(scene.drop.body, formOf(side));
  StepWorld world(1);
  const dGeomID fixed = ground.geom(world.space()), geom = data.geom(world.space());
  dMass mass;
  dMassSetBoxTotal(&mass, 1, scene.drop.size.x, scene.drop.size.y, scene.drop.size.z);
  const dBodyID body = world.addBody(geom, mass);
  setPose(geom, scene.drop.pose);
  Fate fate;
  Vec3d then{};
  Workspace workspace;
  for (int i = 0; i < steps; ++i) {
    if (i % 10 == 0) {
      Transformd pose{};
      const dReal *r = dGeomGetRotation(geom), *x = dGeomGetPosition(geom);
      for (int k = 0; k < 9; ++k) pose.r[k] = r[4 * (k / 3) + k % 3];
      pose.t = {x[0], x[1], x[2]};
      findIntersectingPairs(makeQuery(groundMesh, bodyMesh, pose), workspace);
      if (!workspace.intersecting.empty()) {
        dContactGeom contact[32];
        if (dCollide(fixed, geom, 32, contact, sizeof contact[0]) == 0) ++fate.missed;
      }
    }
    world.step(1);
    const dReal* const v = dBodyGetLinearVel(body);
    const double height = dBodyGetPosition(body)[2] - scene.drop.pose.t.z;
    if (0.5 * (v[0] * v[0] + v[1] * v[1] + v[2] * v[2]) + 9.81 * height > kThrown) fate.isThrown = true;
    if (i == steps - 100) then = {dBodyGetPosition(body)[0], dBodyGetPosition(body)[1], dBodyGetPosition(body)[2]};
  }
  const dReal* const x = dBodyGetPosition(body);
  const Vec3d moved = Vec3d{x[0], x[1], x[2]} - then;
  fate.isAtRest = norm(moved) < 0.05 && x[2] > -1.5;
  return fate;
}

}  // namespace

TEST_CASE("overlapped pairs have contacts where either is a solid or a sheet, and else as often as ODE's") {
  struct Pair {
    scenes::MeshArrays a, b;
    Transformd pose;
    bool isFirm;
    std::string name;
  };
  std::vector<Pair> pairs;
  Draw draw(11);
  for (const Hostile x : kHostile) {
    for (const Hostile y : kHostile) {
      for (int i = 0; i < 4; ++i) {
        const auto size = [&] { return Vec3d{draw.uniform(0.4, 2), draw.uniform(0.4, 2), draw.uniform(0.3, 1)}; };
        Pair pair{makeHostile(x, size(), draw), makeHostile(y, size(), draw), {}, false, ""};
        const MeshPtr meshA = collisionMesh(pair.a), meshB = collisionMesh(pair.b);
        const CollisionMesh &a = *meshA, &b = *meshB;
        Workspace workspace;
        for (int k = 0; k < 100; ++k) {
          pair.pose = makePose(draw.direction(), draw.uniform(0, 6.28),
                               {draw.uniform(-1, 1), draw.uniform(-1, 1), draw.uniform(-0.6, 0.6)});
          findIntersectingPairs(makeQuery(a, b, pair.pose), workspace);
          if (!workspace.intersecting.empty()) break;
        }
        if (workspace.intersecting.empty()) continue;
        const auto isFirm = [](const TriMesh& m) { return m.meshClass() == MeshClass::kSolid || isSheet(m); };
        pair.isFirm = isFirm(a.mesh()) || isFirm(b.mesh());
        pair.name = std::string(nameOf(x)) + " / " + nameOf(y);
        pairs.push_back(std::move(pair));
      }
    }
  }
  std::map<Side, int> missingFirm, missing;
  for (const Side side : kSides) {
    const SideSession session(side);
    std::map<std::string, int> names;
    for (const Pair& pair : pairs) {
      const ShellData dataA(pair.a, formOf(side)), dataB(pair.b, formOf(side));
      const dGeomID a = dataA.geom(nullptr), b = dataB.geom(nullptr);
      setPose(b, pair.pose);
      const bool isNone = collide(a, b, 64).empty();
      (pair.isFirm ? missingFirm : missing)[side] += isNone ? 1 : 0;
      if (isNone && side != Side::kStock) ++names[pair.name];
      dGeomDestroy(a);
      dGeomDestroy(b);
    }
    std::printf("side %d: without contacts %d firm, %d others of %zu\n", static_cast<int>(side), missingFirm[side],
                missing[side], pairs.size());
    for (const auto& [name, count] : names) std::printf("   %s: %d\n", name.c_str(), count);
  }
  for (const Side side : {Side::kOverride, Side::kOurs}) {
    CHECK(missingFirm[side] == 0);
    CHECK(missing[side] <= missing[Side::kStock]);
  }
}

namespace {

struct NamedScene {
  std::string ground;
  Hostile kind;
  Scene scene;
};

/// The body `clearance` over what lies below it.
NamedScene sceneOf(const std::string& name, const scenes::MeshArrays& ground, Hostile kind, double reach, Draw& draw) {
  Scene scene;
  scene.ground = ground;
  ShellDrop& drop = scene.drop;
  drop.size = {draw.uniform(0.4, 1.2), draw.uniform(0.4, 1.2), draw.uniform(0.3, 0.8)};
  drop.body = makeHostile(kind, drop.size, draw);
  drop.pose = makePose(draw.direction(), draw.uniform(0, 6.28), {0, 0, 0});
  double lowest = 0, highest = -10;
  for (const Vec3f& v : drop.body.vertices) lowest = std::min(lowest, otgTransform(drop.pose, Vec3d{v.x, v.y, v.z}).z);
  drop.pose.t = {draw.uniform(-reach, reach), draw.uniform(-reach, reach), 0};
  for (const Vec3f& v : ground.vertices) {
    const double x = v.x - drop.pose.t.x, y = v.y - drop.pose.t.y;
    if (x * x + y * y < 1.5 || ground.vertices.size() < 100) highest = std::max(highest, double{v.z});
  }
  drop.pose.t.z = highest - lowest + draw.uniform(0.05, 0.3);
  return {name, kind, std::move(scene)};
}

/// Every kind on a slab, a sheet, a terrain and on every kind.
std::vector<NamedScene> allScenes(int each) {
  std::vector<NamedScene> all;
  Draw draw(21);
  for (const Hostile kind : kHostile) {
    for (int i = 0; i < 3 * each; ++i) {
      all.push_back(sceneOf("slab", scenes::makeGround(10, 1, 1), kind, 2, draw));
      all.push_back(sceneOf("sheet", terrain(10, 1, 0), kind, 2, draw));
      all.push_back(sceneOf("terrain", terrain(10, 40, 0.05), kind, 2, draw));
    }
    for (const Hostile below : kHostile) {
      for (int i = 0; i < each; ++i) {
        const Vec3d size{draw.uniform(2, 5), draw.uniform(2, 5), draw.uniform(0.5, 1)};
        all.push_back(sceneOf(std::string("on ") + nameOf(below), makeHostile(below, size, draw), kind, 0.4, draw));
      }
    }
  }
  return all;
}

/// By side.
struct Sum {
  int rest[3] = {0, 0, 0}, thrown[3] = {0, 0, 0}, missed[3] = {0, 0, 0}, all = 0;

  void add(Side side, const Fate& fate) {
    const auto s = static_cast<std::size_t>(side);
    rest[s] += fate.isAtRest ? 1 : 0;
    thrown[s] += fate.isThrown ? 1 : 0;
    missed[s] += fate.missed;
    all += side == Side::kStock ? 1 : 0;
  }
};

void show(const std::string& name, const Sum& s) {
  std::printf("%-14s of %4d: at rest %4d %4d %4d, thrown %3d %3d %3d, without contacts %2d %2d %2d\n", name.c_str(),
              s.all, s.rest[0], s.rest[1], s.rest[2], s.thrown[0], s.thrown[1], s.thrown[2], s.missed[0], s.missed[1],
              s.missed[2]);
}

/// `chance`: how many of a group may lie elsewhere than with ODE, because they rolled off or came to lie at its edge.
void check(const std::string& name, const Sum& sum, int chance) {
  show(name, sum);
  INFO(name);
  for (const std::size_t side : {1u, 2u}) {
    // Needles are left to ODE through the override: there it has more at rest, and throws five times as many.
    if (side == 1 || name != "on needles") CHECK(sum.rest[side] + chance >= sum.rest[0]);
    CHECK(sum.thrown[side] <= sum.thrown[0] + chance / 2);
    CHECK(sum.missed[side] <= sum.missed[0]);
  }
}

}  // namespace

TEST_CASE("bad meshes on each other and on firm ground: at rest as often as with ODE, thrown no more often") {
  constexpr int kEach = 2, kSteps = 500;
  const std::vector<NamedScene> all = allScenes(kEach);
  std::map<std::string, Sum> byGround, byKind;
  Sum sum;
  std::vector<MeshPtr> grounds, bodies;
  for (const NamedScene& one : all) {
    grounds.push_back(collisionMesh(one.scene.ground));
    bodies.push_back(collisionMesh(one.scene.drop.body));
  }
  for (const Side side : kSides) {
    const SideSession session(side);
    for (std::size_t i = 0; i < all.size(); ++i) {
      const Fate fate = letGoOn(all[i].scene, side, kSteps, *grounds[i], *bodies[i]);
      for (Sum* const to : {&byGround[all[i].ground], &byKind[nameOf(all[i].kind)], &sum}) to->add(side, fate);
    }
  }
  for (const auto* groups : {&byGround, &byKind}) {
    for (const auto& [name, group] : *groups) check(name, group, 3);
  }
  check("all", sum, 0);
}
