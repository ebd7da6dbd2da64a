// SPDX-License-Identifier: BSD-3-Clause
// A world of mesh bodies that fall on a ground and on each other, stepped through a space and a near callback.
#pragma once

#include <functional>
#include <vector>

#include "support/ode_world.h"

namespace otg::test {

/// The same bodies in the same places whenever it is made with the same choices. An OdeSession must exist.
class PileWorld {
 public:
  struct Choices {
    int spaceClass = dHashSpaceClass;
    int bodies = 12;
    int places = 24;      ///< of each pair
    bool nested = false;  ///< every other body in a space of its own, inside the first
    bool pairwise = false;
    bool history = true;
    bool asArray = false;     ///< dGpuTriMeshCollideSpace() in place of a near callback
    bool withShapes = false;  ///< a box, a ball and a plane of ODE's, too
    unsigned seed = 1;
  };
  explicit PileWorld(const Choices& choices);
  ~PileWorld();
  PileWorld(const PileWorld&) = delete;
  PileWorld& operator=(const PileWorld&) = delete;

  /// Calls `before`, collides the space, steps the world.
  void step(int count, const std::function<void()>& before = {});
  /// Positions, rotations and velocities of all bodies, and what the geoms remember: everything that a step depends on.
  std::vector<unsigned char> bytes() const;
  /// Sums over all geoms.
  dGpuTriMeshStats stats() const;
  dSpaceID space() const { return space_; }
  const std::vector<dGeomID>& geoms() const { return geoms_; }
  int contacts() const { return contacts_; }      ///< made so far
  int collisions() const { return collisions_; }  ///< calls of the near callback for two geoms so far

 private:
  static void near(void* self, dGeomID o1, dGeomID o2);
  void collideAsArray();
  void addShapes();
  Choices choices_;
  dWorldID world_;
  dSpaceID space_, inner_ = nullptr;
  dJointGroupID joints_;
  std::vector<Data*> data_;
  std::vector<dGeomID> geoms_;
  int contacts_ = 0, collisions_ = 0;
};

}  // namespace otg::test
