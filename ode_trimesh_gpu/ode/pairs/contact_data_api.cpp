// SPDX-License-Identifier: BSD-3-Clause
// dGpuTriMeshCollideEx: contacts with their features and names.
#include "ode_trimesh_gpu/contact_data.h"

#include <ode/collision.h>

#include "ode/base/status.h"
#include "ode/geom/geom_class.h"
#include "ode/pairs/mesh_collider.h"

int dGpuTriMeshCollideEx(dGeomID o1, dGeomID o2, int flags, dContactGeom* contact, int skip,
                         dGpuTriMeshContactData* data, int data_skip) {
  if (otg::liveObjectOf(o1) == nullptr || otg::liveObjectOf(o2) == nullptr)
    return otg::noteStatus(dGPUTRIMESH_ERROR_CLASS);
  const bool hasPlace = contact != nullptr && (flags & 0xffff) != 0 && skip >= static_cast<int>(sizeof(dContactGeom));
  if (!hasPlace || (data != nullptr && data_skip < static_cast<int>(sizeof(dGpuTriMeshContactData)))) {
    return otg::noteStatus(dGPUTRIMESH_ERROR_ARGUMENT);
  }
  // As dCollide has it: a geom does not touch itself, nor another one of its body.
  if (o1 == o2 || (dGeomGetBody(o1) != nullptr && dGeomGetBody(o1) == dGeomGetBody(o2))) return 0;
  return otg::collideMeshes(o1, o2, flags, {contact, skip, data, data_skip});
}
