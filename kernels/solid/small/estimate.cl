// SPDX-License-Identifier: BSD-3-Clause
// The candidates of all regions: where each is measured, its normal, its estimated depth. As the first half of
// collide/solid/region_contacts.cpp. A work-group does parts of OTG_SOLID_CHUNK candidates of one region; what planes
// say of a candidate takes most of the time of a batch, and depends on nothing but the region. OTG_GROUP: size of
// work-groups, OTG_SOLID_CHUNK at most.
#include "solid/region.h"

/// Where two edges cross each other, seen along the normal, they are deepest, and not in their middles: how far from
/// its middle a stretch passes the one of the other mesh that it passes deepest, and how far it has to go; zeros if it
/// passes none.
OTG_INLINED otg_stretch_pass_d otgPassed(const otg_solid_work* w, __global const otg_solid_point* p, otg_vec3_d normal) {
  const otg_vec3_d at = otgLoad(p->position), along = otgLoad(p->along);
  const otg_vec3_d out = p->mesh == 0 ? normal : otgScale_d(normal, -1.0);
  otg_stretch_pass_d deepest;
  deepest.at = deepest.way = 0;
  for (uint i = 0; i < w->pointCount; ++i) {
    __global const otg_solid_point* q = w->points + i;
    if (q->mesh == p->mesh || q->kind < OTG_POINT_MIDDLE) continue;
    const otg_stretch_pass_d pass =
        otgPassOfStretches_d(otgSub_d(otgLoad(q->position), at), along, p->reach, otgLoad(q->along), q->reach, out);
    if (pass.way > deepest.way) deepest = pass;
  }
  return deepest;
}

/// A candidate's estimate, beside it: whether it is the middle of a stretch that has to be compared with its ends.
OTG_INLINED int otgEstimate(const otg_solid_work* w, __global otg_solid_point* p, int skipFlat) {
  const int kind = (int)p->kind;
  if (skipFlat && p->flat) {
    p->depth = -1;
    return 0;
  }
  otg_vec3_d at = otgLoad(p->position);
  otg_vec3_d probe =
      otgProbe_d(at, otgLoad(p->along), p->reach, otgLoad(p->surfaceNormal), kind, w->diagonal, w->thickness);
  otg_vec3_d normal = otgNormalAt(w, probe);
  if (otgEndsAt_d(otgLoad(p->faceNormal), normal, p->mesh)) {
    p->depth = -1;
    return 0;
  }
  otg_stretch_pass_d pass;
  pass.at = pass.way = 0;
  if (kind >= OTG_POINT_MIDDLE) pass = otgPassed(w, p, normal);
  p->passes = pass.way;
  if (pass.way > 0) {
    const otg_vec3_d by = otgScale_d(otgLoad(p->along), pass.at);
    at = otgAdd_d(at, by);
    probe = otgAdd_d(probe, by);
    normal = otgNormalAt(w, probe);
  }
  const double limit = otgExtentAlong(w, normal);
  double out, back;
  const double depth = otgDepthByPlanes(w, probe, normal, limit, &out, &back);
  otgStore(p->at, at);
  otgStore(p->probe, probe);
  otgStore(p->normal, normal);
  p->limit = limit;
  p->shift = 0.5 * (out - back);
  p->depth = depth;
  p->rank = otgRankOfKind_d(kind, out + back);
  return kind >= OTG_POINT_MIDDLE;
}

/// The depth at an end (-1 or 1) of the stretch of which a point is the middle.
OTG_INLINED double otgDepthAtEnd(const otg_solid_work* w, __global const otg_solid_point* p, double side) {
  const double reach = otgReachOfEnds_d(p->reach, w->diagonal);
  const otg_vec3_d normal = otgLoad(p->normal);
  const otg_vec3_d middle = otgAdd_d(otgLoad(p->probe), otgSub_d(otgLoad(p->position), otgLoad(p->at)));
  const otg_vec3_d at = otgAdd_d(middle, otgScale_d(otgLoad(p->along), side * reach));
  double out, back;
  return otgDepthByPlanes(w, at, normal, p->limit, &out, &back);
}

/// Where a part is an uneven region it begins behind all candidates (OTG_CHUNK_UNEVEN), and none is looked at.
__kernel __attribute__((reqd_work_group_size(OTG_GROUP, 1, 1))) void solidEstimate(
    __global const uint2* restrict chunks, uint chunkRoom, __global const uint* restrict counters,
    __global uchar* arena) {
  __local uchar middles[OTG_SOLID_CHUNK];
  __local double ends[2 * OTG_SOLID_CHUNK];
  __local uint count;
  const uint lane = get_local_id(0), all = min(counters[OTG_COUNT_CHUNKS], chunkRoom);
  for (uint item = get_group_id(0); item < all; item += get_num_groups(0)) {
    const otg_solid_work w = otgGoOnWith(arena, chunks[item].x);
    const uint first = chunks[item].y, end = min(first + OTG_SOLID_CHUNK, w.candidates);
    const int skipFlat = w.isFlat && (w.region->flags & OTG_REGION_CORNERS);
    if (lane == 0) count = 0;
    OTG_SYNC;
    for (uint i = first + lane; i < end; i += OTG_GROUP) {
      if (otgEstimate(&w, otgPointOf(&w, i), skipFlat)) middles[atomic_inc(&count)] = (uchar)(i - first);
    }
    OTG_SYNC_ALL;
    for (uint t = lane; t < 2 * count; t += OTG_GROUP) {
      ends[t] = otgDepthAtEnd(&w, otgPointOf(&w, first + middles[t / 2]), t % 2 == 0 ? -1.0 : 1.0);
    }
    OTG_SYNC;
    // A middle that is hardly deeper than its ends are on average says nothing new: then they hold it.
    for (uint m = lane; m < count; m += OTG_GROUP) {
      __global otg_solid_point* p = otgPointOf(&w, first + middles[m]);
      if (p->depth <= OTG_SOLID_DEEPER_THAN_ENDS * (0.5 * ends[2 * m] + 0.5 * ends[2 * m + 1])) p->depth = -1;
    }
    OTG_SYNC;
  }
}
