// SPDX-License-Identifier: BSD-3-Clause
#include "collide/solid/ray.h"

#include <limits>

#include "collide/mesh_ray.h"

namespace otg {

double exitDistance(const PlacedMeshes& meshes, int mesh, const Vec3d& origin, const Vec3d& direction, double limit,
                    double skin, std::uint32_t* triangle) {
  const MeshRay ray{meshes.toLocal(mesh, origin), meshes.directionToLocal(mesh, direction)};
  double nearest = limit;
  bool found = false, leaves = false;
  forEachRayHit(meshes.tree(mesh), ray, nearest, [&](std::uint32_t t, double distance, bool leaving) {
    if (!leaving && distance <= skin) return;
    if (found && distance > nearest) return;
    if (found && distance == nearest && leaves) return;  // an edge that both sides share: leaving wins
    found = true;
    leaves = leaving;
    nearest = distance;
    if (triangle) *triangle = t;
  });
  if (!found) return -1;
  return leaves ? nearest : 0;
}

bool pointInMesh(const CollisionMesh& mesh, const Vec3d& point) {
  // No rational directions: rays along axes run through edges and vertices of real meshes.
  static constexpr Vec3d kDirections[3] = {
      {0.5391643, 0.6713921, 0.5083117}, {-0.7231847, 0.2790419, 0.6317723}, {0.1874319, -0.8310647, 0.5236533}};
  int votes = 0;
  for (const Vec3d& direction : kDirections) {
    int balance = 0;
    double limit = std::numeric_limits<double>::infinity();
    forEachRayHit(mesh, {point, direction}, limit,
                  [&](std::uint32_t, double, bool leaving) { balance += leaving ? 1 : -1; });
    votes += balance > 0 ? 1 : -1;
    if (votes == 2 || votes == -2) break;
  }
  return votes > 0;
}

bool pointInside(const PlacedMeshes& meshes, int mesh, const Vec3d& point) {
  return pointInMesh(meshes.tree(mesh), meshes.toLocal(mesh, point));
}

}  // namespace otg
