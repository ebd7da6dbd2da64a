// SPDX-License-Identifier: BSD-3-Clause
// Which choices of parameters are good.
#pragma once

#include "ode_trimesh_gpu/params.h"

namespace otg {

/// dGPUTRIMESH_OK if these are choices that this version knows.
int checkParams(const dGpuTriMeshParams* params) noexcept;

}  // namespace otg
