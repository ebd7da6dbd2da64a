// SPDX-License-Identifier: BSD-3-Clause
// The C API by which ODE's dTriMesh geoms collide through this library.
#include "ode_trimesh_gpu/override.h"

#include <ode/ode.h>

#include <algorithm>
#include <iterator>

#include "ode/base/status.h"
#include "ode/data/trimesh_cache.h"
#include "ode/geom/check_params.h"
#include "ode/geom/mesh_side.h"
#include "ode/geom/trimesh_pairs.h"
#include "ode/library/class_registration.h"
#include "ode/pairs/mesh_collider.h"
#include "ode/shapes/primitive_collider.h"

namespace otg {
namespace {

template <dColliderFn* collide>
int collideAndCount(dGeomID o1, dGeomID o2, int flags, dContactGeom* contact, int skip) noexcept {
  const int count = collide(o1, o2, flags, contact, skip);
  countTrimesh(static_cast<std::size_t>(count));
  return count;
}

/// ODE's own classes that a dTriMesh has a collider with.
constexpr int kPartners[] = {dTriMeshClass, dSphereClass, dBoxClass,    dCapsuleClass,    dCylinderClass,
                             dPlaneClass,   dRayClass,    dConvexClass, dHeightfieldClass};

void overridePair(int geomClass) {
  dSetColliderOverride(
      dTriMeshClass, geomClass,
      geomClass == dTriMeshClass ? &collideAndCount<&collideMeshMesh> : &collideAndCount<&collideMeshPrimitive>);
  noteTrimeshOverridden(geomClass);
}

}  // namespace

}  // namespace otg

int dGpuTriMeshOverrideTriMesh(void) {
  return dGpuTriMeshOverrideTriMeshWith(dTriMeshClass);
}

int dGpuTriMeshOverrideTriMeshWith(int geomClass) {
  return otg::guarded([&] {
    const bool all = geomClass == dGPUTRIMESH_OVERRIDE_ALL;
    if (!all && std::find(std::begin(otg::kPartners), std::end(otg::kPartners), geomClass) == std::end(otg::kPartners))
      return static_cast<int>(dGPUTRIMESH_ERROR_ARGUMENT);
    if (const int status = otg::checkOde()) return status;
    for (const int partner : otg::kPartners) {
      if (all || partner == geomClass) otg::overridePair(partner);
    }
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
    mesh->prepare();
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

void dGpuTriMeshOverrideStatsInit(dGpuTriMeshOverrideStats* stats) {
  if (stats == nullptr) return;
  *stats = dGpuTriMeshOverrideStats{};
  stats->size = sizeof(dGpuTriMeshOverrideStats);
}

int dGpuTriMeshOverrideGetStats(dGpuTriMeshOverrideStats* stats) {
  if (!otg::isCurrentSize(stats)) return otg::noteStatus(dGPUTRIMESH_ERROR_ARGUMENT);
  const otg::TrimeshCacheStats cache = otg::trimeshCacheStats();
  const otg::TrimeshCounts counts = otg::trimeshCounts();
  stats->queries = counts.queries;
  stats->contacts = counts.contacts;
  stats->builds = cache.builds;
  stats->refits = cache.refits;
  stats->kept = cache.kept;
  return dGPUTRIMESH_OK;
}
