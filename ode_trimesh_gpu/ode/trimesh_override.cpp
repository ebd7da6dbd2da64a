// SPDX-License-Identifier: BSD-3-Clause
// The C API by which ODE's dTriMesh geoms collide through this library.
#include <ode/ode.h>

#include "ode/class_registration.h"
#include "ode/geom_class.h"
#include "ode/mesh_collider.h"
#include "ode/mesh_side.h"
#include "ode/status.h"
#include "ode/trimesh_cache.h"
#include "ode_trimesh_gpu/override.h"

int dGpuTriMeshOverrideTriMesh(void) {
  return otg::guarded([] {
    if (const int status = otg::checkOde()) return status;
    dSetColliderOverride(dTriMeshClass, dTriMeshClass, &otg::collideMeshMesh);
    return static_cast<int>(dGPUTRIMESH_OK);
  });
}

int dGpuTriMeshOverrideSetParams(const dGpuTriMeshParams* params) {
  return otg::guarded([&] {
    if (const int status = otg::checkParams(params)) return status;
    otg::setTrimeshParams(*params);
    return static_cast<int>(dGPUTRIMESH_OK);
  });
}

int dGpuTriMeshOverrideGetParams(dGpuTriMeshParams* params) {
  return otg::guarded([&] {
    if (!otg::isCurrentSize(params)) return static_cast<int>(dGPUTRIMESH_ERROR_ARGUMENT);
    *params = otg::trimeshParams();
    return static_cast<int>(dGPUTRIMESH_OK);
  });
}

int dGpuTriMeshOverridePrepare(dGeomID g) {
  return otg::guarded([&] {
    if (otg::objectOfTrimesh(g) == nullptr) return static_cast<int>(dGPUTRIMESH_ERROR_CLASS);
    const auto mesh = otg::meshOfTrimesh(g);
    if (mesh == nullptr) return static_cast<int>(dGPUTRIMESH_ERROR_MESH);
    mesh->wide();
    mesh->adjacency();
    return static_cast<int>(dGPUTRIMESH_OK);
  });
}

void dGpuTriMeshOverrideDataChanged(dTriMeshDataID data) {
  otg::trimeshDataChanged(data);
}

void dGpuTriMeshOverrideForgetData(dTriMeshDataID data) {
  otg::forgetTrimeshData(data);
}

void dGpuTriMeshOverrideForgetGeom(dGeomID g) {
  otg::forgetTrimesh(g);
}

void dGpuTriMeshOverrideGetCounts(duint64* builds, duint64* refits, duint64* kept) {
  const otg::TrimeshCacheStats stats = otg::trimeshCacheStats();
  if (builds != nullptr) *builds = stats.builds;
  if (refits != nullptr) *refits = stats.refits;
  if (kept != nullptr) *kept = stats.kept;
}
