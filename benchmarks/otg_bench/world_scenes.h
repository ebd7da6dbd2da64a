// SPDX-License-Identifier: BSD-3-Clause
// The scenes of `otg bench world`.
#pragma once

#include <ode/ode.h>

#include <cstddef>
#include <functional>
#include <string>
#include <vector>

#include "scenes/mesh_arrays.h"

namespace otg::cli {

/// One kind of body, solid. Its centre of mass is its mesh's origin.
struct WorldShape {
  scenes::MeshArrays mesh;
  std::function<dGeomID(dSpaceID)> native;  ///< ODE's own shape; empty: it has none
};

struct WorldBody {
  std::size_t shape;
  Transformd pose;
};

struct WorldScene {
  std::string name;
  std::vector<WorldShape> shapes;
  std::vector<WorldBody> bodies;
  scenes::MeshArrays ground;  ///< empty: the plane z = 0
  double dt = 0.01;
  int settle = 300;     ///< steps before the measured ones
  bool sleeps = false;  ///< ODE disables bodies that are at rest
  /// Whether the scene can be made of ODE's own shapes alone.
  bool hasNative() const;
};

std::vector<WorldScene> worldScenes();

}  // namespace otg::cli
