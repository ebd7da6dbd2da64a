// SPDX-License-Identifier: BSD-3-Clause
// Closed components of pairs that are described: those without a chord may lie wholly inside the other mesh.
//
// OTG_GROUP: size of work-groups, a multiple of OTG_SOLID_SAMPLES.
#include "solid/large/mesh.h"

#define OTG_PARTS_AT_ONCE (OTG_GROUP / OTG_SOLID_SAMPLES)

/// Gives pairs up in which one may: the CPU decides by exact signs (isContained in collide/solid/inside.cpp) of those
/// whose samples, a lane to each, all lie in the other mesh's bounds. Of pairs with a component that is not the only one
/// of a solid.
__kernel __attribute__((reqd_work_group_size(OTG_GROUP, 1, 1))) void overlapContained(
    __global const otg_overlap_pair* restrict pairs, __global const float4* restrict meshes,
    __global otg_overlap_state* restrict states) {
  __local otg_overlap o;
  __local uint beyond[OTG_PARTS_AT_ONCE];
  __global otg_overlap_state* state = states + get_group_id(1);
  const uint lane = get_local_id(0), own = lane / OTG_SOLID_SAMPLES, sample = lane % OTG_SOLID_SAMPLES;
  otgTakePair(&o, meshes, pairs, otgArrays(0, 0, 0, 0, 0, 0, 0, 0));
  // Loops are the same for all lanes.
  for (uint mesh = 0; mesh < 2; ++mesh) {
    OTG_MESH *inner = &o.mesh[mesh].solid, *outer = &o.mesh[1 - mesh].solid;
    const int asks = !(inner->flags & OTG_MESH_SOLID) && (outer->flags & OTG_MESH_CLOSED);
    const uint parts = asks ? as_uint(inner->bounds[OTG_SOLID_PART_COUNT].w) : 0;
    __global const float4* lists = inner->bounds + as_uint(inner->bounds[OTG_SOLID_PARTS_AT].w);
    for (uint base = get_group_id(0) * OTG_PARTS_AT_ONCE; base < parts;
         base += get_num_groups(0) * OTG_PARTS_AT_ONCE) {
      const uint part = min(base + own, parts - 1);
      const int isCrossed = state->crossedParts[mesh][part / 32] >> part % 32 & 1;
      __global const float4* list = lists + OTG_SOLID_SAMPLES * part;
      const uint samples = base + own < parts && !isCrossed ? as_uint(list[0].w) : 0;
      const float4 p = list[min(sample, samples > 0 ? samples - 1 : 0)];
      const otg_vec3_d x = otgInFrame(inner, otgVec_d((double)p.x, (double)p.y, (double)p.z));
      if (sample == 0) beyond[own] = 0;
      barrier(CLK_LOCAL_MEM_FENCE);
      if (sample < samples && !otgInBounds(outer, x)) beyond[own] = 1;
      barrier(CLK_LOCAL_MEM_FENCE);
      if (sample == 0 && samples > 0 && beyond[own] == 0) otgGiveUpOverlap(state, OTG_SOLID_CONTAINED);
      barrier(CLK_LOCAL_MEM_FENCE);
    }
  }
}
