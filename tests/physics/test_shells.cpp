// SPDX-License-Identifier: BSD-3-Clause
// Bodies that are no solids, dropped on solids, sheets and each other: they come to rest where they fall. Poses and
// sizes are random, and the same on every machine.
#include <algorithm>
#include <cstdio>
#include <map>

#include "support/catch.h"
#include "support/cut_ground.h"
#include "support/shell_scenes.h"

using namespace otg;
using namespace otg::test;

namespace {

constexpr int kSteps = 700;  ///< 3.5 s: at rest after three, and for half a second

/// What lies still moves less in half a second. Light plates rock on a terrain for longer than boxes.
constexpr double kStill = 0.05;

struct Count {
  int still = 0, all = 0, fast = 0;
};

/// Drops `each` bodies of a kind; still ones have stayed above `lowest`.
Count dropSome(const scenes::MeshArrays& ground, ShellBody kind, int each, GeomForm form, double height, double reach,
               std::uint32_t seed = 1) {
  const ShellData data(ground, form);
  Draw draw(seed + static_cast<std::uint32_t>(kind));
  Count count;
  for (int i = 0; i < each; ++i) {
    const ShellDrop drop = randomDrop(kind, ground, reach, draw.uniform(0.2, 1) * height, draw);
    const ShellEnd end = letGo(data, drop, form, kSteps);
    const bool isStill = end.moved < kStill && end.position.z > -0.5;
    count.still += isStill ? 1 : 0;
    count.all += 1;
    // No faster than by falling.
    if (end.fastest > std::sqrt(2 * 9.81 * (height + 2))) ++count.fast;
    if (!isStill) {
      std::printf("%s %d: height %g, moved %g, fastest %g\n", nameOf(kind), i, end.position.z, end.moved, end.fastest);
    }
  }
  return count;
}

void checkAll(const scenes::MeshArrays& ground, int each, GeomForm form, double height, double reach = 2.5,
              std::uint32_t seed = 1) {
  for (const ShellBody kind : kShellBodies) {
    const Count count = dropSome(ground, kind, each, form, height, reach, seed);
    INFO(nameOf(kind));
    CHECK(count.still == count.all);
    CHECK(count.fast == 0);
  }
}

const scenes::MeshArrays kSlab = scenes::makeGround(10, 1, 1);
const scenes::MeshArrays kSheet = terrain(10, 1, 0);
const scenes::MeshArrays kTerrain = terrain(10, 40, 0.05);

}  // namespace

TEST_CASE("bodies of all kinds that are dropped on a slab, a sheet and a terrain come to rest there") {
  const OdeSession session;
  for (const auto* ground : {&kSlab, &kSheet, &kTerrain}) checkAll(*ground, 12, GeomForm::kOurs, 0.3);
}

TEST_CASE("bodies of all kinds come to rest from a height") {
  const OdeSession session;
  for (const auto* ground : {&kSlab, &kSheet, &kTerrain}) {
    INFO(ground->triangles.size());
    for (const ShellBody kind : kShellBodies) {
      const Count count = dropSome(*ground, kind, 3, GeomForm::kOurs, 4, 1.5);
      CHECK(count.still == count.all);
    }
  }
}

TEST_CASE("sheets that face down hold what comes from above, and so do grounds with two sides") {
  const OdeSession session;
  for (const auto& ground : {turned(kSheet), turned(kTerrain), twoSided(kTerrain), doubled(kSlab)}) {
    checkAll(ground, 4, GeomForm::kOurs, 0.3);
  }
}

TEST_CASE("bodies of ODE's own dTriMesh that are no solids come to rest through the override") {
  const OdeSession session;
  REQUIRE(dGpuTriMeshOverrideTriMesh() == dGPUTRIMESH_OK);
  // Not on a sheet of two triangles: ODE gives flat meshes boxes without a height, and flat ones never meet.
  for (const auto* ground : {&kSlab, &kTerrain}) checkAll(*ground, 5, GeomForm::kOde, 0.3);
}

