// SPDX-License-Identifier: BSD-3-Clause
#include "collide/inside_test.h"

#include <limits>

#include "base/vectors.h"
#include "collide/mesh_ray.h"
#include "shared/tests/sos.h"

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

bool pointInMesh(const CollisionMesh& tree, const Vec3d& point) {
  int votes = 0;
  for (int k = 0; k < 3 && votes != 2 && votes != -2; ++k) {
    const Vec3d direction = otgParityDirection<double>(k);
    int balance = 0;
    double limit = std::numeric_limits<double>::infinity();
    forEachRayHit(tree, {point, direction}, limit,
                  [&](std::uint32_t, double, bool leaving) { balance += leaving ? 1 : -1; });
    votes += balance > 0 ? 1 : -1;
  }
  return votes > 0;
}

bool vertexInside(const PlacedMeshes& meshes, int mesh, const Vec3d& vertex) {
  const TriMesh& outer = meshes.mesh(mesh);
  const Vec3f& c = outer.center();
  const Vec3d away = vertex - meshes.fromLocal(mesh, Vec3d{c.x, c.y, c.z});
  const double radius = double{outer.radius()};
  // The segment to a point that is surely outside, as an edge of the vertex's own mesh.
  const Vec3d direction = otgParityDirection<double>(0);
  const Vec3d end = vertex + direction * (4 * (radius + norm(away)));
  // What lies on the surface may be off the boxes by rounding.
  const Vec3d start = vertex - direction * (1e-6 * radius);
  int balance = 0;
  forEachOnRay(meshes.tree(mesh), {meshes.toLocal(mesh, start), meshes.directionToLocal(mesh, direction)},
               [&](std::uint32_t t) {
                 if (outer.isDegenerate(t)) return;
                 Vec3d p[3];
                 for (int k = 0; k < 3; ++k) p[k] = meshes.vertex(mesh, outer.triangles()[t].v[k]);
                 balance += mesh == 1 ? otgSosPassOfA(&vertex.x, &end.x, &p[0].x, &p[1].x, &p[2].x)
                                      : otgSosPassOfB(&vertex.x, &end.x, &p[0].x, &p[1].x, &p[2].x);
               });
  return balance > 0;
}

bool pointInside(const PlacedMeshes& meshes, int mesh, const Vec3d& point) {
  return pointInMesh(meshes.tree(mesh), meshes.toLocal(mesh, point));
}

}  // namespace otg
