// SPDX-License-Identifier: BSD-3-Clause
// Bodies that slide, fall and settle into inner corners: no body may be thrown.
#include <algorithm>
#include <cmath>
#include <random>

#include "physics/scene.h"
#include "scenes/concave_meshes.h"

namespace otg::physics {
namespace {

/// A body is thrown if a step makes it faster than anything was before by this, m/s.
constexpr double kThrown = 0.3;

class Random {
 public:
  explicit Random(unsigned long seed) : engine_(static_cast<std::uint32_t>(seed)) {}
  double uniform(double low, double high) { return low + (high - low) * (engine_() / 4294967296.0); }

 private:
  std::mt19937 engine_;
};

double fastest(const Rig& rig) {
  double most = 0;
  for (int i = 0; i < rig.bodyCount(); ++i) most = std::max(most, rig.velocity(i).norm());
  return most;
}

/// Runs and counts the steps in which a body was thrown.
int countThrows(Rig& rig, double seconds) {
  int throws = 0;
  double before = -1;
  rig.run(seconds, [&] {
    const double now = fastest(rig);
    throws += before >= 0 && now > before + kThrown;
    before = now;
    return true;
  });
  return throws;
}

/// The worst of several runs of one scene, and in how many of them a body was thrown.
struct Members {
  Result result;
  int thrown = 0;

  void add(Rig& rig, double seconds) {
    const bool first = result.measures.empty();
    thrown += countThrows(rig, seconds) > 0;
    for (const auto& [measure, value] : rig.measures()) {
      double& worst = result.measures.emplace(measure, value).first->second;
      worst = measure == "finite" ? std::min(worst, value) : std::max(worst, value);
    }
    if (first) result.energyHistory = rig.energyHistory();
    result.measures["thrown"] = thrown;
  }
};

constexpr double kCorner = 1, kWall = 0.3, kWidth = 0.8;

ShapePointer cornerShape(int levels) {
  const Vec floor(kCorner, kWidth, kWall), wall(kWall, kWidth, kCorner);
  return makeStaticShape(scenes::subdivided(scenes::makeCorner(kCorner, kWall, kWidth), levels),
                         {{NativeGeom::Kind::kBox, floor, floor.cwiseProduct(Vec(0.5, 0, 0.5))},
                          {NativeGeom::Kind::kBox, wall, wall.cwiseProduct(Vec(0.5, 0, 0.5))}});
}

/// Makes a body of the height `height` and the half width `half`, standing.
using MakeBody = std::function<ShapePointer(double half, double height)>;

/// A body on the floor of an L, 1 cm from its wall, pushed there.
Result slideIntoCorner(const Case& run, int members, int levels, bool asShapes, const MakeBody& body) {
  Random random(100 + run.randomSeed);
  Members all;
  const ShapePointer corner = cornerShape(levels);
  for (int i = 0; i < members; ++i) {
    RigOptions options;
    options.bodiesAreShapes = asShapes;
    options.mu = random.uniform(0, 0.8);
    Rig rig(run, options);
    rig.addStatic(corner, {0, 0, 0});
    const double half = random.uniform(0.1, 0.3), height = random.uniform(0.3, 0.7);
    // Aligned exactly now and then; else settled nearly so.
    const double tilt = i % 4 == 0 ? 0 : std::pow(10, random.uniform(-5, -1));
    const Rotation turn = about(Vec(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)), tilt);
    rig.addBody(body(half, height), {kWall + half + 0.01, random.uniform(-0.05, 0.05), kWall + height / 2 + 1e-3},
                turn);
    rig.setVelocity(0, {-random.uniform(0.2, 0.6), 0, 0});
    all.add(rig, 1);
  }
  return all.result;
}

ShapePointer tessellatedBox(double half, double height, int levels) {
  const Vec size(2 * half, 2 * half, height);
  return makeShape(scenes::subdivided(scenes::makeBox({size.x(), size.y(), size.z()}), levels),
                   {{NativeGeom::Kind::kBox, size, Vec::Zero()}});
}

ShapePointer roomShape(double size, double wall, int levels) {
  std::vector<NativeGeom> native;
  for (int side = 0; side < 6; ++side) {
    Vec extent = Vec::Constant(size + 2 * wall), place = Vec::Zero();
    extent[side / 2] = wall;
    place[side / 2] = (side % 2 == 0 ? -1 : 1) * (size + wall) / 2;
    native.push_back({NativeGeom::Kind::kBox, extent, place});
  }
  return makeStaticShape(scenes::subdivided(scenes::makeRoom({size, size, size}, wall), levels), native);
}

ShapePointer standingCylinder(double radius, double height) {
  return makeShape(scenes::makeCylinder(radius, height, 32),
                   {{NativeGeom::Kind::kCylinder, Vec(radius, radius, height), Vec::Zero()}});
}

/// As high as `height` where that is possible; else a ball, almost.
ShapePointer standingCapsule(double radius, double height) {
  const double length = std::max(height - 2 * radius, 0.05 * radius);
  return makeShape(scenes::makeCapsule(radius, length, 32, 8),
                   {{NativeGeom::Kind::kCapsule, Vec(radius, radius, length), Vec::Zero()}});
}

ShapePointer ball(double radius, double) {
  return makeShape(scenes::makeSphere(radius, 3), {{NativeGeom::Kind::kSphere, Vec::Constant(radius), Vec::Zero()}});
}

/// A box 1 cm from three walls of a room, which gravity pulls into their corner.
Result settleInRoom(const Case& run, int members, int levels, bool asShapes) {
  Random random(200 + run.randomSeed);
  Members all;
  const ShapePointer room = roomShape(1, 0.2, levels);
  for (int i = 0; i < members; ++i) {
    RigOptions options;
    options.bodiesAreShapes = asShapes;
    options.mu = random.uniform(0, 0.8);
    options.gravity = -9.81 * Vec(random.uniform(0.3, 1), random.uniform(0.3, 1), random.uniform(0.3, 1)).normalized();
    Rig rig(run, options);
    rig.addStatic(room, {0, 0, 0});
    const double half = random.uniform(0.1, 0.2), height = random.uniform(0.2, 0.5);
    const double tilt = i % 4 == 0 ? 0 : std::pow(10, random.uniform(-5, -1));
    const Rotation turn = about(Vec(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)), tilt);
    rig.addBody(tessellatedBox(half, height, levels), Vec(half, half, height / 2) - Vec::Constant(0.49), turn);
    all.add(rig, 1);
  }
  return all.result;
}

