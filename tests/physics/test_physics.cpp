// SPDX-License-Identifier: BSD-3-Clause
// What worlds of mesh bodies must do with the default contact model: rest, keep momentum, gain no energy, repeat.
#include <cmath>

#include "physics/lumps.h"
#include "physics/scene.h"
#include "support/catch.h"

using namespace otg::physics;

namespace {

Case caseOf(const Stepping& stepping) {
  Case run;
  run.stepping = stepping;
  return run;
}

/// Two figures that fly at each other, off centre, so that they also start to spin.
void addFlyingPair(Rig& rig) {
  rig.addBody(limbedShape(1, 3), {-0.8, 0, 0});
  rig.addBody(limbedShape(2, 3), {0.8, 0.2, 0.1});
  rig.setVelocity(0, {1.5, 0, 0});
  rig.setVelocity(1, {-0.5, 0, 0.1});
}

RigOptions weightless() {
  RigOptions options;
  options.gravity = Vec::Zero();
  return options;
}

}  // namespace

TEST_CASE("A box mesh rests on a ground mesh") {
  const OdeSession session;
  const Stepping stepping = GENERATE(kW, kQ20);
  const int divisions = GENERATE(1, 20);
  CAPTURE(nameOf(stepping), divisions);
  Rig rig(caseOf(stepping));
  rig.addStatic(groundShape(20, 1, divisions), {0, 0, 0});
  rig.addBody(boxShape({1, 1, 1}), {0.137, 0.071, 0.5}, about(Vec::UnitZ(), 17));
  rig.run(5);
  const Measures m = rig.measures();
  // It would have fallen 120 m.
  CHECK(m.at("settle") < 1e-5);
  CHECK(m.at("contacts") >= 3);
  CHECK(rig.worstDrift() < 1e-4);
  CHECK(rig.worstTilt() < 1e-2);
  CHECK(m.at("ke") < 1e-6);
}

TEST_CASE("A box mesh rests on a ground mesh, small, large, far away and in any order of the geoms") {
  const OdeSession session;
  Case run = caseOf(kW);
  run.size = GENERATE(0.01, 1.0, 100.0);
  run.offset = GENERATE(0.0, 1e5);
  run.order = GENERATE(Order::kAsMade, Order::kSwapped, Order::kReversed);
  // At 1e5 m a double resolves 1.5e-11 m, which is a few depths of contact of a box of 1 cm.
  if (run.size < 1 && run.offset > 0) return;
  CAPTURE(describe(run));
  Rig rig(run);
  rig.addStatic(groundShape(20, 1, 20), {0, 0, 0});
  rig.addBody(boxShape({1, 1, 1}), {0.137, 0.071, 0.5}, about(Vec::UnitZ(), 17));
  rig.run(2);
  CHECK(rig.measures().at("settle") < 1e-4);
  CHECK(rig.worstDrift() < 1e-3);
  CHECK(rig.worstTilt() < 0.1);
}

TEST_CASE("Resting and falling bodies gain no energy") {
  const OdeSession session;
  // Of each family one scene that the contact model of triangle pairs is sound in.
  const std::string name = GENERATE("box_on_ground_800", "tori", "chain", "figures");
  const Scene* scene = findScene(name);
  REQUIRE(scene);
  Case run = caseOf(kQ20);
  run.scene = name;
  const Result result = scene->run(run);
  CAPTURE(name);
  CHECK(result.measures.at("energy_gain") <= 0.01);
  CHECK(result.measures.at("contacts") > 1);
  CHECK(result.measures.at("max_speed") < 10);
}

TEST_CASE("Two bodies that collide keep their momentum") {
  const OdeSession session;
  const Stepping stepping = GENERATE(kW, kQ20);
  CAPTURE(nameOf(stepping));
  Rig rig(caseOf(stepping), weightless());
  addFlyingPair(rig);
  const auto momentum = [&] { return Vec(rig.velocity(0) + rig.velocity(1)); };
  const Vec before = momentum();
  const double energy = rig.energy();
  double worst = 0;
  rig.run(2, [&] {
    worst = std::max(worst, (momentum() - before).norm());
    return true;
  });
  CHECK(worst < 1e-12);
  // They did collide.
  CHECK((rig.velocity(0) - Vec(1.5, 0, 0)).norm() > 0.1);
  CHECK(rig.energy() < energy);
}

TEST_CASE("A world that is stepped twice gives identical bytes") {
  const OdeSession session;
  const Stepping stepping = GENERATE(kW, kQ20);
  CAPTURE(nameOf(stepping));
  const auto hashAfter = [&](double seconds) {
    Rig rig(caseOf(stepping));
    rig.addStatic(groundShape(20, 1, 8), {0, 0, -1});
    addFlyingPair(rig);
    rig.run(seconds);
    return rig.stateHash();
  };
  CHECK(hashAfter(1) == hashAfter(1));
  CHECK(hashAfter(1) != hashAfter(1.005));
}
