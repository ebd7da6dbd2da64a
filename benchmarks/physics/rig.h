// SPDX-License-Identifier: BSD-3-Clause
// An ODE world for one run of a scene: bodies in the form, at the size and place that the run requests, stepped with a
// record of energies, depths and speeds.
//
// Scenes are written for size 1 at the origin. Everything that goes in and comes out of a Rig is in those units: the
// rig scales lengths, gravity and speeds on the way in and back on the way out, so that thresholds hold at every size.
#pragma once

#include <ode/ode.h>

#include <functional>
#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "physics/case.h"
#include "physics/shape.h"

namespace otg::physics {

/// Results by name. Lengths in m, angles in degrees, energies in J per kg, all for size 1.
using Measures = std::map<std::string, double>;

/// ODE and the geom class, for as long as the object lives. One per process at a time.
class OdeSession {
 public:
  OdeSession();  ///< throws std::runtime_error if the geom class cannot be registered
  ~OdeSession();
  OdeSession(const OdeSession&) = delete;
  OdeSession& operator=(const OdeSession&) = delete;
};

struct RigOptions {
  Vec gravity{0, 0, -9.81};
  double mu = 1;
  double bounce = 0;  ///< coefficient of restitution
  /// Bodies are ODE's own shapes in every form; what stands still is as the form says.
  bool bodiesAreShapes = false;
};

struct Contact {
  Vec position, normal;  ///< size 1, relative to the scene's place; the normal points into the first body
  double depth;
};

class Rig {
 public:
  Rig(const Case& run, const RigOptions& options = {});
  ~Rig();
  Rig(const Rig&) = delete;
  Rig& operator=(const Rig&) = delete;

  /// A body of 1 kg. Add everything before the first step. Returns its number.
  int addBody(ShapePointer shape, const Vec& position, const Rotation& rotation = Rotation::Identity());
  /// A thing that stands still.
  void addStatic(ShapePointer shape, const Vec& position, const Rotation& rotation = Rotation::Identity());
  void setVelocity(int body, const Vec& linear, const Vec& angular = Vec::Zero());
  /// Hangs the body on a hinge through its centre, with a motor that holds `speed` (rad/s) with at most `torque` (N m).
  void addMotor(int body, const Vec& axis, double speed, double torque);

  /// Torque of the body's motor in the last step, N m about its axis.
  double motorTorque(int body) const;

  /// Steps for so long. `each` is called after every step and may return false to end the run early.
  void run(double seconds, const std::function<bool()>& each = {});
  /// Collides once without stepping.
  std::vector<Contact> contactsNow();

  int bodyCount() const { return static_cast<int>(bodies_.size()); }
  double time() const { return time_; }  ///< s
  Vec position(int body) const;
  Rotation rotation(int body) const;
  Vec velocity(int body) const;
  Vec angularVelocity(int body) const;  ///< rad/s
  Vec startPosition(int body) const { return bodies_[body].position; }

  /// Horizontal distance from where the body started.
  double drift(int body) const;
  /// Angle by which the body's own z axis has turned from where it started, degrees.
  double tilt(int body) const;
  double worstDrift() const;
  double worstTilt() const;
  /// Kinetic and potential energy of all bodies, J.
  double energy() const;
  double kineticEnergy() const;

  /// What every scene reports:
  /// `energy_gain` highest energy above the start, J/kg; `energy_rise` highest energy above an earlier low, J/kg;
  /// `ke` mean kinetic energy of the last half second, J; `deepest` deepest reported contact over the size of the
  /// smallest body. `depth_per_5ms` is that times 5 ms / dt, because what a body falls into another in one step is
  /// proportional to the step; `excess_depth` deepest contact beyond what the fastest point of a body (against one as
  /// fast) moves in a step, over the same size; `max_speed` m/s; `settle` largest vertical distance of a body from its
  /// start at the end, m; `finite` 1, or 0 if a number was not finite or faster than 1e4 m/s, which ends the run;
  /// `contacts` mean per step; `step_ms` mean time of a step, of which `collide_ms` for collision.
  Measures measures() const;
  /// Time and energy above the start in J per kg, one sample for each step.
  const std::vector<std::pair<double, double>>& energyHistory() const { return energyHistory_; }
  /// Hash over positions and velocities, all bits: equal for equal states.
  std::uint64_t stateHash() const;

 private:
  struct Item {
    ShapePointer shape;
    Vec position;
    Rotation rotation;
    int body;  ///< -1: stands still
  };
  struct Body {
    dBodyID id;
    Vec position;
    Rotation rotation;
    dMass mass;
    double extent;
  };
  void makeGeoms();
  void makeGeomsOf(const Item& item);
  void place(dGeomID geom, const Item& item, const NativeGeom& native);
  struct ScaledMesh;
  struct Motor {
    dJointID joint;
    dJointFeedback feedback;
  };
  static void nearCallback(void* self, dGeomID a, dGeomID b);
  void collidePair(dGeomID a, dGeomID b);
  bool step();
  /// No point of the body is faster.
  double fastestPoint(int body) const;
  void record();
  Vec toWorld(const Vec& p) const { return place_ + run_.size * p; }

  Case run_;
  RigOptions options_;
  Vec place_;          ///< of the scene in the world, m
  double speedUnit_;   ///< world speed of speed 1 of the scene
  double energyUnit_;  ///< world energy of energy 1 of the scene
  dWorldID world_;
  dSpaceID space_;
  dJointGroupID contactJoints_;
  std::vector<Item> items_;
  std::vector<Body> bodies_;
  std::map<const Shape*, std::unique_ptr<ScaledMesh>> meshes_;
  std::map<int, std::unique_ptr<Motor>> motors_;  ///< by body; ODE keeps pointers to the feedback
  bool built_ = false;

  std::vector<dContact> buffer_;
  std::vector<Contact>* collect_ = nullptr;  ///< instead of making joints
  double time_ = 0;
  long steps_ = 0, contacts_ = 0;
  double stepDepth_ = 0, lastSpeed_ = 0, excess_ = 0;
  double startEnergy_ = 0, lowestEnergy_ = 0, gain_ = 0, rise_ = 0, deepest_ = 0, maxSpeed_ = 0;
  double smallestExtent_ = 1;
  bool finite_ = true;
  double collideMs_ = 0, stepMs_ = 0;
  std::vector<double> kineticHistory_;
  std::vector<std::pair<double, double>> energyHistory_;
};

}  // namespace otg::physics
