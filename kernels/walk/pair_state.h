// SPDX-License-Identifier: BSD-3-Clause
// What every query begins with.
#ifndef OTG_PAIR_STATE_H
#define OTG_PAIR_STATE_H
#include "shared/layout/device_layout.h"

/// Empties a pair's state. Bounds are those of nothing.
inline static void otgResetState(__global otg_pair_state* state, uint reduction, const otg_device_mesh* a,
                                 const otg_device_mesh* b) {
  for (int k = 0; k < 3; ++k) {
    state->low[k] = 0xffffffffu;
    state->high[k] = 0;
  }
  state->reduction = reduction;
  state->ringsA = a->rings;
  state->ringsB = b->rings;
  state->intersecting = 0;
  state->contacts = 0;
  state->kept = 0;
  state->roots = 0;
  state->count = 0;
  state->hits = 0;
  state->firstHit = 0;
}

/// The flags that a pair begins with.
inline static uint otgFirstFlags(const otg_device_mesh* a, const otg_device_mesh* b, uint method) {
  return ((a->flags | b->flags) & OTG_MESH_TANGLED) || method == OTG_REDUCE_BY_HOST ? OTG_PAIR_TO_HOST : 0;
}

#endif  // OTG_PAIR_STATE_H
