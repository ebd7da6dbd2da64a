// SPDX-License-Identifier: BSD-3-Clause
#include "ode/shapes/shape_query.h"

#include "base/same_bits.h"
#include "ode/pairs/pair_query.h"
#include "ode/pairs/pair_task.h"
#include "ode/shapes/primitive_history.h"

namespace otg {

bool sameQuery(const ShapeQuery& x, const ShapeQuery& y) {
  return x.geomClass == y.geomClass && x.stamp == y.stamp && x.remembers == y.remembers && x.shape == y.shape &&
         sameBits(x.pose, y.pose) && sameBits(x.size, y.size) && sameBits(x.velocity, y.velocity) &&
         isSameMesh(x.mesh, y.mesh) && x.options == y.options;
}

ShapeQuery shapeQuery(const PrimitiveTask& task) {
  ShapeQuery query;
  const GeomObject& object = *task.side.object;
  query.geomClass = dGeomGetClass(task.o2);
  switch (query.geomClass) {
    case dSphereClass:
      query.size[0] = static_cast<double>(dGeomSphereGetRadius(task.o2));
      break;
    case dPlaneClass: {
      const PlaneGeom plane = planeInMesh(task);
      query.size = {plane.normal.x, plane.normal.y, plane.normal.z, plane.offset};
      break;
    }
    case dBoxClass: {
      dVector3 sides;
      dGeomBoxGetLengths(task.o2, sides);
      query.size = {static_cast<double>(sides[0]), static_cast<double>(sides[1]), static_cast<double>(sides[2]), 0};
      break;
    }
    case dConvexClass:
      query.shape = task.shape;
      break;
    default: {
      dReal radius, length;
      if (query.geomClass == dCapsuleClass)
        dGeomCapsuleGetParams(task.o2, &radius, &length);
      else
        dGeomCylinderGetParams(task.o2, &radius, &length);
      query.size = {static_cast<double>(radius), static_cast<double>(length), 0, 0};
    }
  }
  if (query.geomClass != dPlaneClass) query.pose = task.other;
  if (query.geomClass != dPlaneClass && query.geomClass != dSphereClass) {
    const dReal* const at = dGeomGetPosition(task.o2);
    query.velocity = relativeVelocity(task, Vec3d{at[0], at[1], at[2]});
  }
  query.options = pairOptions(object.params, object.params);
  query.mesh = task.side.mesh->lifetime();
  query.remembers = object.remembersWith(query.geomClass);
  if (query.remembers) query.stamp = task.side.object->memory.stampOf(memoryKey(task.o2));
  return query;
}

}  // namespace otg
