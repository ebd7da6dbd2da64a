// SPDX-License-Identifier: BSD-3-Clause
// Boxes that slide: the tessellation of the ground must not be felt.
#include <fmt/format.h>

#include <cmath>

#include "physics/scene.h"

namespace otg::physics {
namespace {

constexpr int kDivisions[] = {1, 20, 64};

Scene slope(int n) {
  Scene scene;
  scene.name = fmt::format("slope_{}", 2 * n * n);
  scene.family = "sliding";
  scene.what =
      fmt::format("A box slides down 30 degrees of {} triangles with mu 0.5 for 2 s (exact: 1.314 m)", 2 * n * n);
  scene.run = [n](const Case& run) {
    RigOptions options;
    options.mu = 0.5;
    Rig rig(run, options);
    const Rotation turn = about(Vec::UnitY(), 30);
    rig.addStatic(groundShape(20, 1, n), {0, 0, 0}, turn);
    const Vec start = turn * Vec(-1.37, 0.071, 0.5);
    rig.addBody(boxShape({1, 1, 1}), start, turn);
    rig.run(2);
    Result result = resultOf(rig);
    const Vec moved = turn.conjugate() * (rig.position(0) - start);
    result.measures["distance"] = moved.x();
    result.measures["sideways"] = std::abs(moved.y());
    return result;
  };
  scene.limits = {ofNative("distance", Limit::Kind::kWithinShareOfNative, 0.02), atMost("sideways", 1e-3),
                  atMost("energy_gain", 1e-3)};
  scene.steppings = {kW, kQ20};
  scene.seconds = 2;
  return scene;
}

Scene slide(int n) {
  Scene scene;
  scene.name = fmt::format("slide_{}", 2 * n * n);
  scene.family = "sliding";
  scene.what = fmt::format("A box slides 20 m at 5 m/s without friction over {} triangles", 2 * n * n);
  scene.run = [n](const Case& run) {
    RigOptions options;
    options.mu = 0;
    Rig rig(run, options);
    rig.addStatic(groundShape(60, 1, n), {0, 0, 0});
    rig.addBody(boxShape({1, 1, 1}), {-10.2, 0.071, 0.5});
    rig.setVelocity(0, {5, 0, 0});
    rig.run(4);
    Result result = resultOf(rig);
    result.measures["speed_lost"] = std::abs(5 - rig.velocity(0).x());
    result.measures["sideways"] = std::abs(rig.position(0).y() - rig.startPosition(0).y());
    result.measures["tilt"] = rig.tilt(0);
    return result;
  };
  scene.limits = {atMost("speed_lost", 1e-4), atMost("sideways", 1e-4), atMost("tilt", 0.01),
                  atMost("energy_gain", 1e-3)};
  scene.steppings = {kW, kQ20};
  scene.seconds = 4;
  return scene;
}

}  // namespace

std::vector<Scene> slidingScenes() {
  std::vector<Scene> scenes;
  for (const int n : kDivisions) scenes.push_back(slope(n));
  for (const int n : kDivisions) scenes.push_back(slide(n));
  return scenes;
}

}  // namespace otg::physics
