// SPDX-License-Identifier: BSD-3-Clause
// An ODE world with meshes. Bodies, geoms and joints are known by their numbers, which count up from 0. Where one is
// removed, those behind it move up.
#pragma once

#include <ode/ode.h>

#include <array>
#include <atomic>
#include <memory>
#include <string>
#include <vector>

#include "contact_arrays.h"
#include "mesh.h"
#include "scenes/heightfield_geom.h"

namespace otg::python {

struct WorldSettings {
  std::array<double, 3> gravity{0, 0, -9.81};
  double erp = 0.2, cfm = 1e-5;
  bool quick = true;
  int iterations = 20;
  double friction = 1, bounce = 0, bounceVelocity = 0.01;
  double surfaceLayer = 0, maxCorrectingVelocity = dInfinity;
  double linearDamping = 0, angularDamping = 0;
  int maxContacts = 64;
  unsigned seed = 0;
};

enum class ShapeKind { kMesh, kBox, kSphere, kCapsule, kCylinder, kPlane, kTerrain };

/// A shape at a place of its body.
struct Part {
  ShapeKind kind = ShapeKind::kBox;
  std::array<double, 4> size{};  ///< sides; radius; radius, length (along z); plane: normal, offset
  std::shared_ptr<Mesh> mesh;
  std::shared_ptr<const scenes::HeightGrid> heights;
  std::array<double, 16> pose{};  ///< body's frame from the shape's, row-major
};

enum class BodyKind { kDynamic, kStatic, kKinematic };

struct BodySettings {
  BodyKind kind = BodyKind::kDynamic;
  std::array<double, 16> pose{};      ///< world from body's frame
  double density = 1000, mass = 0;    ///< mass 0: by the density
  double friction = -1, bounce = -1;  ///< negative: the world's
  dGpuTriMeshParams params{};
};

struct WorldContact {
  dContactGeom geom;
  dGpuTriMeshContactData data;
  int body1 = 0, body2 = 0, geom1 = 0, geom2 = 0;
  double friction = 0, bounce = 0;
  bool used = true;
  dVector3 force{};  ///< of the last solve, on body1, world
};

class World {
 public:
  explicit World(const WorldSettings& settings);
  ~World();
  World(const World&) = delete;
  World& operator=(const World&) = delete;

  int addBody(const BodySettings& settings, const std::vector<Part>& parts);
  int addJoint(const std::string& kind, int bodyA, int bodyB, const std::array<double, 3>& anchor,
               const std::array<double, 3>& axis1, const std::array<double, 3>& axis2);
  /// With its geoms, joints and contacts, and what others remember of them. Returns the numbers of its joints, the
  /// largest first.
  std::vector<int> removeBody(int index);
  void removeJoint(int index);

  /// Finds the contacts of all pairs, in an order that depends on the bodies' numbers alone.
  void collide();
  /// Makes joints of the contacts that are used, and steps.
  void solve(double dt);

  struct Body {
    dBodyID body = nullptr;  ///< null for a static one
    BodyKind kind = BodyKind::kDynamic;
    std::vector<int> geoms;
    std::array<double, 3> center{};  ///< centre of mass in the body's frame
    std::array<double, 16> pose{};   ///< of a static one
    double mass = 0;
    double friction = -1, bounce = -1;
  };
  struct Geom {
    dGeomID geom = nullptr;
    int body = 0;
    bool isMesh = false;
    std::array<double, 16> pose{};  ///< body's frame from the shape's
    std::shared_ptr<Mesh> mesh;
    std::unique_ptr<scenes::HeightfieldData> heights;
  };
  struct Joint {
    dJointID joint = nullptr;
    std::string kind;
    int body1 = 0, body2 = -1;  ///< -1: the world
    dJointFeedback feedback{};
  };

  const Body& body(int index) const;
  Body& body(int index);
  Joint& joint(int index);
  const std::vector<Body>& bodies() const { return bodies_; }
  const std::vector<Geom>& geoms() const { return geoms_; }
  std::vector<std::unique_ptr<Joint>>& joints() { return joints_; }
  std::vector<WorldContact>& contacts() { return contacts_; }
  std::vector<dGeomID> geomIds() const;
  dWorldID id() const { return world_; }
  std::atomic<bool>& busy() { return busy_; }
  /// World from the body's frame.
  std::array<double, 16> poseOf(const Body& body) const;
  void setPose(int index, const double* matrix);
  /// Joules: kinetic, potential.
  std::array<double, 2> energy() const;

  double time = 0;
  long long steps = 0;
  unsigned long randomState = 0;

 private:
  static void nearCallback(void* self, dGeomID a, dGeomID b);
  static int wanted(void* self, dGeomID a, dGeomID b);
  bool mayTouch(dGeomID a, dGeomID b) const;
  void collidePair(dGeomID a, dGeomID b);
  int makeGeom(const Part& part, const BodySettings& settings);
  void setMass(Body& body, const BodySettings& settings, const std::vector<Part>& parts);
  void forgetPairsWith(int firstGeom, int count);
  void eraseJoint(std::size_t index);
  void checkPlaces() const;
  void clear();

  WorldSettings settings_;
  dWorldID world_ = nullptr;
  dSpaceID space_ = nullptr;
  dJointGroupID contactJoints_ = nullptr;
  std::vector<Body> bodies_;
  std::vector<Geom> geoms_;
  std::vector<std::unique_ptr<Joint>> joints_;
  std::vector<WorldContact> contacts_;
  std::vector<std::array<dGeomID, 2>> pairs_;
  std::vector<dContactGeom> found_;
  std::vector<dGpuTriMeshContactData> data_;
  std::atomic<bool> busy_ = false;
};

/// a times b of row-major 4x4 matrices.
std::array<double, 16> product(const std::array<double, 16>& a, const std::array<double, 16>& b);

}  // namespace otg::python
