// SPDX-License-Identifier: BSD-3-Clause
// The directed boundary of a clipped triangle: its area as a vector, and its bounds.
#ifndef OTG_OUTLINE_H
#define OTG_OUTLINE_H
#include "solid/mesh.h"

/// Half the sum of p x q over the directed boundary, and bounds.
typedef struct {
  otg_vec3_d corner, sum, lo, hi;
  int any;
} otg_outline;

/// Nothing yet. The corner is any point near by.
OTG_INLINED otg_outline otgOutlineFrom(otg_vec3_d corner) {
  otg_outline outline;
  outline.corner = outline.lo = outline.hi = corner;
  outline.sum = otgVec_d(0, 0, 0);
  outline.any = 0;
  return outline;
}

OTG_INLINED void otgAddToOutline(otg_outline* l, otg_vec3_d p, otg_vec3_d q) {
  if (!l->any) {
    l->lo = p;
    l->hi = p;
  }
  l->any = 1;
  l->sum = otgAdd_d(l->sum, otgCross_d(otgSub_d(p, l->corner), otgSub_d(q, l->corner)));
  l->lo = otgLower(l->lo, otgLower(p, q));
  l->hi = otgHigher(l->hi, otgHigher(p, q));
}

#endif  // OTG_OUTLINE_H
