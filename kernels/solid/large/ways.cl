// SPDX-License-Identifier: BSD-3-Clause
// How long the ways out of regions are, along the directions that come into question; and what the weights of faces say
// of each region. Work-groups of one row (in y) belong to one region. As collide/solid/escape.cpp and
// region_normals.cpp.
//
// OTG_GROUP: size of work-groups, a power of two.
#define OTG_SOLID_POINTS 64
#define OTG_SOLID_FACES 64
#define OTG_SOLID_LARGE 0
#include "solid/large/direction.h"
#include "solid/large/extent.h"
#include "solid/large/rays.h"
//
#include "solid/deep.h"

#define OTG_AHEAD_PLACES 256
#define OTG_EXTENT_PARTS 16      ///< in which an extent is measured, at most
#define OTG_EXTENT_LEAST 4       ///< vertices for each lane that make a part worth while
#define OTG_GROUPS_FOR_PARTS 32  ///< where there are fewer work-groups for a region, each measures whole extents

typedef struct {
  otg_extent_scratch extent;
  otg_ray_scratch rays;
  double reduce[OTG_GROUP], costs[OTG_WAY_DIRECTIONS], sums[8], weighted[3], shareOfB;
  double terms[8][OTG_GROUP];         ///< of the sums
  double ahead[OTG_AHEAD_PLACES][4];  ///< planes, scaled along a direction
  uint isFlat;
} otg_ways_scratch;

/// Sums weights up, in the order of the faces, and applies them. All lanes call it.
OTG_INLINED void otgFinishWeights(__local otg_ways_scratch* s, const otg_solid_work* w, __global otg_region_work* r) {
  const uint lane = get_local_id(0), faces = w->facesOfA + w->facesOfB;
  const int weighs = w->thickness > 0 && w->coherence < OTG_SOLID_FLAT;
  for (uint k = lane; k < 8; k += OTG_GROUP) s->sums[k] = 0;
  // What is added up is read by all lanes; then a lane has each sum.
  for (uint base = 0; base < faces; base += OTG_GROUP) {
    OTG_SYNC;
    if (base + lane < faces) {
      __global const otg_solid_face* face = w->faces + base + lane;
      const double weight = face->meanOffset;
      const uint mesh = base + lane >= w->facesOfA;
      for (uint k = 0; k < 3; ++k) s->terms[3 * mesh + k][lane] = face->weighted[k] * weight;
      s->terms[6 + mesh][lane] = weight * face->weightedArea;
    }
    OTG_SYNC;
    for (uint k = lane; k < 8; k += OTG_GROUP) {
      const uint mesh = k < 6 ? k / 3 : k - 6, end = mesh == 0 ? w->facesOfA : faces;
      const uint first = mesh == 0 ? base : max(base, w->facesOfA), stop = min(base + OTG_GROUP, end);
      double sum = s->sums[k];
      OTG_UNROLLED(8)
      for (uint j = first; j < stop; ++j) sum += s->terms[k][j - base];
      s->sums[k] = sum;
    }
  }
  OTG_SYNC_ALL;
  for (uint k = lane; k < faces; k += OTG_GROUP) {
    __global otg_solid_face* face = w->faces + k;
    otgSetWeighted(w, face, k >= w->facesOfA, otgLoad(face->weighted), face->weightedArea, face->meanOffset);
  }
  if (lane == 0) {
    otgSettleSides(s->sums, w, weighs, s->weighted, &s->shareOfB, &s->isFlat);
    // Other work-groups load the region meanwhile, and do not use these.
    r->region.shareOfB = s->shareOfB;  // unordered
    for (uint k = 0; k < 3; ++k) r->region.weighted[k] = s->weighted[k];  // unordered
    r->region.flags = OTG_REGION_COUNTS | OTG_REGION_GATHERED | (s->isFlat ? OTG_REGION_FLAT : 0);  // unordered
  }
}

