// SPDX-License-Identifier: BSD-3-Clause
#include "ode/shapes/primitive_task.h"

namespace otg {

Transformd poseToRemember(const PrimitiveTask& task) {
  if (dGeomGetClass(task.o2) != dSphereClass) return task.other;
  return {{1, 0, 0, 0, 1, 0, 0, 0, 1}, task.other.t};
}

PlaneGeom planeInMesh(const PrimitiveTask& task) {
  dVector4 p;
  dGeomPlaneGetParams(task.o2, p);
  const Vec3d n{p[0], p[1], p[2]};
  return {otgRotateBack(task.pose, n), static_cast<double>(p[3]) - otgDot(n, task.pose.t)};
}

}  // namespace otg
