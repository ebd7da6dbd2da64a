// SPDX-License-Identifier: BSD-3-Clause
// Bodies that overlap from the start: they must come apart along the shortest way, without being thrown.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

#include "physics/lumps.h"
#include "physics/scene.h"

namespace otg::physics {
namespace {

RigOptions weightless() {
  RigOptions options;
  options.gravity = Vec::Zero();
  return options;
}

Scene overlappedBoxes(int percent) {
  Scene scene;
  scene.name = fmt::format("overlapped_boxes_{}", percent);
  scene.family = "overlaps";
  scene.what =
      fmt::format("Two free boxes overlap by {} % of their width: apart within 0.1 s along that axis", percent);
  scene.run = [percent](const Case& run) {
    Rig rig(run, weightless());
    const double distance = 1 - percent / 100.0;
    // Shifted a little sideways: with equal faces every direction is the shortest.
    for (const double side : {-0.5, 0.5}) rig.addBody(boxShape({1, 1, 1}), {side * distance, side * 0.02, side * 0.03});
    double apart = 10;
    rig.run(0.3, [&] {
      if (apart == 10 && (rig.position(1) - rig.position(0)).cwiseAbs().maxCoeff() >= 1) apart = rig.time();
      return true;
    });
    const Vec speed = rig.velocity(1) - rig.velocity(0);
    Result result = resultOf(rig);
    result.measures["apart"] = apart;
    result.measures["speed"] = speed.norm() / 2;
    result.measures["off_axis_deg"] = std::atan2(speed.tail<2>().norm(), speed.x()) * 180 / std::numbers::pi;
    result.measures["spin"] = std::max(rig.angularVelocity(0).norm(), rig.angularVelocity(1).norm());
    return result;
  };
  scene.limits = {atMost("apart", 0.1), ofNative("speed", Limit::Kind::kAtMostTimesNative, 1.05),
                  atMost("off_axis_deg", 2)};
  scene.steppings = {kW, kQ20};
  scene.seconds = 0.3;
  return scene;
}

Scene contained() {
  Scene scene;
  scene.name = "contained";
  scene.family = "overlaps";
  scene.what = "A small free box lies wholly inside a large fixed one: it leaves, and does not spin";
  scene.run = [](const Case& run) {
    Rig rig(run, weightless());
    rig.addStatic(boxShape({1, 1, 1}), {0, 0, 0});
    rig.addBody(boxShape({0.2, 0.2, 0.2}), {0.25, 0.05, 0.02});
    double out = 10;
    rig.run(0.5, [&] {
      if (out == 10 && rig.position(0).cwiseAbs().maxCoeff() >= 0.6) out = rig.time();
      return true;
    });
    Result result = resultOf(rig);
    result.measures["out"] = out;
    result.measures["speed"] = rig.velocity(0).norm();
    result.measures["spin"] = rig.angularVelocity(0).norm();
    return result;
  };
  scene.limits = {atMost("out", 0.3), atMost("spin", 0.1), ofNative("speed", Limit::Kind::kAtMostTimesNative, 1.5)};
  scene.steppings = {kW, kQ20};
  scene.seconds = 0.5;
  return scene;
}

Scene overlappedFigures(const char* name, double share) {
  Scene scene;
  scene.name = name;
  scene.family = "overlaps";
  scene.what =
      fmt::format("Two free figures with limbs overlap by {} % of their size, in 12 poses: the fastest", 100 * share);
  scene.run = [share](const Case& run) {
    std::mt19937 random(static_cast<std::uint32_t>(run.randomSeed));
    const auto uniform = [&] { return static_cast<double>(random()) / 4294967296.0 * 2 - 1; };
    const ShapePointer a = limbedShape(1), b = limbedShape(2);
    Result result;
    for (int i = 0; i < 12; ++i) {
      const double x = uniform(), y = uniform(), z = uniform();
      const Vec direction = Vec(x, y, z).normalized();
      Rig rig(run, weightless());
      rig.addBody(a, {0, 0, 0});
      rig.addBody(b, (touchingDistance(*a, *b, direction) - share * a->extent) * direction);
      rig.run(1);
      for (const auto& [measure, value] : rig.measures()) {
        const auto first = result.measures.emplace(measure, value);
        double& worst = first.first->second;
        worst = measure == "finite" ? std::min(worst, value) : std::max(worst, value);
      }
      if (i == 0) result.energyHistory = rig.energyHistory();
    }
    return result;
  };
  scene.limits = {atMost("max_speed", 2)};
  scene.steppings = {kW, kQ20};
  scene.hasNative = false;
  scene.seconds = 5;
  return scene;
}

}  // namespace

std::vector<Scene> overlapScenes() {
  return {overlappedBoxes(30),
          overlappedBoxes(40),
          overlappedBoxes(50),
          contained(),
          overlappedFigures("overlapped_figures_1", 0.01),
          overlappedFigures("overlapped_figures_01", 0.001)};
}

}  // namespace otg::physics