ShapePointer trayShape(const Vec& size, double wall) {
  std::vector<NativeGeom> native{
      {NativeGeom::Kind::kBox, Vec(size.x() + 2 * wall, size.y() + 2 * wall, wall), Vec(0, 0, -wall / 2)}};
  for (int side = 0; side < 4; ++side) {
    Vec extent(size.x() + 2 * wall, size.y() + 2 * wall, size.z()), place(0, 0, size.z() / 2);
    extent[side / 2] = wall;
    place[side / 2] = (side % 2 == 0 ? -1 : 1) * (size[side / 2] + wall) / 2;
    native.push_back({NativeGeom::Kind::kBox, extent, place});
  }
  return makeStaticShape(scenes::makeTray({size.x(), size.y(), size.z()}, wall), native);
}

/// Boxes that fall into a tilted tray and slide into its corner.
Result heapInTray(const Case& run) {
  constexpr int kColumns = 4, kRows = 2, kLayers = 3;
  Random random(300 + run.randomSeed);
  RigOptions options;
  options.mu = 0.4;
  options.gravity = 9.81 * Vec(-0.35, -0.25, -1).normalized();
  Rig rig(run, options);
  rig.addStatic(trayShape({1.6, 1, 0.8}, 0.1), {0, 0, 0});
  for (int i = 0; i < kColumns * kRows * kLayers; ++i) {
    const int column = i % kColumns, row = i / kColumns % kRows, layer = i / (kColumns * kRows);
    const Vec size(random.uniform(0.12, 0.28), random.uniform(0.12, 0.28), random.uniform(0.12, 0.28));
    const Vec place(-0.58 + 0.38 * column, -0.25 + 0.45 * row, 0.2 + 0.35 * layer);
    const double tilt = i % 2 == 0 ? 0 : random.uniform(0, 30);
    rig.addBody(boxShape(size), place,
                about(Vec(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)), tilt));
  }
  Members all;
  all.add(rig, 4);
  return all.result;
}

