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
  friend bool operator==(const RayHit&, const RayHit&) = default;
};

/// Which hits count and how many are wanted.
enum class RayMode { kClosest, kAny, kAll };
struct RayCast {
  MeshRay ray;        ///< the direction a unit vector
  double length = 0;  ///< hits farther than this do not count
  RayMode mode = RayMode::kClosest;
  bool cullBack = false;  ///< hits from behind do not count
  /// Called for each hit that would count, with the barycentric coordinates of the second and third corner: false if
  /// the ray passes there. May be empty.
  std::function<bool(std::uint32_t triangle, double u, double v)> filter;
};

/// A ray against single triangles of one mesh.
class TriangleRay {
 public:
  TriangleRay(const TriMesh& mesh, const MeshRay& ray);
  /// Whether the ray hits the triangle, however far. Depends on nothing but the two (otgRayHitsTriangle), so that what
  /// a search finds by it is what every tree's would.
  bool hits(std::uint32_t triangle, RayHit& hit) const;

 private:
  const TriMesh& mesh_;
  const MeshRay ray_;
  Vec3d along_, inverse_;
  double reach_;
};

/// Nearest first; ties by triangle. Where a ray goes through an edge or a corner of a surface, its triangles count as
/// one hit, the one with the smallest number. kAny: one hit, not always the closest one, and another with another tree.
void castRay(const CollisionMesh& mesh, const RayCast& cast, std::vector<RayHit>& hits);

/// The hit for kClosest or kAny; its triangle is kNone if there is none.
RayHit castForOne(const CollisionMesh& mesh, const RayCast& cast);

}  // namespace otg