TEST_CASE("bodies come to rest on grounds that are hardly larger than they are") {
  const OdeSession session;
  for (const ShellBody kind : kShellBodies) {
    const scenes::MeshArrays ground = makeBody(kind, {1.5, 1.5, 0.5});
    INFO(nameOf(kind));
    Count all;
    for (const ShellBody body : kShellBodies) {
      const Count count = dropSome(ground, body, 2, GeomForm::kOurs, 0.2, 0.05);
      all.still += count.still;
      all.all += count.all;
    }
    // One of them lands on an edge and rolls off, from a solid, too.
    CHECK(all.still + 1 >= all.all);
  }
}

TEST_CASE("a box without lid holds what is dropped into it, though that is behind its walls by their winding") {
  const OdeSession session;
  const ShellData cup(withoutLid(scenes::makeBox({2, 2, 1}), 0.5F), GeomForm::kOurs);
  for (const ShellBody kind : kShellBodies) {
    Draw draw(8);
    for (int i = 0; i < 3; ++i) {
      ShellDrop drop;
      drop.size = {0.6, 0.6, 0.5};
      drop.body = makeBody(kind, drop.size);
      drop.pose =
          makePose(draw.direction(), draw.uniform(0, 6), {draw.uniform(-0.4, 0.4), draw.uniform(-0.4, 0.4), 0.2});
      const ShellEnd end = letGo(cup, drop, GeomForm::kOurs, 600);
      INFO(nameOf(kind) << " " << i);
      CHECK(end.moved < kStill);
      CHECK(end.position.z > -0.52);
      CHECK(end.position.z < 0.5);
    }
  }
}

TEST_CASE("shells slide down a slope as far as formulas say, whatever the tessellation") {
  const OdeSession session;
  constexpr double kAngle = 0.35, kGravity = 9.81;
  for (const ShellBody kind : kShellBodies) {
    for (const double mu : {0.0, 0.2}) {
      for (const int cells : {1, 20}) {
        const ShellData slope(scenes::transformed(terrain(60, cells, 0), makePose({0, 1, 0}, kAngle, {0, 0, 0})),
                              GeomForm::kOurs);
        ShellDrop drop;
        drop.size = {0.8, 0.6, 0.4};
        drop.body = makeBody(kind, drop.size);
        const bool isFlat =
            drop.body.triangles.size() != 12 && kind != ShellBody::kOpenBox && kind != ShellBody::kDoubled;
        const double up = isFlat ? 0.0005 : 0.2005;
        drop.pose = makePose({0, 1, 0}, kAngle, {std::sin(kAngle) * up, 0, std::cos(kAngle) * up});
        const ShellEnd end = letGo(slope, drop, GeomForm::kOurs, 400, mu);
        const double along = end.position.x * std::cos(kAngle) - end.position.z * std::sin(kAngle);
        const double exact = 0.5 * kGravity * (std::sin(kAngle) - mu * std::cos(kAngle)) * 4;
        INFO(nameOf(kind) << " " << mu << " " << cells);
        CHECK(along == Approx(exact).epsilon(0.01));
        CHECK(std::fabs(end.position.y) < 1e-3);
        CHECK(std::sqrt(otgDot(end.spin, end.spin)) < 1e-3);
      }
    }
  }
}

TEST_CASE("spinning shells come to rest") {
  const OdeSession session;
  for (const auto* ground : {&kSlab, &kTerrain}) {
    const ShellData data(*ground, GeomForm::kOurs);
    for (const ShellBody kind : kShellBodies) {
      Draw draw(5);
      for (int i = 0; i < 3; ++i) {
        ShellDrop drop = randomDrop(kind, *ground, 2, 0.2, draw);
        drop.spin = otgScale(draw.direction(), 10.0);
        drop.velocity = {draw.uniform(-2, 2), draw.uniform(-2, 2), 0};
        const ShellEnd end = letGo(data, drop, GeomForm::kOurs, 800, 0.6);
        INFO(nameOf(kind) << " " << i);
        CHECK(end.moved < kStill);
        CHECK(end.position.z > -0.5);
        CHECK(end.fastest < 5);
      }
    }
  }
}

