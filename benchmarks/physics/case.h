// SPDX-License-Identifier: BSD-3-Clause
// One run of one scene of the physics suite: everything that a run depends on, as data.
#pragma once

#include <optional>
#include <string>

namespace otg::physics {

/// As what the bodies collide.
enum class Form {
  kNative,  ///< ODE's own primitives, where the scene has them
  kStock,   ///< ODE's dTriMesh
  kOurs,    ///< dCreateGpuTriMesh
};

/// The contact model requested; only read when the form is kOurs.
enum class Model { kAuto, kPairwise, kSolid };

enum class Stepper { kWorld, kQuick };

/// In which order the two geoms of a pair reach the library. Results must not depend on it.
enum class Order {
  kAsMade,    ///< as dSpaceCollide hands them over
  kSwapped,   ///< dCollide is called with the two exchanged
  kReversed,  ///< the geoms are created in reverse, which changes the frame that the library computes in
};

struct Stepping {
  Stepper stepper = Stepper::kWorld;
  int iterations = 20;  ///< of QuickStep
};

struct Case {
  std::string scene;
  Form form = Form::kOurs;
  Model model = Model::kAuto;
  Stepping stepping;
  double dt = 0.005;  ///< s
  Order order = Order::kAsMade;
  double offset = 0;             ///< distance of the scene from the world's origin, m
  double size = 1;               ///< all lengths times this
  bool fullGravity = false;      ///< gravity is not scaled with the size: the scene is not similar, but what users have
  int buffer = 64;               ///< contacts that the caller of dCollide has room for
  unsigned long randomSeed = 1;  ///< of ODE's generator, which QuickStep shuffles its rows with
};

const char* nameOf(Form form);
const char* nameOf(Model model);
std::optional<Form> formNamed(const std::string& name);
std::optional<Model> modelNamed(const std::string& name);

/// "W", "Q20".
std::string nameOf(const Stepping& stepping);
/// What differs from a plain run, in a few characters: "Q20 dt=1/60 swapped at=1e5 size=0.01 n=8 seed=3".
std::string describe(const Case& run);
/// The same run with ODE's own primitives and nothing that only concerns meshes: what "against native" refers to.
Case nativeOf(Case run);

/// Whether the library accepts the model (a build may be without `solid`). Queries the library; needs ODE initialised.
bool isAccepted(Model model);

}  // namespace otg::physics
