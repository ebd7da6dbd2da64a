// SPDX-License-Identifier: BSD-3-Clause
// New units for some places of a mesh whose vertices have moved.
#include "shared/layout/meshes_given.h"

/// One lane for each unit.
__kernel void scatterUnits(OTG_GIVEN(ScatterUnits)) {
  const uint i = (uint)get_global_id(0);
  if (i >= count) return;
  __global const uint4* from = (__global const uint4*)sent;
  const uint at = ((__global const uint*)sent)[i];
  ((__global uint4*)meshes)[begin + at] = from[(count + 3) / 4 + i];
}