/// A row of `grooves` grooves of the width `gap`, open above, in one solid: walls and floor `wall` thick, walls as high
/// as `height` above the floor's top at z = 0. The first groove's middle is at x = 0, the next one's `gap` + `wall`
/// further.
ShapePointer groovesShape(int grooves, double gap, double height, double wall, double length, int levels) {
  const double step = gap + wall, left = -gap / 2 - wall, right = (grooves - 1) * step + gap / 2 + wall;
  std::vector<scenes::ProfilePoint> profile{{left, -wall}, {right, -wall}, {right, height}};
  std::vector<NativeGeom> native{
      {NativeGeom::Kind::kBox, Vec(right - left, length, wall), Vec((left + right) / 2, 0, -wall / 2)}};
  for (int i = grooves - 1; i >= 0; --i) {
    const double middle = i * step;
    profile.insert(
        profile.end(),
        {{middle + gap / 2, height}, {middle + gap / 2, 0}, {middle - gap / 2, 0}, {middle - gap / 2, height}});
  }
  profile.emplace_back(left, height);
  for (int i = 0; i <= grooves; ++i) {
    native.push_back(
        {NativeGeom::Kind::kBox, Vec(wall, length, height), Vec(left + wall / 2 + i * step, 0, height / 2)});
  }
  return makeStaticShape(scenes::subdivided(scenes::makeProfile(profile, length), levels), native);
}

/// Boxes that fall into a groove with a clearance of 0.01 to 5 % of their width.
Result fallIntoSlot(const Case& run, int members, int levels, bool asShapes) {
  constexpr double kGap = 0.4;
  Random random(400 + run.randomSeed);
  Members all;
  const ShapePointer slot = groovesShape(1, kGap, 0.5, 0.2, 1.2, levels);
  for (int i = 0; i < members; ++i) {
    RigOptions options;
    options.bodiesAreShapes = asShapes;
    options.mu = random.uniform(0, 0.8);
    options.gravity = -9.81 * Vec(random.uniform(-0.2, 0.2), random.uniform(-0.2, 0.2), 1).normalized();
    Rig rig(run, options);
    rig.addStatic(slot, {0, 0, 0});
    const double clearance = 0.05 * std::pow(10, random.uniform(-2.7, 0)), height = random.uniform(0.2, 0.5);
    const double half = 0.5 * kGap * (1 - clearance);
    // As far as the clearance lets it turn about the groove.
    const double tilt = i % 4 == 0 ? 0 : random.uniform(0, 0.4) * clearance * 180 / 3.14159;
    rig.addBody(tessellatedBox(half, height, levels), {0, random.uniform(-0.1, 0.1), height / 2 + 0.02},
                about(Vec(0, 1, 0), tilt));
    all.add(rig, 1);
  }
  return all.result;
}

/// Boxes that fall between the walls of a bin, each into its own compartment and onto each other.
Result fallIntoBin(const Case& run) {
  constexpr int kCompartments = 4, kLayers = 3;
  constexpr double kGap = 0.4, kWall = 0.1;
  Random random(500 + run.randomSeed);
  RigOptions options;
  options.mu = 0.4;
  Rig rig(run, options);
  rig.addStatic(groovesShape(kCompartments, kGap, 0.6, kWall, 1.2, 0), {0, 0, 0});
  for (int i = 0; i < kCompartments * kLayers; ++i) {
    const Vec size(random.uniform(0.15, 0.33), random.uniform(0.15, 0.4), random.uniform(0.12, 0.25));
    const double tilt = i % 2 == 0 ? 0 : random.uniform(0, 15);
    const int layer = i / kCompartments;
    rig.addBody(boxShape(size), {(i % kCompartments) * (kGap + kWall), 0, 0.2 + 0.4 * layer},
                about(Vec(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)), tilt));
  }
  Members all;
  all.add(rig, 3);
  return all.result;
}

