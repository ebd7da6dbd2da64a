// SPDX-License-Identifier: BSD-3-Clause
// Bodies of one size as geoms of all classes.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "scenes/convex_geom.h"
#include "support/ode_world.h"

namespace otg::test {

struct Body {
  std::string name;
  std::function<dGeomID(dSpaceID)> make;
};

/// 0.4 by 0.3 by twice `half` or within that, with the data that geoms point to. `round`: a capsule's radius.
class Bodies {
 public:
  Bodies(double half, double round) : half_(half), round_(round) {}
  std::vector<Body> all() const {
    return {{"ball", [this](dSpaceID space) { return dCreateSphere(space, half_); }},
            {"capsule", [this](dSpaceID space) { return dCreateCapsule(space, round_, 2 * (half_ - round_)); }},
            {"box", [this](dSpaceID space) { return dCreateBox(space, 0.4, 0.3, 2 * half_); }},
            {"cylinder", [this](dSpaceID space) { return dCreateCylinder(space, 0.2, 2 * half_); }},
            {"convex", [this](dSpaceID space) { return convex_.makeGeom(space); }},
            {"mesh", [this](dSpaceID space) { return dCreateGpuTriMesh(space, mesh_.id); }}};
  }

 private:
  double half_, round_;
  scenes::ConvexData convex_{scenes::makeBox({0.4, 0.3, 2 * half_})};
  Data mesh_{scenes::makeBox({0.4, 0.3, 2 * half_})};
};

}  // namespace otg::test