TEST_CASE("a box with a missing face that pushes a box of the same size does not throw it") {
  // Their edges lie in one line, so each point at the rim of the face that pushes is nearer to the faces beside it. Any
  // contact there that presses the box on the floor is one that the exact solver has no bound for.
  const OdeSession session;
  const scenes::MeshArrays whole = scenes::makeBox({1, 1, 1}, 1);
  const ShellData data(whole, GeomForm::kOurs);
  dMass mass;
  dMassSetBoxTotal(&mass, 1, 1, 1, 1);
  Draw draw(7);
  int thrown = 0;
  for (int i = 0; i < 60; ++i) {
    scenes::MeshArrays open = whole;
    const auto face = open.triangles.begin() + 2 * (i % 6);
    open.triangles.erase(face, face + 2);
    const ShellData opened(open, GeomForm::kOurs);
    StepWorld world(0);
    world.setCfm(1e-10);  // ODE's own: nothing softens what contradicts
    const dGeomID floor = dCreatePlane(world.space(), 0, 0, 1, 0);
    const dBodyID pusher = world.addBody(opened.geom(world.space()), mass);
    const dBodyID pushed = world.addBody(data.geom(world.space()), mass);
    const double aside = i < 6 ? 0 : draw.uniform(-1, 1) * (i % 2 == 0 ? 0.3 : 1e-3);
    const double turned = i < 6 ? 0 : draw.uniform(-1, 1) * 1e-3;
    dBodySetKinematic(pusher);
    dBodySetPosition(pusher, -1.1, aside, 0.5);
    dMatrix3 r;
    dRFromAxisAndAngle(r, 0, 0, 1, turned);
    dBodySetRotation(pusher, r);
    dBodySetLinearVel(pusher, 0.5, 0, 0);
    dBodySetPosition(pushed, 0, 0, 0.5);
    double fastest = 0;
    for (int step = 0; step < 300; ++step) {
      world.step(1);
      const dReal* v = dBodyGetLinearVel(pushed);
      fastest = std::max(fastest, std::sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]));
    }
    INFO(i << ", aside " << aside << ", turned " << turned);
    dGeomDestroy(floor);
    constexpr int kWithoutFront = 1;  // walls alone, which may slip over the box and jam there
    if (i % 6 == kWithoutFront) continue;
    if (i < 6) CHECK(fastest < 1);
    thrown += fastest < 1 ? 0 : 1;
    CHECK(dBodyGetPosition(pushed)[0] > 0.6);  // the pusher has come to -0.35
  }
  CHECK(thrown <= 1);  // one by 2e-7 and 6e-5 radians; 14 without the rule
}

TEST_CASE("stacks of four boxes that are no solids stand, turned against each other") {
  const OdeSession session;
  for (const ShellBody kind : {ShellBody::kOpenBox, ShellBody::kMisoriented, ShellBody::kDoubled}) {
    const ShellData ground(kSlab, GeomForm::kOurs), box(makeBody(kind, {0.8, 0.8, 0.3}), GeomForm::kOurs);
    StepWorld world(0.6);
    ground.geom(world.space());
    dMass mass;
    dMassSetBoxTotal(&mass, 1, 0.8, 0.8, 0.3);
    std::vector<dBodyID> bodies;
    for (int i = 0; i < 4; ++i) {
      bodies.push_back(world.addBody(box.geom(world.space()), mass));
      dBodySetPosition(bodies.back(), static_cast<dReal>(0.02 * i), static_cast<dReal>(0.01 * i),
                       static_cast<dReal>(0.16 + 0.31 * i));
      dMatrix3 r;
      dRFromAxisAndAngle(r, 0, 0, 1, static_cast<dReal>(0.1 * i));
      dBodySetRotation(bodies.back(), r);
    }
    world.step(800);
    for (int i = 0; i < 4; ++i) {
      INFO(nameOf(kind) << " " << i);
      CHECK(std::fabs(dBodyGetPosition(bodies[std::size_t(i)])[2] - (0.15 + 0.3 * i)) < 2e-3);
    }
  }
}

