// SPDX-License-Identifier: BSD-3-Clause
// The suite: which runs there are, running them, and judging them against the limits of their scenes.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "physics/scene.h"

namespace otg::physics {

enum class Extent {
  kPlain,  ///< each stepper once
  kQuick,  ///< the same without the long scenes
  kFull,   ///< the first stepper also along every axis
};

struct SuiteOptions {
  Extent extent = Extent::kQuick;
  Model model = Model::kAuto;
  std::vector<Form> forms{Form::kNative, Form::kOurs};
  bool realUse = false;             ///< the scenes of real use instead of the others, where none are named
  std::vector<std::string> scenes;  ///< names; empty: all
  std::string filter;               ///< part of "family/scene form run"; empty: all
  bool opencl = false;   ///< our geoms collide on the default OpenCL device; a run in which it fails is an error
  int workers = 0;       ///< processes; 0: as many as processors
  double timeout = 300;  ///< s of wall time for one run
};

/// One limit applied to one run.
struct Check {
  Limit limit;
  double value = 0;
  double bound = 0;  ///< the limit in numbers; NaN when the native run it refers to has no result
  bool pass = false;
};

struct Row {
  const Scene* scene;
  Case run;
  Result result;
  std::vector<Check> checks;
  bool pass = false;
  /// ODE's own geoms miss, under the same conditions, every limit that this run misses.
  bool nativeFailsToo = false;
  double wallSeconds = 0;
};

struct SpreadCheck {
  std::string name;
  std::string run;  ///< form and conditions
  double spread;    ///< (largest - smallest) / smallest
  double share;
  bool pass;
};

struct SuiteResult {
  std::vector<Row> rows;  ///< in the order of the scenes
  std::vector<SpreadCheck> spreads;
  double wallSeconds = 0;
  bool pass() const;  ///< no run as kOurs missed a limit that ODE's own geoms meet
};

/// The runs of a scene in one form.
std::vector<Case> runsOf(const Scene& scene, Form form, Model model, Extent extent);
/// Runs a case in this process. Needs an OdeSession.
Result runCase(const Scene& scene, const Case& run);
/// Applies the scene's limits; `native` may be null.
void judge(Row& row, const Row* native);

/// Runs everything in processes of their own.
SuiteResult runSuite(const SuiteOptions& options);

}  // namespace otg::physics