/// Boxes that fall into a groove of 90 degrees, an edge down.
Result fallIntoVBlock(const Case& run, int members) {
  Random random(600 + run.randomSeed);
  Members all;
  const ShapePointer block =
      makeStaticShape(scenes::makeProfile({{-0.8, -0.2}, {0.8, -0.2}, {0.8, 0.8}, {0, 0}, {-0.8, 0.8}}, 1.2), {});
  for (int i = 0; i < members; ++i) {
    RigOptions options;
    options.mu = random.uniform(0, 0.8);
    Rig rig(run, options);
    rig.addStatic(block, {0, 0, 0});
    const double half = random.uniform(0.1, 0.25);
    const double tilt = i % 4 == 0 ? 0 : std::pow(10, random.uniform(-5, 0));
    const Rotation turn =
        about(Vec(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)), tilt) * about(Vec(0, 1, 0), 45);
    rig.addBody(tessellatedBox(half, 2 * half, 0), {0, 0, half * std::sqrt(2) + 0.02}, turn);
    all.add(rig, 1);
  }
  return all.result;
}

Scene cornerScene(const char* name, const char* what, std::function<Result(const Case&)> run) {
  Scene scene;
  scene.name = name;
  scene.family = "corners";
  scene.what = what;
  scene.run = std::move(run);
  scene.limits = {atMost("thrown", 0), atLeast("finite", 1)};
  scene.steppings = {kQ20, kW};
  scene.dt = 1.0 / 240;
  scene.axes = kAllAxes | kAxisFineStep;
  scene.seeds = 3;
  scene.seconds = 20;
  return scene;
}

}  // namespace

std::vector<Scene> cornerScenes() {
  constexpr int kMembers = 20;
  std::vector<Scene> scenes;
  const auto add = [&](const char* name, const char* what, std::function<Result(const Case&)> run) {
    scenes.push_back(cornerScene(name, what, std::move(run)));
  };
  const auto slide = [](int levels) {
    return [levels](const Case& run) {
      return slideIntoCorner(run, kMembers, levels, false,
                             [levels](double half, double height) { return tessellatedBox(half, height, levels); });
    };
  };
  const auto slideShape = [](MakeBody body) {
    return [body = std::move(body)](const Case& run) { return slideIntoCorner(run, kMembers, 0, true, body); };
  };
  const auto room = [](int levels, bool asShapes) {
    return [=](const Case& run) { return settleInRoom(run, kMembers, levels, asShapes); };
  };
  const auto slot = [](int levels, bool asShapes) {
    return [=](const Case& run) { return fallIntoSlot(run, kMembers, levels, asShapes); };
  };
  add("corner", "20 boxes slide 1 cm into the inner corner of an L", slide(0));
  add("corner_fine", "As corner, with every triangle divided into sixteen", slide(2));
  add("corner_cylinder", "20 standing cylinders slide against the wall of an L",
      [](const Case& run) { return slideIntoCorner(run, kMembers, 0, false, standingCylinder); });
  add("corner_room", "20 boxes settle in the corner of a room, the cavity of a mesh", room(0, false));
  add("corner_room_fine", "As corner_room, with every triangle divided into sixteen", room(2, false));
  add("tray", "24 boxes fall into a tilted tray", heapInTray);
  add("slot", "20 boxes fall into a groove with 0.01 to 5 % clearance", slot(0, false));
  add("slot_fine", "As slot, with every triangle divided into sixteen", slot(2, false));
  add("bin", "12 boxes fall into the compartments of a bin", fallIntoBin);
  add("vblock", "20 boxes fall edge down into a groove of 90 degrees",
      [](const Case& run) { return fallIntoVBlock(run, kMembers); });
  scenes.back().hasNative = false;
  const auto box = [](double half, double height) { return tessellatedBox(half, height, 0); };
  add("corner_dbox", "As corner, each body a dBox", slideShape(box));
  add("corner_dcylinder", "As corner, each body a standing dCylinder", slideShape(standingCylinder));
  add("corner_dcapsule", "As corner, each body a dCapsule", slideShape(standingCapsule));
  add("corner_dsphere", "As corner, each body a dSphere", slideShape(ball));
  add("corner_room_dbox", "As corner_room, each body a dBox", room(0, true));
  add("slot_dbox", "As slot, each body a dBox", slot(0, true));
  return scenes;
}

}  // namespace otg::physics
