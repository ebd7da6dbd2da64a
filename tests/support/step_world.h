// SPDX-License-Identifier: BSD-3-Clause
// A small ODE world of geoms of any class, stepped with dWorldStep.
#pragma once

#include <ode/ode.h>

#include <vector>

namespace otg::test {

class StepWorld {
 public:
  explicit StepWorld(double mu = 1, double gravity = -9.81) : mu_(mu) {
    world_ = dWorldCreate();
    dWorldSetGravity(world_, 0, 0, gravity);
    dWorldSetERP(world_, 0.2);
    dWorldSetCFM(world_, 1e-5);
    space_ = dSimpleSpaceCreate(nullptr);
    joints_ = dJointGroupCreate(0);
  }
  ~StepWorld() {
    dJointGroupDestroy(joints_);
    dSpaceDestroy(space_);
    dWorldDestroy(world_);
  }
  StepWorld(const StepWorld&) = delete;
  StepWorld& operator=(const StepWorld&) = delete;

  dSpaceID space() const { return space_; }
  void setCfm(double cfm) { dWorldSetCFM(world_, cfm); }
  /// Gives the geom a body of its own with this mass, about the geom's own origin.
  dBodyID addBody(dGeomID geom, const dMass& mass) {
    const dBodyID body = dBodyCreate(world_);
    dBodySetMass(body, &mass);
    dGeomSetBody(geom, body);
    return body;
  }
  void step(int count, double dt = 0.005) {
    for (int i = 0; i < count; ++i) {
      dSpaceCollide(space_, this, &nearCallback);
      dWorldStep(world_, dt);
      dJointGroupEmpty(joints_);
    }
  }
  /// The most contacts that a pair has had.
  int mostContacts() const { return most_; }
  double deepest() const { return deepest_; }

 private:
  static void nearCallback(void* self, dGeomID a, dGeomID b) { static_cast<StepWorld*>(self)->collide(a, b); }
  void collide(dGeomID a, dGeomID b) {
    if (dGeomGetBody(a) == nullptr && dGeomGetBody(b) == nullptr) return;
    dContact contacts[32];
    const int count = dCollide(a, b, 32, &contacts[0].geom, sizeof(dContact));
    most_ = count > most_ ? count : most_;
    for (int i = 0; i < count; ++i) {
      dContact& c = contacts[i];
      deepest_ = c.geom.depth > deepest_ ? c.geom.depth : deepest_;
      c.surface = {};
      c.surface.mode = dContactApprox1;
      c.surface.mu = mu_;
      dJointAttach(dJointCreateContact(world_, joints_, &c), dGeomGetBody(c.geom.g1), dGeomGetBody(c.geom.g2));
    }
  }

  double mu_;
  dWorldID world_;
  dSpaceID space_;
  dJointGroupID joints_;
  int most_ = 0;
  double deepest_ = 0;
};

}  // namespace otg::test
