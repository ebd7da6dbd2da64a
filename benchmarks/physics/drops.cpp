// SPDX-License-Identifier: BSD-3-Clause
// Things that fall on each other without overlap at the start: nothing may gain energy, whatever the shapes.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "physics/lumps.h"
#include "physics/scene.h"

namespace otg::physics {
namespace {

/// Ten seconds of falling and coming to rest.
Result drop(Rig& rig, double seconds = 10) {
  rig.run(seconds);
  Result result = resultOf(rig);
  double lowest = rig.position(0).z();
  for (int i = 0; i < rig.bodyCount(); ++i) lowest = std::min(lowest, rig.position(i).z());
  result.measures["lowest"] = lowest;
  return result;
}

Scene dropScene(const char* name, const char* what, const std::function<Result(const Case&)>& run) {
  Scene scene;
  scene.name = name;
  scene.family = "drops";
  scene.what = what;
  scene.run = run;
  scene.limits = {atMost("energy_gain", 0.05), atMost("depth_per_5ms", 0.01)};
  scene.steppings = {kW, kQ20};
  scene.hasNative = false;
  scene.seconds = 40;
  return scene;
}

Result tori(const Case& run) {
  Rig rig(run);
  const ShapePointer torus = makeShape(scenes::makeTorus(0.5, 0.2, 32, 16));
  rig.addStatic(groundShape(20, 1, 20), {0, 0, 0});
  for (int i = 0; i < 3; ++i)
    rig.addBody(torus, {0.07 * i, -0.05 * i, 0.205 + 0.42 * i}, about(Vec::UnitZ(), 11.0 * i));
  return drop(rig);
}

Result chain(const Case& run) {
  Rig rig(run);
  const ShapePointer link = makeShape(scenes::makeTorus(0.5, 0.1, 32, 12));
  // Every second link is turned by 90 degrees about the vertical and hangs in the hole of the one above, 2 cm clear.
  const auto turn = [](int i) { return about(Vec::UnitZ(), 90.0 * (i % 2)) * about(Vec::UnitX(), 90); };
  rig.addStatic(link, {0, 0, 0}, turn(0));
  for (int i = 1; i <= 3; ++i) rig.addBody(link, {0.01 * i, 0.007, -0.78 * i}, turn(i));
  Result result = drop(rig);
  result.measures["hanging"] = result.measures["lowest"] > -2.6 && result.measures["lowest"] < -2.2;
  return result;
}

Result bowls(const Case& run) {
  Rig rig(run);
  Vec center;
  const ShapePointer bowl = makeShape(scenes::makeBowl(1, 0.05, 48, 12), {}, &center);
  rig.addStatic(groundShape(20, 1, 20), {0, 0, 0});
  for (int i = 0; i < 3; ++i) {
    const Rotation turn = about(Vec(1, i, 0), 2.0 * i);
    rig.addBody(bowl, Vec(0.01 * i, 0, 1.002 + 0.33 * i) + turn * center, turn);
  }
  return drop(rig);
}

Result gears(const Case& run) {
  Rig rig(run);
  const ShapePointer gear = makeShape(scenes::makeGear(20, 1, 0.2, 0.3, 0.3));
  rig.addStatic(groundShape(20, 1, 20), {0, 0, 0});
  for (int i = 0; i < 3; ++i)
    rig.addBody(gear, {0.1 * i, 0.03 * i, 0.152 + 0.38 * i},
                about(Vec::UnitZ(), 5.0 * i) * about(Vec(1, 2, 0), 1.5 * i));
  return drop(rig, 5);
}

Result lumpsInBowl(const Case& run) {
  Rig rig(run);
  rig.addStatic(makeStaticShape(scenes::makeBowl(2, 0.1, 48, 16)), {0, 0, 2});
  for (int i = 0; i < 5; ++i)
    rig.addBody(makeShape(scenes::makeLump(0.3, 3, 0.25, static_cast<std::uint32_t>(i + 1))),
                {0.75 * std::cos(1.2566 * i), 0.75 * std::sin(1.2566 * i), 0.75 + 0.02 * i});
  return drop(rig);
}

Result figures(const Case& run, const std::function<ShapePointer(std::uint32_t)>& shape) {
  Rig rig(run);
  rig.addStatic(groundShape(20, 1, 20), {0, 0, 0});
  double z = 0;
  ShapePointer below;
  for (std::uint32_t i = 1; i <= 3; ++i) {
    // Each starts 2 cm above where it would touch the one below.
    const ShapePointer figure = shape(i);
    float bottom = 0;
    for (const Vec3f& v : figure->mesh.vertices) bottom = std::min(bottom, v.z);
    z = below ? z + touchingDistance(*below, *figure, Vec::UnitZ()) + 0.02 : 0.02 - double{bottom};
    rig.addBody(figure, {0, 0, z});
    below = figure;
  }
  return drop(rig);
}

Result pile(const Case& run) {
  Rig rig(run);
  rig.addStatic(groundShape(20, 1, 20), {0, 0, 0});
  std::mt19937 random(static_cast<std::uint32_t>(run.randomSeed));
  const auto uniform = [&] { return static_cast<double>(random()) / 4294967296.0 * 2 - 1; };
  for (int i = 0; i < 10; ++i) {
    const ShapePointer figure = limbedShape(static_cast<std::uint32_t>(i % 4 + 1), 3);
    const double x = uniform(), y = uniform(), w = uniform();
    const Rotation turn = Rotation(w, uniform(), x, y).normalized();
    // Two columns so narrow that they fall on each other, layers farther apart than a figure is wide.
    const int layer = i / 2;
    rig.addBody(figure, {0.7 * (i % 2 ? 1 : -1) + 0.02 * x, 0.2 * y, 0.8 + 1.35 * layer}, turn);
  }
  return drop(rig);
}

}  // namespace

std::vector<Scene> dropScenes() {
  std::vector<Scene> scenes{
      dropScene("tori", "Three tori fall on each other from 2 cm", &tori),
      dropScene("chain", "Three links of a chain of tori fall into their links", &chain),
      dropScene("bowls", "Three bowls fall into each other", &bowls),
      dropScene("gears", "Three gears fall on each other, a little tilted", &gears),
      dropScene("lumps_in_bowl", "Five lumps fall into a bowl", &lumpsInBowl),
      dropScene("figures", "Three figures with limbs (5,120 triangles) fall on each other",
                [](const Case& run) { return figures(run, [](std::uint32_t seed) { return limbedShape(seed); }); }),
      dropScene("patched_figures", "The same as meshes whose parts run into each other",
                [](const Case& run) { return figures(run, &patchedShape); }),
  };
  scenes[1].limits.push_back(atLeast("hanging", 1));
  // These tumble down from 2 m and more, where one step is more than 1 % of a body.
  for (Scene& scene : scenes)
    if (scene.name == "lumps_in_bowl" || scene.name == "figures" || scene.name == "patched_figures")
      scene.limits = {atMost("energy_gain", 0.05), atMost("excess_depth", 0.01)};
  Scene ten =
      dropScene("pile10", "Ten figures fall on a heap from up to 6 m: no energy gain, and it comes to rest", &pile);
  ten.limits = {atMost("energy_gain", 0.05), atMost("excess_depth", 0.01), atMost("ke", 0.01), atLeast("lowest", 0.1)};
  ten.steppings = {kQ20};
  ten.seeds = 10;
  ten.axes = kAxisSeed | kAxisOrder | kAxisBuffer;
  ten.quick = false;
  ten.seconds = 200;
  scenes.push_back(ten);
  return scenes;
}

}  // namespace otg::physics
