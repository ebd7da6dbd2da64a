// SPDX-License-Identifier: BSD-3-Clause
// The C API of temporal coherence, by ODE's names.
#include <ode/collision.h>

#include "ode/base/status.h"
#include "ode/geom/geom_class.h"
#include "ode/geom/mesh_side.h"
#include "ode/library/class_registration.h"
#include "ode_trimesh_gpu/geom.h"

namespace otg {
namespace {

/// dGPUTRIMESH_OK if there is such a geom and such a class.
int check(const GeomObject* object, int geomClass) {
  if (object == nullptr) return dGPUTRIMESH_ERROR_CLASS;
  return geomClass >= 0 && geomClass < dGeomNumClasses ? dGPUTRIMESH_OK : dGPUTRIMESH_ERROR_ARGUMENT;
}

}  // namespace

bool GeomObject::remembersWith(int geomClass) const {
  if (params.history != dGPUTRIMESH_HISTORY_ON) return false;
  return geomClass == registeredClass() || (coherentClasses >> geomClass & 1u) != 0;
}

}  // namespace otg

int dGeomGpuTriMeshEnableTC(dGeomID g, int geomClass, int enable) {
  return otg::guarded([&] {
    const std::shared_ptr<otg::GeomObject> object = otg::settingsOf(g);
    if (const int status = otg::check(object.get(), geomClass)) return status;
    if (geomClass == otg::registeredClass()) {
      object->params.history = enable != 0 ? dGPUTRIMESH_HISTORY_ON : dGPUTRIMESH_HISTORY_OFF;
    } else if (enable != 0) {
      object->coherentClasses |= 1u << geomClass;
    } else {
      object->coherentClasses &= ~(1u << geomClass);
    }
    return static_cast<int>(dGPUTRIMESH_OK);
  });
}

int dGeomGpuTriMeshIsTCEnabled(dGeomID g, int geomClass) {
  return otg::guarded([&] {
    const std::shared_ptr<otg::GeomObject> object = otg::settingsOf(g);
    if (const int status = otg::check(object.get(), geomClass)) return status;
    return object->remembersWith(geomClass) ? 1 : 0;
  });
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
