// SPDX-License-Identifier: BSD-3-Clause
// What the last kernels of an overlap know of its large regions, in local memory.
#ifndef OTG_OVERLAP_GRID_H
#define OTG_OVERLAP_GRID_H
#include "solid/large/mesh.h"

typedef struct {
  uint root;
  uint hasTable;  ///< there is room for its cells
  size_t places;  ///< then: where its own begin in the tables of cells, their lists, and depths
  otg_vec3_d lo, hi, up;
  double pieceScale, pointScale;  ///< cells for one unit of length
  double areaUnits, momentUnits;  ///< units in one
} otg_overlap_region;

typedef struct {
  otg_overlap_region region[OTG_OVERLAP_REGIONS];
  otg_vec3_d origin;
  uint count;
} otg_overlap_regions;

/// All lanes call it. `tableRoom`: tables that there are.
OTG_INLINED void otgLoadRegions(__local otg_overlap_regions* l, __global const otg_overlap_state* state,
                                __global const otg_crossing* crossings, uint tableRoom) {
  const uint lane = get_local_id(0), count = min(state->counts[OTG_OVERLAP_LARGE], (uint)OTG_OVERLAP_REGIONS);
  const otg_vec3_d origin = otgLoad(state->origin), zero = otgVec_d(0, 0, 0);
  if (lane < count) {
    __local otg_overlap_region* r = l->region + lane;
    const uint root = state->roots[lane];
    __global const otg_crossing* c = crossings + root;
    const otg_vec3_d low = otgVec_d(otgFromOrder(c->low[0]), otgFromOrder(c->low[1]), otgFromOrder(c->low[2]));
    const otg_vec3_d high = otgVec_d(otgFromOrder(c->high[0]), otgFromOrder(c->high[1]), otgFromOrder(c->high[2]));
    const otg_vec3_d lo = otgAdd_d(otgSub_d(low, origin), zero), hi = otgAdd_d(otgSub_d(high, origin), zero);
    const double diagonal = otgNorm_d(otgSub_d(hi, lo));
    const int terms = otgTermBits(c->load), area = otgBitsOf(as_double(c->largest));
    r->root = root;
    r->hasTable = c->table < tableRoom;
    r->places = (size_t)c->table * OTG_GRID_KEYS;
    r->lo = lo;
    r->hi = hi;
    r->up = otgLoad(state->up[lane]);
    r->pieceScale = diagonal > 0 ? OTG_PIECE_GRID / diagonal : 0;
    r->pointScale = diagonal > 0 ? OTG_POINT_GRID / diagonal : 0;
    r->areaUnits = otgUnitsInOne(terms, area);
    r->momentUnits = otgUnitsInOne(terms, otgMomentBits(area, lo, hi));
  }
  if (lane == 0) {
    l->count = count;
    l->origin = origin;
  }
  barrier(CLK_LOCAL_MEM_FENCE);
}

/// The number of a root's region; OTG_NOT_THERE if it is a small one.
OTG_INLINED uint otgNumberOf(__local const otg_overlap_regions* l, uint root) {
  for (uint r = 0; r < l->count; ++r) {
    if (l->region[r].root == root) return r;
  }
  return OTG_NOT_THERE;
}

/// Encloses a box of the mesh's own frame; relative to the origin.
OTG_INLINED void otgBoxInA(__local const otg_overlap_mesh* m, otg_vec3_d low, otg_vec3_d high, otg_vec3_d origin,
                           otg_vec3_d* lo, otg_vec3_d* hi) {
  if (!m->solid.isB) {
    *lo = otgSub_d(low, origin);
    *hi = otgSub_d(high, origin);
    return;
  }
  const otg_vec3_d middle = otgSub_d(otgInFrame(&m->solid, otgScale_d(otgAdd_d(low, high), 0.5)), origin);
  const otg_vec3_d halved = otgScale_d(otgSub_d(high, low), 0.5);
  __local const double* r = m->solid.pose.r;
  const otg_vec3_d reach = otgVec_d(fabs(r[0]) * halved.x + fabs(r[1]) * halved.y + fabs(r[2]) * halved.z,
                                    fabs(r[3]) * halved.x + fabs(r[4]) * halved.y + fabs(r[5]) * halved.z,
                                    fabs(r[6]) * halved.x + fabs(r[7]) * halved.y + fabs(r[8]) * halved.z);
  *lo = otgSub_d(middle, reach);
  *hi = otgAdd_d(middle, reach);
}

#endif  // OTG_OVERLAP_GRID_H
