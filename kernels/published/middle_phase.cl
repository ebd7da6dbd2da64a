// SPDX-License-Identifier: BSD-3-Clause
// The middle phase by the trees of the usual traversal, without the near phase. OTG_GROUP is the size of work-groups, a
// multiple of 8.
#include "walk/pair_walk.h"
//
#include "shared/layout/published_given.h"

/// Both trees by one step: the larger box of each pair of `in` is opened by eight lanes, a child each. Children whose
/// boxes overlap go to `out`; of two leaves, all pairs of their triangles go to `found`, by number. counters: places
/// taken in `out`, places taken in `found`, pairs of boxes tested (two words). Places beyond the end of a list are
/// counted only.
__kernel __attribute__((reqd_work_group_size(OTG_GROUP, 1, 1))) void middleStep(OTG_GIVEN(MiddleStep)) {
  const uint k = get_local_id(0) % 8;
  for (uint item = get_global_id(0) / 8; item < count; item += get_global_size(0) / 8) {
    uint2 nodes = in[item];
    otg_node a = otgLoadNode(meshes, pair.a.nodes, nodes.x), b = otgLoadNode(meshes, pair.b.nodes, nodes.y);
    uint children = 0;
    int state = k == 0 ? 2 : 0;  // two roots that are leaves
    if (a.count > 0 || b.count > 0) {
      state = otgOpen(meshes, &pair, &nodes, k, &children);
      if (k == 0) otgCount(counters + 2, children);
    }
    if (state == 1) {
      const uint slot = atomic_inc(counters);
      if (slot < outCapacity) out[slot] = nodes;
    } else if (state == 2) {
      a = otgLoadNode(meshes, pair.a.nodes, nodes.x);
      b = otgLoadNode(meshes, pair.b.nodes, nodes.y);
      const uint na = (uint)-a.count, nb = (uint)-b.count;
      const uint slot = atomic_add(counters + 1, na * nb);
      for (uint i = 0; i < na * nb; ++i) {
        const uint placeA = pair.a.soup + 3 * ((uint)a.first + i / nb);
        const uint placeB = pair.b.soup + 3 * ((uint)b.first + i % nb);
        if (slot + i < foundCapacity) found[slot + i] = (uint2)(as_uint(meshes[placeA].w), as_uint(meshes[placeB].w));
      }
    }
  }
}
