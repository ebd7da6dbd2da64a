// SPDX-License-Identifier: BSD-3-Clause
#include "ode/geom/check_params.h"

#include <cmath>
#include <initializer_list>

#include "ode/base/status.h"
#include "ode_trimesh_gpu/library.h"

namespace otg {

int checkParams(const dGpuTriMeshParams* params) noexcept {
  if (!isCurrentSize(params)) return dGPUTRIMESH_ERROR_ARGUMENT;
  const dGpuTriMeshParams& p = *params;
  const auto within = [](int value, int low, int high) { return value >= low && value <= high; };
  bool good = within(p.traversal, dGPUTRIMESH_TRAVERSAL_STANDARD, dGPUTRIMESH_TRAVERSAL_LEVELS) &&
              within(p.descent, dGPUTRIMESH_DESCENT_FIRST_TREE, dGPUTRIMESH_DESCENT_BOTH) &&
              (p.box_axes == 6 || p.box_axes == 15) &&
              within(p.contact_model, dGPUTRIMESH_CONTACTS_AUTO, dGPUTRIMESH_CONTACTS_SOLID) &&
              within(p.reduction, dGPUTRIMESH_REDUCTION_NONE, dGPUTRIMESH_REDUCTION_CONE) &&
              within(p.max_contacts, 1, 65535) && within(p.contacts_per_region, 1, 64) && p.max_pairs >= 1 &&
              within(p.history, dGPUTRIMESH_HISTORY_OFF, dGPUTRIMESH_HISTORY_ON) && p.region_merge >= 0 &&
              std::isfinite(p.region_merge);
  for (const int place : {p.backend, p.middle_phase, p.near_phase}) {
    good = good && within(place, dGPUTRIMESH_BACKEND_DEFAULT, dGPUTRIMESH_BACKEND_OPENCL);
  }
  for (const int bins : p.bins) good = good && within(bins, 1, 64);
  if (!good) return dGPUTRIMESH_ERROR_ARGUMENT;
  return dGPUTRIMESH_OK;
}

}  // namespace otg
