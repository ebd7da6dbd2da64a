// SPDX-License-Identifier: BSD-3-Clause
// Things in narrow holes: a peg, a nut on its bolt.
#include <fmt/format.h>

#include <cmath>

#include "physics/scene.h"
#include "physics/thread_reference.h"

namespace otg::physics {
namespace {

/// Block of 3 x 3 x 4 m with a square hole of 1 m along z; native: its four walls.
ShapePointer blockWithHole() {
  std::vector<NativeGeom> walls;
  for (const double side : {-1.0, 1.0}) {
    walls.push_back({NativeGeom::Kind::kBox, Vec(1, 3, 4), Vec(side, 0, 0)});
    walls.push_back({NativeGeom::Kind::kBox, Vec(1, 1, 4), Vec(0, side, 0)});
  }
  return makeStaticShape(scenes::makeBlockWithHole({3, 3, 4}, 1), walls);
}

Scene peg(int tenthsOfMu) {
  Scene scene;
  scene.name = fmt::format("peg_mu{}", tenthsOfMu);
  scene.family = "insertion";
  scene.what = fmt::format("A peg with 1 % clearance in a hole leans on its wall and slides, mu 0.{}", tenthsOfMu);
  scene.run = [tenthsOfMu](const Case& run) {
    RigOptions options;
    options.mu = 0.1 * tenthsOfMu;
    // Mostly sideways; along the hole it slides for mu below 0.27.
    options.gravity = 9.81 * Vec(std::cos(0.262), 0, -std::sin(0.262));
    Rig rig(run, options);
    rig.addStatic(blockWithHole(), {0, 0, 0});
    rig.addBody(boxShape({0.99, 0.99, 2}), {0, 0, 0.83});
    rig.run(3);
    Result result = resultOf(rig);
    result.measures["z"] = rig.position(0).z();
    return result;
  };
  scene.limits = {ofNative("z", Limit::Kind::kWithinOfNative, 0.1), atMost("energy_gain", 0.05)};
  scene.steppings = {kW, kQ20};
  // At 1/60 s the discretised fall alone moves z by more than the limit when both impacts come a step apart.
  scene.seconds = 3;
  scene.quick = tenthsOfMu != 2;
  return scene;
}

/// How long a peg that starts half way in, tilted and off the middle as far as the hole lets it, takes for 0.2 m.
Scene tiltedPeg() {
  Scene scene;
  scene.name = "peg_tilted";
  scene.family = "insertion";
  scene.what = "A peg with 1 % clearance starts tilted in the mouth of a hole; the time for 0.2 m";
  scene.run = [](const Case& run) {
    RigOptions options;
    options.mu = 0.2;
    Rig rig(run, options);
    rig.addStatic(blockWithHole(), {0, 0, 0});
    rig.addBody(boxShape({0.99, 0.99, 2}), {0.001, 0, 2}, about(Vec::UnitY(), 0.4));
    double drop = 3;
    rig.run(3, [&] {
      if (drop == 3 && rig.position(0).z() < 1.8) drop = rig.time();
      return drop == 3;
    });
    Result result = resultOf(rig);
    result.measures["drop"] = drop;
    return result;
  };
  scene.limits = {ofNative("drop", Limit::Kind::kWithinOfNative, 0.1), atMost("energy_gain", 0.05)};
  scene.steppings = {kW, kQ20};
  scene.dt = 1.0 / 240;
  scene.seconds = 3;
  return scene;
}

Scene nut(double dt) {
  Scene scene;
  scene.name = fmt::format("nut_{:.0f}ms", 1000 * dt);
  scene.family = "insertion";
  scene.what = "A nut runs down a bolt of 96 segments without friction for 4 s; share of the plastic-impact reference";
  scene.dt = dt;
  scene.run = [](const Case& run) {
    constexpr double kRadius = 0.5, kPitch = 0.2, kHeight = 1;
    constexpr int kSegments = 96;
    constexpr double kSeconds = 4;
    RigOptions options;
    options.mu = 0;
    Rig rig(run, options);
    const scenes::MeshArrays bolt = scenes::makeBolt(kRadius, kPitch, 2, kSegments);
    Vec center;
    const ShapePointer nutShape = makeShape(scenes::makeNut(kRadius, kPitch, 0.6, 0.02, kSegments), {}, &center);
    rig.addStatic(makeStaticShape(bolt), {0, 0, 0});
    rig.addBody(nutShape, center + Vec(0, 0, kHeight));
    rig.run(kSeconds);
    Result result = resultOf(rig);
    const ThreadSetup setup{bolt,
                            scenes::transformed(nutShape->mesh, {{1, 0, 0, 0, 1, 0, 0, 0, 1},
                                                                 {center.x(), center.y(), center.z() + kHeight}}),
                            kPitch,
                            kSegments,
                            nutShape->inertia(2, 2),
                            9.81};
    const ThreadMotion reference = plasticThreadReference(setup, kSeconds);
    const double travel = rig.position(0).z() - rig.startPosition(0).z();
    result.measures["travel"] = travel;
    result.measures["reference"] = reference.travel;
    result.measures["reference_angle"] = reference.angle;
    result.measures["share"] = travel / reference.travel;
    result.measures["tilt"] = rig.tilt(0);
    return result;
  };
  scene.limits = {atLeast("share", 0.7), atMost("share", 1.15), atMost("energy_gain", 0.05),
                  atMost("depth_per_5ms", 0.01)};
  scene.steppings = {kW, kQ20};
  scene.axes = kAxisOrder | kAxisOffset | kAxisSize | kAxisBuffer | kAxisSeed;
  scene.hasNative = false;
  scene.quick = dt > 0.004;
  scene.seconds = 60;
  return scene;
}

}  // namespace

std::vector<Scene> insertionScenes() {
  return {peg(0), peg(1), peg(2), peg(3), tiltedPeg(), nut(0.005), nut(0.002)};
}

}  // namespace otg::physics
