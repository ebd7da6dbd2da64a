// SPDX-License-Identifier: BSD-3-Clause
// What the kernels of kernels/meshes/ are given.
#ifndef OTG_SHARED_MESHES_GIVEN_H
#define OTG_SHARED_MESHES_GIVEN_H
#include "shared/layout/given.h"

#ifndef __OPENCL_VERSION__
namespace otg {
#endif

// clang-format off
/// `sent`: the places, four in a unit, counted from `begin` on; then `count` units.
#define OTG_GIVEN_ScatterUnits(X, AND)  \
  X(alias, otg_mesh_unit, meshes) AND   \
  X(aliasRead, otg_mesh_unit, sent) AND \
  X(value, otg_uint, count) AND         \
  X(value, otg_uint, begin)
OTG_STRUCTURE(ScatterUnits, "scatterUnits")
// clang-format on

#ifndef __OPENCL_VERSION__
}  // namespace otg
#endif
#endif  // OTG_SHARED_MESHES_GIVEN_H
