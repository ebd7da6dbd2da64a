// SPDX-License-Identifier: BSD-3-Clause
#include "ode_trimesh_gpu/params.h"

#include <algorithm>
#include <cmath>
#include <iterator>

#include "collide/solid_options.h"
#include "ode/base/status.h"
#include "ode/geom/check_params.h"
#include "ode/geom/mesh_side.h"
#include "ode_trimesh_gpu/geom.h"

void dGpuTriMeshParamsInit(dGpuTriMeshParams* params) {
  if (params == nullptr) return;
  *params = dGpuTriMeshParams{};
  params->size = sizeof(dGpuTriMeshParams);
  params->traversal = dGPUTRIMESH_TRAVERSAL_WIDE;
  params->descent = dGPUTRIMESH_DESCENT_LARGER;
  params->box_axes = 6;
  params->contact_model = dGPUTRIMESH_CONTACTS_AUTO;
  params->reduction = dGPUTRIMESH_REDUCTION_BINNING;
  std::fill(std::begin(params->bins), std::end(params->bins), 3);
  params->max_contacts = 65535;
  params->contacts_per_region = otg::SolidOptions{}.contactsPerRegion;
  params->history = dGPUTRIMESH_HISTORY_ON;
  params->region_merge = static_cast<dReal>(otg::SolidOptions{}.regionMerge);
}

int dGeomGpuTriMeshSetParams(dGeomID g, const dGpuTriMeshParams* params) {
  return otg::guarded([&] {
    const std::shared_ptr<otg::GeomObject> object = otg::settingsOf(g);
    if (object == nullptr) return static_cast<int>(dGPUTRIMESH_ERROR_CLASS);
    if (const int status = otg::checkParams(params)) return status;
    object->params = *params;
    return static_cast<int>(dGPUTRIMESH_OK);
  });
}

int dGeomGpuTriMeshGetParams(dGeomID g, dGpuTriMeshParams* params) {
  return otg::guarded([&] {
    const std::shared_ptr<otg::GeomObject> object = otg::settingsOf(g);
    if (object == nullptr) return static_cast<int>(dGPUTRIMESH_ERROR_CLASS);
    if (!otg::isCurrentSize(params)) return static_cast<int>(dGPUTRIMESH_ERROR_ARGUMENT);
    *params = object->params;
    return static_cast<int>(dGPUTRIMESH_OK);
  });
}