/// How far A must go along d until some of the region's points are out, by planes: as WayOutByPlanes. All lanes call
/// it.
OTG_INLINED double otgWayByPlanes(__local otg_ways_scratch* s, const otg_solid_work* w,
                                  __global const otg_solid_face* planes, __global const otg_region_work* r,
                                  otg_vec3_d d, double far) {
  const uint lane = get_local_id(0), every = w->pointCount / OTG_SOLID_DEEP_POINTS, stride = every > 1 ? every : 1;
  double most = 0;
  for (uint base = 0; base < w->pointCount; base += OTG_GROUP * stride) {
    const uint i = base + lane * stride;
    const otg_vec3_d p = otgLoad(w->points[i < w->pointCount ? i : 0].position);
    double exits[2];
    for (uint mesh = 0; mesh < 2; ++mesh) {
      __global const otg_solid_face* list = planes + (mesh == 0 ? 0 : r->pieceCount[0]);
      const uint count = r->deepCount[mesh];
      double least = far;
      for (uint from = 0; from < count; from += OTG_AHEAD_PLACES) {
        const uint here = min(count - from, (uint)OTG_AHEAD_PLACES);
        OTG_SYNC;
        for (uint j = lane; j < here; j += OTG_GROUP) {
          otg_vec3_d n = otgVec_d(0, 0, 0);
          double offset = INFINITY;
          otgIsAhead(list + from + j, mesh, d, &n, &offset);
          s->ahead[j][0] = n.x;
          s->ahead[j][1] = n.y;
          s->ahead[j][2] = n.z;
          s->ahead[j][3] = offset;
        }
        OTG_SYNC;
        OTG_UNROLLED(4)
        for (uint j = 0; j < here; ++j) {
          __local const double* n = s->ahead[j];
          least = otgMin_d(n[3] - otgDot_d(otgVec_d(n[0], n[1], n[2]), p), least);
        }
      }
      exits[mesh] = least;
    }
    if (i < w->pointCount) most = otgMax_d(otgMax_d(exits[0], 0) + otgMax_d(exits[1], 0), most);
  }
  return otgLargestOf(s->reduce, most);
}

/// In how many parts extents of a region are measured.
OTG_INLINED uint otgExtentParts(const otg_found_lists* l) {
  if (get_num_groups(0) < OTG_GROUPS_FOR_PARTS) return 1;
  __global const uint* counts = l->head->counts;
  const uint all = counts[OTG_OVERLAP_CROSSINGS] + counts[OTG_OVERLAP_VERTICES] + 2 * counts[OTG_OVERLAP_CLUSTERS];
  return clamp(all / (OTG_EXTENT_LEAST * OTG_GROUP), 1u, (uint)OTG_EXTENT_PARTS);
}

/// A part of the extent along direction k. All lanes call it.
OTG_INLINED void otgMeasureExtent(__local otg_ways_scratch* s, const otg_found_lists* l, OTG_PAIR_MESH* mesh,
                                  __global otg_region_work* r, uint k, otg_vec3_d d, uint part, uint parts) {
  otgSpanOfPart(&s->extent, l, mesh, d, part, parts);
  if (get_local_id(0) == 0) {
    atom_max(r->highest + k, otgInOrder(s->extent.high[0]));
    atom_max(r->lowest + k, ~otgInOrder(s->extent.low[0]));
  }
  OTG_SYNC;
}

/// A part of the extent along direction k, or one of the lines along which the way is measured. All lanes call it.
OTG_INLINED void otgMeasureEscape(__local otg_ways_scratch* s, __global const float4* meshes, const otg_found_lists* l,
                                  OTG_PAIR_MESH* mesh, const otg_solid_work* w, __global otg_region_work* r, uint k,
                                  uint line, uint parts, otg_vec3_d d) {
  const int isThere = otgDot_d(d, d) > 0;
  if (line < parts) {
    if (isThere) otgMeasureExtent(s, l, mesh, r, k, d, line, parts);
    return;
  }
  const uint origin = line - parts, chosen = min(w->pointCount, (uint)OTG_ESCAPE_ORIGINS - 1);
  if (!isThere || otgIsThin(w) || origin > chosen) return;
  const otg_vec3_d middle = otgScale_d(otgAdd_d(w->lo, otgLoad(w->region->hi)), 0.5);
  otg_vec3_d from = middle;
  if (origin > 0) {
    const otg_vec3_d p = otgLoad(w->points[(uint)((ulong)(origin - 1) * w->pointCount / chosen)].position);
    from = otgAdd_d(p, otgScale_d(otgSub_d(middle, p), OTG_ESCAPE_INWARDS));
  }
  const double far = 4 * (double)(mesh[0].solid.radius + mesh[1].solid.radius);
  double ways[2];
  const int works =
      otgExitDistances(&s->rays, meshes, mesh, otgAdd_d(otgLoad(w->region->origin), from), d, far, 0, ways);
  if (get_local_id(0) != 0) return;
  if (!works) atomic_or(&r->pointFlags, OTG_REGION_BAD);
  atom_max(r->ways + k, as_ulong(otgMax_d(ways[0], 0.0) + otgMax_d(ways[1], 0.0)));
}