namespace {

struct Gain {
  double all = 0, most = 0;  ///< J/kg: of all bodies together, and in one step
};

/// Bodies that fall and slide on terrains: what energy they gain from one step to the next.
Gain gainOn(const std::vector<scenes::MeshArrays>& pieces, const scenes::MeshArrays& whole, ShellBody kind, int bodies,
            bool isJoined = false) {
  std::vector<std::unique_ptr<Data>> data;
  for (const scenes::MeshArrays& piece : pieces) data.push_back(std::make_unique<Data>(piece));
  Draw draw(3);
  Gain gain;
  for (int b = 0; b < bodies; ++b) {
    StepWorld world(0.5);
    std::vector<dGeomID> ground;
    for (const auto& piece : data) ground.push_back(dCreateGpuTriMesh(world.space(), piece->id));
    if (isJoined) REQUIRE(dGpuTriMeshJoin(ground.data(), 64) == 64);
    const ShellDrop drop = randomDrop(kind, whole, 3, draw.uniform(0.05, 0.5), draw);
    const Data mesh(drop.body);
    dMass mass;
    dMassSetBoxTotal(&mass, 1, drop.size.x, drop.size.y, drop.size.z);
    const dGeomID geom = dCreateGpuTriMesh(world.space(), mesh.id);
    const dBodyID body = world.addBody(geom, mass);
    setPose(geom, drop.pose);
    dBodySetLinearVel(body, static_cast<dReal>(draw.uniform(-3, 3)), static_cast<dReal>(draw.uniform(-3, 3)), 0);
    const auto energy = [&] {
      const dReal *v = dBodyGetLinearVel(body), *w = dBodyGetAngularVel(body);
      dVector3 own;
      dBodyVectorFromWorld(body, w[0], w[1], w[2], own);
      double sum = 0.5 * (v[0] * v[0] + v[1] * v[1] + v[2] * v[2]) + 9.81 * dBodyGetPosition(body)[2];
      for (int k = 0; k < 3; ++k) sum += 0.5 * mass.I[5 * k] * own[k] * own[k];
      return sum;
    };
    double before = energy();
    for (int i = 0; i < 500; ++i) {
      world.step(1);
      const double now = energy();
      gain.all += std::max(0.0, now - before);
      gain.most = std::max(gain.most, now - before);
      before = now;
    }
    CHECK(dBodyGetPosition(body)[2] > -1);
  }
  return gain;
}

}  // namespace

TEST_CASE("bodies gain no more energy on a terrain in 8 x 8 pieces than on the whole") {
  const OdeSession session;
  const scenes::MeshArrays whole = terrain(10, 40, 0.3);
  const auto pieces = cutTerrain(whole, 10, 8);
  for (const ShellBody kind : {ShellBody::kQuad, ShellBody::kOpenBox, ShellBody::kDoubled, ShellBody::kClosedBox}) {
    const Gain one = gainOn({whole}, whole, kind, 12), many = gainOn(pieces, whole, kind, 12);
    const Gain joined = gainOn(pieces, whole, kind, 12, true);
    std::printf("%s: gained %g, largest %g J/kg; in pieces %g, %g; joined %g, %g\n", nameOf(kind), one.all / 12,
                one.most, many.all / 12, many.most, joined.all / 12, joined.most);
    INFO(nameOf(kind));
    CHECK(many.all <= 1.2 * one.all);
    CHECK(many.most <= 0.03);
    CHECK(joined.all <= 1.2 * one.all);
    CHECK(joined.most <= 1.2 * one.most);
  }
}
