// SPDX-License-Identifier: BSD-3-Clause
// Generated meshes that devices are tried and timed with.
#pragma once

#include <memory>
#include <vector>

#include "bvh/collision_mesh.h"

namespace otg {

/// What devices are tried and timed with.
std::shared_ptr<const CollisionMesh> calibrationMesh(const std::vector<Vec3f>& vertices,
                                                     const std::vector<Triangle>& triangles);

/// A bumpy sphere of 8 * steps^2 triangles, a solid: what is timed.
std::shared_ptr<const CollisionMesh> calibrationBody(int steps, double phase);

}  // namespace otg
