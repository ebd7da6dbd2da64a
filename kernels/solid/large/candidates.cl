// SPDX-License-Identifier: BSD-3-Clause
// All about the candidates of large regions: where each is measured, its normal, its depth by planes and by rays. One
// work-group for a candidate; those of one row (in y) belong to one region. As the first half of
// collide/solid/region_contacts.cpp.
//
// OTG_GROUP: size of work-groups, a power of two.
#include "solid/large/direction.h"
#include "solid/large/extent.h"
#include "solid/large/rays.h"

#define OTG_EXIT_PARTS 8  ///< in which the planes of one mesh are looked at

typedef struct {
  otg_extent_scratch extent;
  otg_ray_scratch rays;
  double costs[OTG_WAY_DIRECTIONS];
  double areas[8][4];                   ///< by mesh, and which of four sums
  double exits[6 * OTG_EXIT_PARTS][2];  ///< by place, mesh and part: through the nearest plane, and of any
  double ways[6];                       ///< by place and mesh
} otg_candidate_scratch;

/// The direction that holds everywhere, or where the surfaces do not say any. `known`: its number, if how far the
/// region reaches along it has been measured, or OTG_NOT_THERE. All lanes call it.
OTG_INLINED otg_vec3_d otgSettleDirection(__local otg_candidate_scratch* s, __global const otg_region_work* r,
                                          __global const otg_overlap_task* task, OTG_PAIR_MESH* mesh, otg_solid_work* w,
                                          uint* known) {
  w->isFixed = 0;
  *known = OTG_NOT_THERE;
  if (r->status & OTG_FOUND_ESCAPING) {
    const uint count = otgIsThin(w) ? OTG_ESCAPE_DIRECTIONS : OTG_WAY_DIRECTIONS;
    const int seeks = otgSeeks(r, task);
    if (seeks) *known = otgBestEscape(r, task, mesh, w, count, s->costs);
    const otg_vec3_d d = seeks ? otgEscapeAlong(r, task, mesh, w, *known) : otgNumbers(task->motion.escape);
    w->isFixed = !otgIsThin(w);
    w->fixed = w->fallback = d;
    return d;
  }
  if (!(r->status & OTG_FOUND_DEEP)) return otgVec_d(0, 0, 0);
  const uint best = otgBestDeep(r, task, w, s->costs);
  w->isFixed = best > 0;
  *known = best;
  w->fixed = otgDeepDirection(r, task, w, best);
  return w->fixed;
}

/// As otgNormalAt, by all lanes.
OTG_INLINED otg_vec3_d otgNormalByLanes(__local otg_candidate_scratch* s, const otg_solid_work* w, otg_vec3_d point) {
  if (w->isFixed) return w->fixed;
  if (w->coherence >= OTG_SOLID_FLAT) return w->mean;
  const double inverse = 1 / (w->radius * w->radius);
  for (uint t = get_local_id(0); t < 8; t += OTG_GROUP) {
    const uint mesh = t / 4, count = otgFaceCount(w, mesh);
    double x = 0, y = 0, z = 0, a = 0;
    OTG_UNROLLED(2)
    for (uint j = t % 4; j < count; j += 4) otgAddArea(otgFace(w, mesh, j), 1, point, inverse, &x, &y, &z, &a);
    s->areas[t][0] = x;
    s->areas[t][1] = y;
    s->areas[t][2] = z;
    s->areas[t][3] = a;
  }
  OTG_SYNC;
  double sums[2][4];
  for (uint mesh = 0; mesh < 2; ++mesh) {
    for (uint k = 0; k < 4; ++k) {
      sums[mesh][k] =
          (s->areas[4 * mesh][k] + s->areas[4 * mesh + 1][k]) + (s->areas[4 * mesh + 2][k] + s->areas[4 * mesh + 3][k]);
    }
  }
  return otgNormalOfAreas(w, otgVec_d(sums[0][0], sums[0][1], sums[0][2]), sums[0][3],
                          otgVec_d(sums[1][0], sums[1][1], sums[1][2]), sums[1][3]);
}

