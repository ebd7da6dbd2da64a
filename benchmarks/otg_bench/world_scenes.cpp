// SPDX-License-Identifier: BSD-3-Clause
#include "otg_bench/world_scenes.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

#include "mesh/mass_properties.h"
#include "scenes/generated_meshes.h"

namespace otg::cli {
namespace {

constexpr Transformd kUpright{{1, 0, 0, 0, 1, 0, 0, 0, 1}, {0, 0, 0}};

Transformd at(double x, double y, double z) {
  Transformd pose = kUpright;
  pose.t = {x, y, z};
  return pose;
}

/// Any rotation, from a generator whose numbers are the same everywhere.
Transformd turned(std::mt19937& random, const Vec3d& t) {
  const auto uniform = [&] { return static_cast<double>(random()) / 4294967296.0 * 2 - 1; };
  double q[4], square = 0;
  do {
    square = 0;
    for (double& x : q) {
      x = uniform();
      square += x * x;
    }
  } while (square > 1 || square < 0.01);
  const double scale = 1 / std::sqrt(square), w = q[0] * scale, x = q[1] * scale, y = q[2] * scale, z = q[3] * scale;
  return {
      {1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w), 2 * (x * y + z * w), 1 - 2 * (x * x + z * z),
       2 * (y * z - x * w), 2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)},
      t};
}

WorldShape about(const scenes::MeshArrays& mesh) {
  const auto middle = scenes::build(mesh)->massProperties().centerOfMass;
  return {scenes::transformed(mesh, at(-middle.x(), -middle.y(), -middle.z())), {}};
}

WorldShape box() {
  return {scenes::makeBox({1, 1, 1}), [](dSpaceID space) { return dCreateBox(space, 1, 1, 1); }};
}

WorldScene pyramid() {
  WorldScene scene{"pyramid of 55 boxes", {box()}, {}, {}};
  constexpr int kRows = 10;
  for (int row = 0; row < kRows; ++row) {
    for (int i = 0; i < kRows - row; ++i) {
      scene.bodies.push_back({0, at(1.05 * (i + 0.5 * row), 0, 0.5 + row)});
    }
  }
  return scene;
}

WorldScene stack() {
  WorldScene scene{"stack of ten boxes", {box()}, {}, {}};
  for (int i = 0; i < 10; ++i) scene.bodies.push_back({0, at(0, 0, 0.5 + i)});
  return scene;
}

scenes::MeshArrays hills(int cells, double cell, double height) {
  scenes::MeshArrays out;
  for (int y = 0; y <= cells; ++y) {
    for (int x = 0; x <= cells; ++x) {
      const double px = cell * (x - 0.5 * cells), py = cell * (y - 0.5 * cells);
      const double pz = height * std::sin(0.31 * px) * std::cos(0.23 * py);
      out.vertices.push_back(scenes::toFloat({px, py, pz}));
    }
  }
  const auto n = static_cast<std::uint32_t>(cells) + 1;
  for (std::uint32_t y = 0; y + 1 < n; ++y) {
    for (std::uint32_t x = 0; x + 1 < n; ++x) {
      const std::uint32_t v = n * y + x;
      out.triangles.push_back({{v, v + 1, v + n + 1}});
      out.triangles.push_back({{v, v + n + 1, v + n}});
    }
  }
  return out;
}

/// About 208 triangles each, half of them convex.
WorldScene mixed() {
  WorldScene scene{"300 mixed bodies on a terrain", {}, {}, hills(100, 0.4, 1)};
  scene.shapes = {about(scenes::makeTorus(0.35, 0.15, 13, 8)),     about(scenes::makeCylinder(0.4, 0.7, 52)),
                  about(scenes::makeLump(0.45, 2, 0.5, 3)),        about(scenes::makeBox({0.7, 0.6, 0.5}, 4)),
                  about(scenes::makeGear(9, 0.4, 0.12, 0.2, 0.1)), about(scenes::makeCapsule(0.25, 0.5, 13, 4)),
                  about(scenes::makeBowl(0.45, 0.12, 13, 4)),      about(scenes::makeSphere(0.4, 2))};
  std::mt19937 random(1);
  for (int i = 0; i < 300; ++i) {
    const int layer = i / 100, x = i % 10, y = i / 10 % 10;
    scene.bodies.push_back({static_cast<std::size_t>(i) % scene.shapes.size(),
                            turned(random, {1.1 * (x - 4.5), 1.1 * (y - 4.5), 2.2 + 1.1 * layer})});
  }
  return scene;
}

/// Bodies that sleep stay where they are, to the last bit.
WorldScene atRest(const char* name, bool sleeps) {
  WorldScene scene{name, {}, {}, hills(60, 0.5, 0)};
  scene.shapes = {about(scenes::makeTorus(0.7, 0.3, 72, 72)), about(scenes::makeLump(0.8, 4, 0.5, 3)),
                  about(scenes::makeBolt(0.4, 0.2, 1.5, 48)), about(scenes::makeGear(16, 0.8, 0.2, 0.4, 0.2)),
                  about(scenes::makeBowl(0.8, 0.2, 48, 24))};
  std::mt19937 random(2);
  for (std::size_t i = 0; i < scene.shapes.size(); ++i) {
    scene.bodies.push_back({i, turned(random, {0.4 * static_cast<double>(i % 2), 0.3 * static_cast<double>(i % 3),
                                               1.5 + 1.8 * static_cast<double>(i)})});
  }
  scene.settle = 600;
  scene.sleeps = sleeps;
  return scene;
}

}  // namespace

bool WorldScene::hasNative() const {
  return std::all_of(shapes.begin(), shapes.end(), [](const WorldShape& shape) { return bool(shape.native); });
}

std::vector<WorldScene> worldScenes() {
  return {pyramid(), mixed(), stack(), atRest("five bodies at rest", false), atRest("five bodies asleep", true)};
}

}  // namespace otg::cli
