// SPDX-License-Identifier: BSD-3-Clause
// New units for some places of a mesh whose vertices have moved.

/// `sent`: the places, four in a unit, counted from `begin` on; then `count` units.
__kernel void scatterUnits(__global uint4* meshes, __global const uint4* sent, uint count, uint begin) {
  const uint i = (uint)get_global_id(0);
  if (i >= count) return;
  const uint at = ((__global const uint*)sent)[i];
  meshes[begin + at] = sent[(count + 3) / 4 + i];
}