/// Ways out by planes of up to three places: s->ways, of A and of B for each. All lanes call it.
/// `planesOfB`: where B's begin.
OTG_INLINED void otgExitsByLanes(__local otg_candidate_scratch* s, const otg_solid_work* w, uint planesOfB,
                                 const otg_vec3_d* places, uint count, otg_vec3_d normal) {
  const uint lane = get_local_id(0);
  OTG_SYNC;
  for (uint t = lane; t < 2 * OTG_EXIT_PARTS * count; t += OTG_GROUP) {
    const uint part = t % OTG_EXIT_PARTS, mesh = t / OTG_EXIT_PARTS % 2, place = t / OTG_EXIT_PARTS / 2;
    const uint planes = mesh == 0 ? w->planesOfA : w->planesOfB, step = (planes + OTG_EXIT_PARTS - 1) / OTG_EXIT_PARTS;
    const uint first = min(part * step, planes), end = min(first + step, planes);
    const otg_vec3_d from = place == 0 ? places[0] : place == 1 ? places[1] : places[2];
    double convex;
    s->exits[t][0] =
        otgWayOut(w->planes + (mesh == 0 ? 0 : planesOfB) + first, end - first, from,
                  otgScale_d(normal, mesh == 0 ? -1.0 : 1.0), OTG_SOLID_PIECE_SLACK * w->diagonal, 0, &convex);
    s->exits[t][1] = convex;
  }
  OTG_SYNC;
  for (uint t = lane; t < 2 * count; t += OTG_GROUP) {
    double nearest = INFINITY, convex = INFINITY;
    for (uint part = 0; part < OTG_EXIT_PARTS; ++part) {
      nearest = otgMin_d(s->exits[t * OTG_EXIT_PARTS + part][0], nearest);
      convex = otgMin_d(s->exits[t * OTG_EXIT_PARTS + part][1], convex);
    }
    s->ways[t] = isfinite(nearest) ? nearest : convex;
  }
  OTG_SYNC;
}

/// The extent of the points that the region keeps. All lanes call it.
OTG_INLINED double otgExtentOfPoints(__local otg_candidate_scratch* s, const otg_solid_work* w, otg_vec3_d d) {
  double high = -INFINITY, low = INFINITY;
  for (uint i = get_local_id(0); i < w->pointCount; i += OTG_GROUP) {
    otgStretchSpan(otgDot_d(otgLoad(w->points[i].position), d), &high, &low);
  }
  otgSpanOfLanes(&s->extent, high, low);
  const double extent = s->extent.high[0] - s->extent.low[0];
  OTG_SYNC;
  return extent;
}

/// As clampToLimit: the extent is only computed where the kept points do not reach as far.
OTG_INLINED double otgClampTo(double ofPoints, double limit, double* out, double* back) {
  if (*out + *back <= ofPoints) return *out + *back;
  return otgClampWays(limit, out, back);
}

OTG_INLINED void otgLookAtCandidate(__local otg_candidate_scratch* s, __global const float4* meshes,
                                    const otg_found_lists* l, OTG_PAIR_MESH* mesh, const otg_solid_work* w,
                                    __global otg_region_work* r, double extra, uint known, uint number) {
  __global otg_solid_point* p = otgPointOf(w, number);
  const uint lane = get_local_id(0);
  const int kind = (int)p->kind;
  if (w->isFlat && (r->pointFlags & OTG_REGION_CORNERS) && p->flat) {
    if (lane == 0) p->depth = -1;
    return;
  }
  const otg_vec3_d at = otgLoad(p->position), along = otgLoad(p->along);
  otg_vec3_d places[3];
  places[0] = otgProbe_d(at, along, p->reach, otgLoad(p->surfaceNormal), kind, w->diagonal, w->thickness);
  const otg_vec3_d normal = otgNormalByLanes(s, w, places[0]);
  if (otgEndsAt_d(otgLoad(p->faceNormal), normal, p->mesh)) {
    if (lane == 0) p->depth = -1;
    return;
  }
  const double reach = otgReachOfEnds_d(p->reach, w->diagonal);
  const int isMiddle = kind >= OTG_POINT_MIDDLE;
  places[1] = otgAdd_d(places[0], otgScale_d(along, -1.0 * reach));
  places[2] = otgAdd_d(places[0], otgScale_d(along, 1.0 * reach));
  otgExitsByLanes(s, w, r->pieceCount[0], places, isMiddle ? 3 : 1, normal);
  const double ofPoints = otgExtentOfPoints(s, w, normal);
  const double far = 4 * (double)(mesh[0].solid.radius + mesh[1].solid.radius);
  const double skin =
      1e-9 * (double)(mesh[0].solid.radius < mesh[1].solid.radius ? mesh[1].solid.radius : mesh[0].solid.radius);
  double rays[2];
  const int works = otgExitDistances(&s->rays, meshes, mesh, otgAdd_d(places[0], otgLoad(w->region->origin)), normal,
                                     far, skin, rays);
  rays[0] = otgMax_d(rays[0], 0);
  rays[1] = otgMax_d(rays[1], 0);
  int exceeds = !(rays[0] + rays[1] <= ofPoints);
  for (uint k = 0; k < (isMiddle ? 3u : 1u); ++k) exceeds |= !(s->ways[2 * k] + s->ways[2 * k + 1] <= ofPoints);
  double limit = ofPoints;
  if (exceeds && w->isFixed && known != OTG_NOT_THERE) {
    limit = otgKnownExtent(r, known) + extra;
  } else if (exceeds) {
    limit = otgExtentOfRegion(&s->extent, l, mesh, normal) + extra;
  }
  if (lane == 0) {
    double out = s->ways[1], back = s->ways[0], ends = 0;
    double depth = otgClampTo(ofPoints, limit, &out, &back);
    p->shift = 0.5 * (out - back);
    p->rank = otgRankOfKind_d(kind, out + back);
    for (uint k = 1; k < (isMiddle ? 3u : 1u); ++k) {
      out = s->ways[2 * k + 1];
      back = s->ways[2 * k];
      ends += 0.5 * otgClampTo(ofPoints, limit, &out, &back);
    }
    // A middle that is hardly deeper than its ends are on average says nothing new: then they hold it.
    if (isMiddle && depth <= OTG_SOLID_DEEPER_THAN_ENDS * ends) depth = -1;
    otgStore(p->at, at);
    otgStore(p->probe, places[0]);
    otgStore(p->normal, normal);
    p->limit = limit;
    p->depth = depth;
    out = rays[0];
    back = rays[1];
    p->along[0] = otgClampTo(ofPoints, limit, &out, &back);  // unordered, too; see OTG_RAYS_KNOWN
    p->along[1] = 0.5 * (out - back);                        // unordered: all lanes have read it
    if (!works) atomic_or(&r->pointFlags, OTG_REGION_BAD);
  }
}

