// SPDX-License-Identifier: BSD-3-Clause
#include "ode_trimesh_gpu/params.h"

#include <algorithm>
#include <iterator>

#include "collide/pair_limit.h"
#include "collide/solid_options.h"

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
  params->max_pairs = otg::kMostCandidatePairs;
}
