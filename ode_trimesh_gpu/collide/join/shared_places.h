// SPDX-License-Identifier: BSD-3-Clause
// Which vertices of placed meshes lie at one place.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "bvh/collision_mesh.h"

namespace otg {

struct JoinPart {
  const CollisionMesh* mesh;
  Transformd pose;  ///< to the frame that all parts have in common
};

struct SharedPlaces {
  std::vector<std::vector<std::uint32_t>> numbers;  ///< by part and vertex
  std::vector<Vec3d> places;                        ///< by number; of the first vertex that lies there
  double reach = 0;                                 ///< what is so near counts as one place
};

/// Vertices that the mesh has welded get one number, and those of other parts at the same place to rounding.
SharedPlaces sharedPlaces(std::span<const JoinPart> parts);

}  // namespace otg