/// Gives a region up that the CPU describes by single triangles: one that is uneven, or thin and coherent nowhere. All
/// lanes call it.
OTG_INLINED void otgGiveUpUneven(__local otg_candidate_scratch* s, const otg_found_lists* l, OTG_PAIR_MESH* mesh,
                                 const otg_solid_work* w, __global otg_region_work* r) {
  if (l->head->regions[l->region].load > OTG_SOLID_MOST_UNEVEN) return;
  if (w->coherence < OTG_SOLID_COHERENT) {
    const int isLayered = otgIsLayered_d(w->thickness, w->diagonal, w->region->areaA, w->region->areaB);
    if (get_local_id(0) == 0 && isLayered) atomic_or(&r->pointFlags, OTG_REGION_BAD | OTG_REGION_UNEVEN);
    OTG_SYNC;
    return;
  }
  const int roundCorner = l->head->corners >> l->region & 1;
  const double extent = otgExtentOfRegion(&s->extent, l, mesh, w->mean);
  const int isUneven = roundCorner || otgIsUneven_d(extent, w->thickness);
  if (get_local_id(0) == 0 && isUneven) atomic_or(&r->pointFlags, OTG_REGION_BAD | OTG_REGION_UNEVEN);
  OTG_SYNC;
}

/// `turns`: whether overlapTurn went before.
__kernel __attribute__((reqd_work_group_size(OTG_GROUP, 1, 1))) void overlapCandidates(
    __global const otg_overlap_pair* restrict pairs, __global const float4* restrict meshes,
    __global const otg_overlap_task* restrict tasks, __global const uchar* restrict out, __global uchar* arena,
    uint turns) {
  __local otg_candidate_scratch scratch;
  __local otg_overlap_mesh mesh[2];
  __local int isWorked;
  const uint slot = get_group_id(1);
  __global otg_region_work* r = otgRegionAt(arena, slot);
  if (!otgIsWorked(r, &isWorked)) return;
  const uint place = r->place;
  __global const otg_overlap_task* task = tasks + place / OTG_OVERLAP_REGIONS;
  otg_solid_work w = otgWorkOf(arena, slot);
  if (get_group_id(0) >= w.candidates || (!turns && otgSeeks(r, task) && !otgIsThin(&w))) return;
  const otg_found_lists l = otgListsFor(out, tasks, place);
  otgMeshesOf(meshes, pairs, place, mesh);
  uint known;
  const otg_vec3_d direction = otgSettleDirection(&scratch, r, task, mesh, &w, &known);
  if (get_group_id(0) == 0) {
    if (get_local_id(0) == 0) otgStore(r->direction, direction);
    otgGiveUpUneven(&scratch, &l, mesh, &w, r);
  }
  const double extra = r->status & OTG_FOUND_ESCAPING ? task->motion.step : 0;
  for (uint number = get_group_id(0); number < w.candidates; number += get_num_groups(0)) {
    otgLookAtCandidate(&scratch, meshes, &l, mesh, &w, r, extra, known, number);
    OTG_SYNC;
  }
}
