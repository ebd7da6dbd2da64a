// SPDX-License-Identifier: BSD-3-Clause
// A scene of the physics suite: what happens in it, and what is demanded of the result.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "physics/rig.h"

namespace otg::physics {

/// A demand on one measure of one run.
struct Limit {
  enum class Kind {
    kAtMost,
    kAtLeast,
    kAtMostTimesNative,  ///< of the native run with the same stepper, time step, place, size and seed
    kAtLeastTimesNative,
    kWithinOfNative,       ///< |value - native's| at most this
    kWithinShareOfNative,  ///< |value / native's - 1| at most this
  };
  const char* measure;
  Kind kind;
  double value;
  /// Only for runs with this stepper.
  std::optional<Stepper> stepper = std::nullopt;
};

struct Result {
  Measures measures;
  std::vector<std::pair<double, double>> energyHistory;  ///< s, J/kg above the start
  std::string error;                                     ///< why there is no result: a crash, a hang, a refused mesh
};

/// What is varied, one at a time, in a full run.
enum Axis : unsigned {
  kAxisTimeStep = 1,  ///< 1/60 s
  kAxisOrder = 2,     ///< both other orders
  kAxisOffset = 4,    ///< 1e5 m
  kAxisSize = 8,      ///< 1e-2 and 1e2
  kAxisBuffer = 16,   ///< 20, 8, 4
  kAxisSeed = 32,     ///< 2 to Scene::seeds, QuickStep only
  kAllAxes = 63,
  kAxisFineStep = 64,  ///< 1/1000 s
};

struct Scene {
  std::string name;
  std::string family;
  std::string what;  ///< one sentence
  std::function<Result(const Case&)> run;
  std::vector<Limit> limits;
  std::vector<Stepping> steppings;  ///< the first one is varied over the axes
  unsigned axes = kAllAxes;
  bool hasNative = true;
  bool quick = true;         ///< part of a quick run
  bool fullGravity = false;  ///< this scene is about a size with the gravity of the world
  double size = 1;           ///< of the plain run
  double dt = 0.005;         ///< of the plain run, s
  int seeds = 5;             ///< along kAxisSeed
  double seconds = 10;       ///< simulated, to order long runs first
  bool realUse = false;      ///< only on request: what users do, with real meshes or for long
  /// Files in the folder of meshes without which the scene is skipped.
  std::vector<std::string> meshFiles = {};
};

/// A demand on several runs together: the largest value of a measure over scenes at most `value` times the smallest.
struct SpreadLimit {
  std::string name;
  std::vector<std::string> scenes;
  const char* measure;
  double share;
};

const std::vector<Scene>& allScenes();
const std::vector<SpreadLimit>& spreadLimits();
const Scene* findScene(const std::string& name);

// The families, one file each.
std::vector<Scene> boxScenes();
std::vector<Scene> slidingScenes();
std::vector<Scene> curvedScenes();
std::vector<Scene> insertionScenes();
std::vector<Scene> overlapScenes();
std::vector<Scene> cornerScenes();
std::vector<Scene> dropScenes();
std::vector<Scene> realUseScenes();

/// Where the mesh files of scenes lie: the value of OTG_MESH_DIR, empty without it.
std::string meshFolder();
/// The first of the scene's files that is not there; empty if none.
std::string missingFile(const Scene& scene);

constexpr Stepping kW{Stepper::kWorld, 20};
constexpr Stepping kQ20{Stepper::kQuick, 20};
constexpr Stepping kQ50{Stepper::kQuick, 50};

inline Limit atMost(const char* measure, double value) {
  return {measure, Limit::Kind::kAtMost, value, std::nullopt};
}
inline Limit atMost(const char* measure, double value, Stepper stepper) {
  return {measure, Limit::Kind::kAtMost, value, stepper};
}
inline Limit atLeast(const char* measure, double value) {
  return {measure, Limit::Kind::kAtLeast, value, std::nullopt};
}
inline Limit ofNative(const char* measure, Limit::Kind kind, double value) {
  return {measure, kind, value, std::nullopt};
}

/// The measures and history of a rig, to which a scene adds its own.
inline Result resultOf(const Rig& rig) {
  return {rig.measures(), rig.energyHistory(), {}};
}

}  // namespace otg::physics
