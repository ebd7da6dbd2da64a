// SPDX-License-Identifier: BSD-3-Clause
// An ODE world made from a scene description, stepped with measurements. Used by `otg simulate`, the demo and the
// tests.
#pragma once

#include <ode/ode.h>

#include <array>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "scenes/heightfield_geom.h"
#include "scenes/scene_description.h"

namespace otg::scenes {

/// ODE and the geom class, initialised for as long as the object lives. One per process at a time. Where ODE would
/// abort, the program ends with status 1 and ODE's message on stderr.
class OdeSession {
 public:
  OdeSession();  ///< throws std::runtime_error if the geom class cannot be registered
  ~OdeSession();
  OdeSession(const OdeSession&) = delete;
  OdeSession& operator=(const OdeSession&) = delete;
};

struct BodyState {
  Vec3d position{};                            ///< world, of the shape's own origin
  std::array<double, 4> rotation{1, 0, 0, 0};  ///< quaternion w, x, y, z
  Vec3d centerOfMass{};                        ///< world; of a static body: its position
  Vec3d linearVelocity{};                      ///< of the centre of mass
  Vec3d angularVelocity{};
};

struct StepRecord {
  int contacts = 0;                           ///< contact joints made in this step
  std::uint64_t contactsBeforeReduction = 0;  ///< what the colliders found before reducing (equal for ODE's own ones)
  std::uint64_t intersectingPairs = 0;        ///< pairs of triangles that intersect, of gpu_trimesh geoms
  double collideMs = 0;                       ///< dSpaceCollide with its near callback, and the prefetch
  double stepMs = 0;                          ///< dWorldStep or dWorldQuickStep
};

inline constexpr std::size_t kNoBody = static_cast<std::size_t>(-1);

/// A contact joint of a step, as ODE has it.
struct StepContact {
  Vec3d position{};                      ///< world
  Vec3d normal{};                        ///< world, unit length; points into body a
  double depth = 0;                      ///< penetration depth, metres
  std::size_t a = kNoBody, b = kNoBody;  ///< numbers of the bodies; kNoBody: a plane of the scene
};

struct Energy {
  double kinetic = 0, potential = 0;  ///< joules; potential is 0 at the world's origin
  double total() const { return kinetic + potential; }
};

class Simulation {
 public:
  /// An OdeSession must exist for as long as the simulation does. Throws SceneError if ODE refuses a body, or would
  /// because of where it is (kFarthest).
  explicit Simulation(const SceneDescription& scene);
  ~Simulation();
  Simulation(const Simulation&) = delete;
  Simulation& operator=(const Simulation&) = delete;

  /// Throws SceneError if a body is farther than kFarthest then, or has numbers that are not finite: ODE would end the
  /// program. No step may follow.
  StepRecord step(double dt);
  /// Whether each step calls dGpuTriMeshPrefetch() first.
  void setPrefetch(bool on) { prefetch_ = on; }

  std::size_t bodyCount() const { return bodies_.size(); }
  const BodyDescription& description(std::size_t body) const { return scene_.bodies[body]; }
  const SceneDescription& scene() const { return scene_; }
  BodyState state(std::size_t body) const;
  Energy energy() const;
  /// Of the last step; none before the first.
  const std::vector<StepContact>& contacts() const { return stepContacts_; }
  /// Sum over moving bodies, kg m/s.
  Vec3d linearMomentum() const;

  dWorldID world() const { return world_; }
  dSpaceID space() const { return space_; }
  dGeomID geom(std::size_t body) const { return bodies_[body].geom; }
  dBodyID body(std::size_t index) const { return bodies_[index].body; }

 private:
  struct Body {
    dGeomID geom = nullptr;
    dBodyID body = nullptr;  ///< null for a static body
    dTriMeshDataID odeData = nullptr;
    std::unique_ptr<HeightfieldData> heights;
  };
  struct Destroy;
  static void nearCallback(void* self, dGeomID a, dGeomID b);
  void collidePair(dGeomID a, dGeomID b);
  void addBody(const BodyDescription& description);
  void checkPlaces() const;
  dGeomID makeGeom(const BodyDescription& description, Body& body) const;
  /// Sums over all collisions of gpu_trimesh geoms so far.
  struct Found {
    std::uint64_t contacts = 0, intersectingPairs = 0;
  };
  Found foundSoFar() const;
  void clear();

  SceneDescription scene_;
  dWorldID world_ = nullptr;
  dSpaceID space_ = nullptr;
  dJointGroupID contactJoints_ = nullptr;
  std::vector<Body> bodies_;
  std::vector<dContact> contacts_;  ///< one pair's
  std::vector<StepContact> stepContacts_;
  int steps_ = 0;             ///< done so far
  int contactCount_ = 0;      ///< of the step under way
  int contactsOfOthers_ = 0;  ///< of these, from colliders that count nothing themselves
  bool prefetch_ = false;
  unsigned long randomState_ = 0;  ///< ODE's generator is global: each simulation brings its own state
};

/// The surface of a body for a picture: its mesh, or one made for the primitive.
std::shared_ptr<const TriMesh> surfaceOf(const BodyDescription& body);

/// Mass, centre of mass and inertia of a body in its shape's frame. A mesh that bounds no solid counts as the box
/// around it. Throws SceneError when the numbers make no mass.
void bodyMass(const BodyDescription& body, dMass& mass, Vec3d& center);

}  // namespace otg::scenes
