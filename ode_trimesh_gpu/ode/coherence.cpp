// SPDX-License-Identifier: BSD-3-Clause
// The C API of temporal coherence, by ODE's names.
#include <ode/collision.h>

#include "ode/class_registration.h"
#include "ode/geom_class.h"
#include "ode/mesh_side.h"
#include "ode/status.h"
#include "ode_trimesh_gpu/geom.h"

namespace otg {
namespace {

/// dGPUTRIMESH_OK if there is such a geom and such a class.
int check(const GeomObject* object, int geomClass) {
  if (object == nullptr) return dGPUTRIMESH_ERROR_CLASS;
  return geomClass >= 0 && geomClass < dGeomNumClasses ? dGPUTRIMESH_OK : dGPUTRIMESH_ERROR_ARGUMENT;
}

}  // namespace
}  // namespace otg

int dGeomGpuTriMeshEnableTC(dGeomID g, int geomClass, int enable) {
  otg::GeomObject* const object = otg::liveObjectOf(g);
  if (const int status = otg::check(object, geomClass)) return otg::noteStatus(status);
  if (geomClass == otg::registeredClass()) {
    object->params.history = enable != 0 ? dGPUTRIMESH_HISTORY_ON : dGPUTRIMESH_HISTORY_OFF;
  } else if (enable != 0) {
    object->coherentClasses |= 1u << geomClass;
  } else {
    object->coherentClasses &= ~(1u << geomClass);
  }
  return dGPUTRIMESH_OK;
}

int dGeomGpuTriMeshIsTCEnabled(dGeomID g, int geomClass) {
  const otg::GeomObject* const object = otg::liveObjectOf(g);
  if (const int status = otg::check(object, geomClass)) return otg::noteStatus(status);
  if (geomClass == otg::registeredClass()) return object->params.history == dGPUTRIMESH_HISTORY_ON ? 1 : 0;
  return (object->coherentClasses >> geomClass & 1u) != 0 ? 1 : 0;
}

int dGeomGpuTriMeshClearTCCache(dGeomID g) {
  return otg::guarded([&] {
    const std::shared_ptr<otg::GeomObject> object = otg::settingsOf(g);
    if (object == nullptr) return static_cast<int>(dGPUTRIMESH_ERROR_CLASS);
    object->memory.clear();
    object->clearedAt = otg::PairMemory::now();
    return static_cast<int>(dGPUTRIMESH_OK);
  });
}

dGpuTriMeshDataID dGeomGpuTriMeshGetTriMeshDataID(dGeomID g) {
  return dGeomGpuTriMeshGetData(g);
}
