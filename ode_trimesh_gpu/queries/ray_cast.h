// SPDX-License-Identifier: BSD-3-Clause
// Rays against a mesh, in the mesh's frame.
#pragma once

#include <functional>
#include <vector>

#include "collide/mesh_ray.h"

namespace otg {

struct RayHit {
  double distance = 0;  ///< from the origin, in lengths of the direction
  std::uint32_t triangle = kNone;
  bool back = false;  ///< the triangle faces along the ray: hit from behind
};

/// Which hits count and how many are wanted.
enum class RayMode { kClosest, kAny, kAll };
struct RayCast {
  MeshRay ray;        ///< the direction a unit vector
  double length = 0;  ///< hits farther than this do not count
  RayMode mode = RayMode::kClosest;
  bool cullBack = false;  ///< hits from behind do not count
  /// Asked about each hit that would count, with the barycentric coordinates of the second and third corner: false if
  /// the ray passes there. May be empty.
  std::function<bool(std::uint32_t triangle, double u, double v)> filter;
};

/// Nearest first; ties by triangle. Where a ray goes through an edge or a corner of a surface, its triangles count as
/// one hit, the one with the smallest number. kAny: one hit, not always the closest one.
void castRay(const CollisionMesh& mesh, const RayCast& cast, std::vector<RayHit>& hits);

}  // namespace otg
