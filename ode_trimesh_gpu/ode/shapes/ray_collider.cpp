// SPDX-License-Identifier: BSD-3-Clause
#include "ode/shapes/ray_collider.h"

#include "queries/closest_point.h"
#include "queries/ray_cast.h"

namespace otg {

void rayContacts(const PrimitiveTask& task, std::vector<Contact>& out) {
  dVector3 start, direction;
  dGeomRayGet(task.o2, start, direction);
  RayCast cast;
  cast.ray.origin = otgRotateBack(task.pose, otgSub(Vec3d{start[0], start[1], start[2]}, task.pose.t));
  cast.ray.direction = otgRotateBack(task.pose, Vec3d{direction[0], direction[1], direction[2]});
  cast.length = dGeomRayGetLength(task.o2);
  cast.cullBack = dGeomRayGetBackfaceCull(task.o2) != 0;
  if (dGeomRayGetClosestHit(task.o2) == 0) {
    cast.mode = dGeomRayGetFirstContact(task.o2) != 0 ? RayMode::kAny : RayMode::kAll;
  }
  dTriRayCallback* const onHit = task.side.callbacks.ray;
  dTriCallback* const onTriangle = task.side.callbacks.triangle;
  if (onHit != nullptr || onTriangle != nullptr) {  // in ODE's order
    cast.filter = [&task, onHit, onTriangle](std::uint32_t triangle, double u, double v) {
      const auto number = static_cast<int>(task.side.mesh->mesh().callerTriangle(triangle));
      return (onHit == nullptr || onHit(task.o1, task.o2, number, static_cast<dReal>(u), static_cast<dReal>(v)) != 0) &&
             (onTriangle == nullptr || onTriangle(task.o1, task.o2, number) != 0);
    };
  }
  std::vector<RayHit> hits;
  castRay(*task.side.mesh, cast, hits);
  for (const RayHit& hit : hits) {
    const Vec3d face = faceNormal(task.side.mesh->mesh(), hit.triangle);
    // With the ray as the first geom the normal faces its origin; the mesh is the first one here.
    out.push_back({otgAdd(cast.ray.origin, otgScale(cast.ray.direction, hit.distance)),
                   hit.back ? face : otgScale(face, -1.0), hit.distance, hit.triangle, kNone, 0,
                   ContactFeature::kFaceA});
  }
}

}  // namespace otg