__kernel __attribute__((reqd_work_group_size(OTG_GROUP, 1, 1))) void overlapWays(
    __global const otg_overlap_pair* restrict pairs, __global const float4* restrict meshes,
    __global const otg_overlap_task* restrict tasks, __global const uchar* restrict out, __global uchar* arena) {
  __local otg_ways_scratch scratch;
  __local otg_overlap_mesh mesh[2];
  __local int isWorked;
  const uint slot = get_group_id(1);
  __global otg_region_work* r = otgRegionAt(arena, slot);
  if (!otgIsWorked(r, &isWorked)) return;
  const uint place = r->place;
  __global const otg_overlap_task* task = tasks + place / OTG_OVERLAP_REGIONS;
  const otg_solid_work w = otgWorkOf(arena, slot);
  const otg_found_lists l = otgListsFor(out, tasks, place);
  otgMeshesOf(meshes, pairs, place, mesh);
  const int seeks = otgSeeks(r, task), isDeep = (r->status & OTG_FOUND_DEEP) != 0;
  const uint parts = otgExtentParts(&l), lines = parts + (seeks ? OTG_ESCAPE_ORIGINS : 1);
  const uint items = 1 + lines * (seeks ? OTG_ESCAPE_DIRECTIONS : isDeep ? otgDeepDirections(r, task) : 0);
  for (uint item = get_group_id(0); item < items; item += get_num_groups(0)) {
    if (item == 0) {
      otgFinishWeights(&scratch, &w, r);
      OTG_SYNC_ALL;
      continue;
    }
    const uint k = (item - 1) / lines, line = (item - 1) % lines;
    const otg_vec3_d d = seeks ? otgEscapeDirection(r, task, mesh, &w, k) : otgDeepDirection(r, task, &w, k);
    if (seeks) {
      otgMeasureEscape(&scratch, meshes, &l, mesh, &w, r, k, line, parts, d);
    } else if (line < parts) {
      otgMeasureExtent(&scratch, &l, mesh, r, k, d, line, parts);
    } else {
      const double far = (double)(mesh[0].solid.radius + mesh[1].solid.radius);
      const double way = otgWayByPlanes(
          &scratch, &w, (__global const otg_solid_face*)(arena + (size_t)r->deepPlanes * OTG_ARENA_UNIT), r, d, far);
      if (get_local_id(0) == 0) r->ways[k] = as_ulong(way);
    }
    OTG_SYNC;
  }
}

/// Directions around the best of those that were looked at: the time number `turn`.
__kernel __attribute__((reqd_work_group_size(OTG_GROUP, 1, 1))) void overlapTurn(
    __global const otg_overlap_pair* restrict pairs, __global const float4* restrict meshes,
    __global const otg_overlap_task* restrict tasks, __global const uchar* restrict out, __global uchar* arena,
    uint turn) {
  __local otg_ways_scratch scratch;
  __local otg_overlap_mesh mesh[2];
  __local int isWorked;
  const uint slot = get_group_id(1);
  __global otg_region_work* r = otgRegionAt(arena, slot);
  if (!otgIsWorked(r, &isWorked)) return;
  const uint place = r->place;
  __global const otg_overlap_task* task = tasks + place / OTG_OVERLAP_REGIONS;
  const otg_solid_work w = otgWorkOf(arena, slot);
  if (!otgSeeks(r, task) || otgIsThin(&w)) return;
  const otg_found_lists l = otgListsFor(out, tasks, place);
  otgMeshesOf(meshes, pairs, place, mesh);
  const uint first = OTG_ESCAPE_DIRECTIONS + turn * OTG_ESCAPE_SIDES;
  const uint parts = otgExtentParts(&l), lines = parts + OTG_ESCAPE_ORIGINS;
  const uint best = otgBestEscape(r, task, mesh, &w, first, scratch.costs);
  const otg_vec3_d d = otgEscapeAlong(r, task, mesh, &w, best);
  const otg_vec3_d s = otgUnit_d(otgCross_d(d, fabs(d.x) < 0.8 ? otgVec_d(1, 0, 0) : otgVec_d(0, 1, 0)));
  const otg_vec3_d t = otgCross_d(d, s);
  for (uint item = get_group_id(0); item < OTG_ESCAPE_SIDES * lines; item += get_num_groups(0)) {
    const uint side = item / lines, line = item % lines, k = first + side;
    const double step = kEscapeSteps[turn];
    const otg_vec3_d turned = otgUnit_d(
        otgAdd_d(d, otgAdd_d(otgScale_d(s, step * kEscapeCosines[side]), otgScale_d(t, step * kEscapeSines[side]))));
    if (line == 0 && get_local_id(0) == 0) otgStore(r->turned[k - OTG_ESCAPE_DIRECTIONS], turned);
    otgMeasureEscape(&scratch, meshes, &l, mesh, &w, r, k, line, parts, turned);
    OTG_SYNC;
  }
}
