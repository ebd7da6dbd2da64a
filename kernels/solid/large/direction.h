// SPDX-License-Identifier: BSD-3-Clause
// The directions out of one region that are compared, and which is best: as collide/solid/escape.cpp.
#ifndef OTG_OVERLAP_DIRECTION_H
#define OTG_OVERLAP_DIRECTION_H
#include "solid/large/found.h"

OTG_INLINED otg_vec3_d otgNumbers(__global const double* x) {
  return otgVec_d(x[0], x[1], x[2]);
}

/// How far the region reaches along direction k, once that is known.
OTG_INLINED double otgKnownExtent(__global const otg_region_work* r, uint k) {
  return otgFromOrder(r->highest[k]) - otgFromOrder(~r->lowest[k]);
}

/// Surfaces that run along each other all around: no side is out.
OTG_INLINED int otgIsThin(const otg_solid_work* w) {
  return !otgIsLump_d(w->thickness, w->diagonal);
}

/// Whether the way out is looked for among many directions: not where the pair is on one already.
OTG_INLINED int otgSeeks(__global const otg_region_work* r, __global const otg_overlap_task* task) {
  const otg_vec3_d known = otgNumbers(task->motion.escape);
  return (r->status & OTG_FOUND_ESCAPING) && !(otgDot_d(known, known) > 0);
}

/// Direction k of an escape; zero if there is none.
OTG_INLINED otg_vec3_d otgEscapeDirection(__global const otg_region_work* r, __global const otg_overlap_task* task,
                                          OTG_PAIR_MESH* mesh, const otg_solid_work* w, uint k) {
  if (k >= OTG_ESCAPE_DIRECTIONS) return otgNumbers(r->turned[k - OTG_ESCAPE_DIRECTIONS]);
  if (k < 26) {
    const uint cell = k < 13 ? k : k + 1;
    return otgUnit_d(otgVec_d((double)(cell / 9) - 1, (double)(cell / 3 % 3) - 1, (double)(cell % 3) - 1));
  }
  if (k == 26) return w->mean;
  if (k == 27) return otgNumbers(task->motion.back);
  const uint axis = (k - 28) / 2;
  __local const double* m = mesh[1].solid.pose.r + axis;
  const otg_vec3_d d = otgVec_d(m[0], m[3], m[6]);
  return (k & 1) ? otgScale_d(d, -1.0) : d;
}

/// The best of the first `count` directions of an escape, OTG_NOT_THERE if there is none. `costs`: a number for each.
/// All lanes call it.
OTG_INLINED uint otgBestEscape(__global const otg_region_work* r, __global const otg_overlap_task* task,
                               OTG_PAIR_MESH* mesh, const otg_solid_work* w, uint count, __local double* costs) {
  const otg_vec3_d back = otgNumbers(task->motion.back), push = otgLoad(r->region.push);
  OTG_SYNC;
  for (uint k = get_local_id(0); k < count; k += OTG_GROUP) {
    const otg_vec3_d d = otgEscapeDirection(r, task, mesh, w, k);
    const double factor = 1 - 0.5 * otgMax_d(otgDot_d(d, back), 0.0);
    // An extent does not distinguish d from -d; the push does, as far as there is one.
    const double extent = otgKnownExtent(r, k) * (otgDot_d(d, push) < 0 ? 1.1 : 1.0);
    const double way = otgIsThin(w) ? extent : otgMax_d(as_double(r->ways[k]), extent);
    costs[k] = otgDot_d(d, d) > 0 ? factor * way : INFINITY;
  }
  OTG_SYNC;
  double least = INFINITY;
  uint best = OTG_NOT_THERE;
  for (uint k = 0; k < count; ++k) {
    const double cost = costs[k];
    if (!(cost < least)) continue;
    least = cost;
    best = k;
  }
  return best;
}
OTG_INLINED otg_vec3_d otgEscapeAlong(__global const otg_region_work* r, __global const otg_overlap_task* task,
                                      OTG_PAIR_MESH* mesh, const otg_solid_work* w, uint best) {
  return best == OTG_NOT_THERE ? otgVec_d(0, 0, 1) : otgEscapeDirection(r, task, mesh, w, best);
}

/// Directions of a deep region: the push, the last one if there is one, the main directions of its faces.
OTG_INLINED int otgHasLast(__global const otg_overlap_task* task) {
  const otg_vec3_d last = otgNumbers(task->motion.deepNormal);
  return otgDot_d(last, last) > 0;
}
OTG_INLINED uint otgDeepDirections(__global const otg_region_work* r, __global const otg_overlap_task* task) {
  return 1 + (otgHasLast(task) ? 1 : 0) + r->mainCount[0] + r->mainCount[1];
}
OTG_INLINED otg_vec3_d otgDeepDirection(__global const otg_region_work* r, __global const otg_overlap_task* task,
                                        const otg_solid_work* w, uint k) {
  if (k == 0) return w->mean;
  if (otgHasLast(task) && --k == 0) return otgNumbers(task->motion.deepNormal);
  --k;
  const uint mesh = k >= r->mainCount[0];
  return otgNumbers(r->mainDirections[mesh][mesh ? k - r->mainCount[0] : k]);
}

/// The best of them: 0 if that is the push. All lanes call it.
OTG_INLINED uint otgBestDeep(__global const otg_region_work* r, __global const otg_overlap_task* task,
                             const otg_solid_work* w, __local double* costs) {
  const uint count = otgDeepDirections(r, task);
  const int hasLast = otgHasLast(task);
  OTG_SYNC;
  for (uint k = get_local_id(0); k < count; k += OTG_GROUP) {
    const double factor = k == 0 ? OTG_SOLID_PUSH_SHARE : k == 1 && hasLast ? OTG_SOLID_LAST_SHARE : 1.0;
    const int isAgainst = otgDot_d(otgDeepDirection(r, task, w, k), w->mean) < OTG_SOLID_DEEP_AGAINST;
    costs[k] = k > 0 && isAgainst ? INFINITY : factor * otgMax_d(as_double(r->ways[k]), otgKnownExtent(r, k));
  }
  OTG_SYNC;
  double least = costs[0];
  uint best = 0;
  for (uint k = 1; k < count; ++k) {
    const double cost = costs[k];
    if (!(cost < least)) continue;
    least = cost;
    best = k;
  }
  return best;
}

#endif  // OTG_OVERLAP_DIRECTION_H
