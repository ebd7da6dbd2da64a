// SPDX-License-Identifier: BSD-3-Clause
// The candidates of an uneven region: what leaves it, and crossings, which determine how far contacts reach. As
// collectUneven in collide/solid/region_contacts.cpp. All lanes call these functions, where nothing else is said.
#ifndef OTG_UNEVEN_CANDIDATES_H
#define OTG_UNEVEN_CANDIDATES_H
#include "solid/uneven/leave.h"

/// Distance of a point from the faces of a mesh that face along a direction, `limit` at most.
OTG_INLINED double otgDistanceToFacing(const otg_uneven* u, uint mesh, otg_vec3_d p, otg_vec3_d direction,
                                       double limit) {
  double nearest = limit;
  for (uint i = otgFirstFace(u, mesh); i < otgEndOfFaces(u, mesh); ++i) {
    __global const otg_uneven_face* f = u->faces + i;
    if (fabs(otgBelowFace(f, p)) >= nearest || otgDot_d(otgLoad(f->normal), direction) < OTG_SOLID_FACING) continue;
    nearest = otgMin_d(otgDistanceOfFace(f, p), nearest);
  }
  return nearest;
}

/// Whether a candidate is there in the end: out of B by `out`, out of A by `back`, no deeper than the surface about it
/// is far. By one lane.
OTG_INLINED void otgSetCandidate(const otg_uneven* u, __global otg_solid_point* c, otg_vec3_d normal, double out,
                                 double back) {
  const otg_vec3_d at = otgLoad(c->at);
  OTG_ROLLED
  for (uint mesh = 0; mesh < 2; ++mesh) {
    const double way = mesh == 0 ? back : out;
    if (!(way > 0)) continue;
    const double distance =
        otgDistanceToFacing(u, mesh, at, otgScale_d(normal, mesh == 0 ? -1.0 : 1.0), otgEnoughToGo_d(way));
    if (mesh == 0) {
      back = otgNeighbourhood_d(way, distance);
    } else {
      out = otgNeighbourhood_d(way, distance);
    }
  }
  const double depth = out + back;
  otgStore(c->normal, normal);
  c->shift = 0.5 * (out - back);
  c->depth = depth > 0 ? depth : -1;
  c->rank = otgRankOfKind_d((int)c->kind, depth);
}

/// The candidate of a part that leaves; `number`: of those of the part. By one lane.
OTG_INLINED void otgMakeLeaving(__local const otg_uneven_scratch* s, const otg_solid_work* w, const otg_uneven* u,
                                uint part, uint number, __global otg_solid_point* c) {
  const uint taken = s->taken[part] == s->count[part] ? number : s->taken[part];
  __global const otg_uneven_way* way = u->ways + s->first[part] + taken;
  const otg_vec3_d at = otgLoad(way->at);
  otg_vec3_d normal = otgLoad(way->normal);
  double depth = otgMin_d(otgExtentAlong(w, normal), way->depth);
  *c = w->points[s->points[part]];
  c->order += number;  // only vertices have several, whose ordinals are 0
  otgStore(c->at, at);
  otgStore(c->probe, at);
  if (way->curved) {
    const otg_vec3_d local_ = otgNormalAt(w, at);
    const double cosine = otgDot_d(local_, normal);
    if (cosine >= OTG_SOLID_ONE_WAY) {
      normal = local_;
      depth /= cosine;
    }
  }
  const int isOfA = c->mesh == 0;
  otgSetCandidate(u, c, normal, isOfA ? depth : 0, isOfA ? 0 : depth);
}

/// The first candidates, part by part: how many, some of which are not there.
OTG_INLINED uint otgMakeLeavings(__local otg_uneven_scratch* s, const otg_solid_work* w, const otg_uneven* u) {
  uint count = 0, total;
  for (uint base = 0; base < s->parts; base += OTG_GROUP) {
    const uint i = base + get_local_id(0);
    const int leaves = i < s->parts && s->count[i] > 0;
    const uint number = leaves ? otgTakenWays(s, i) : 0;
    const uint place = count + otgPlaceAmong(OTG_COUNTS(s), number, &total);
    for (uint k = 0; k < number; ++k) otgMakeLeaving(s, w, u, i, k, u->candidates + place + k);
    count += total;
  }
  OTG_SYNC_ALL;
  return count;
}

/// In which directions the first `count` candidates leave, and how far at most.
OTG_INLINED void otgListDirections(__local otg_uneven_scratch* s, const otg_uneven* u, uint count) {
  uint directions = 0, total;
  for (uint base = 0; base < count; base += OTG_GROUP) {
    const uint i = base + get_local_id(0);
    int isFirst = i < count && u->candidates[i].depth > 0;
    const otg_vec3_d normal = otgLoad(u->candidates[i < count ? i : 0].normal);
    double deepest = 0;
    for (uint j = 0; j < count && isFirst; ++j) {
      __global const otg_solid_point* c = u->candidates + j;
      const int isSame = (c->normal[0] == normal.x) & (c->normal[1] == normal.y) & (c->normal[2] == normal.z);
      if (!isSame || !(c->depth > 0)) continue;
      isFirst = j >= i;
      deepest = otgMax_d(c->depth, deepest);
    }
    const uint place = directions + otgPlaceAmong(OTG_COUNTS(s), isFirst, &total);
    if (isFirst) {
      otgStore(u->directions[place].normal, normal);
      u->directions[place].depth = deepest;
    }
    directions += total;
  }
  if (get_local_id(0) == 0) s->directions = directions;
  OTG_SYNC_ALL;
}

/// The way from a point along a direction through the nearest face of a mesh that faces along it; infinity where none
/// is met sooner than `limit`. By one lane.
OTG_INLINED double otgWayOutOf(const otg_uneven* u, uint mesh, otg_vec3_d from, otg_vec3_d direction, double limit) {
  double nearest = limit;
  for (uint i = otgFirstFace(u, mesh); i < otgEndOfFaces(u, mesh); ++i) {
    __global const otg_uneven_face* f = u->faces + i;
    const double depth = otgBelowFace(f, from), cosine = otgDot_d(otgLoad(f->normal), direction);
    if (!(depth >= -u->behind) || !(cosine > OTG_UNEVEN_LEAST_COSINE)) continue;
    const double way = otgWayThrough_d(depth, cosine);
    if (!(way < nearest)) continue;
    if (otgBesideFace(f, otgAdd_d(from, otgScale_d(direction, way))) <= u->slack) nearest = way;
  }
  return nearest < limit ? nearest : INFINITY;
}

/// The candidate of a crossing: the direction of those of the parts in which both meshes are left soonest. By one lane.
OTG_INLINED void otgMakeCrossing(__local const otg_uneven_scratch* s, const otg_solid_work* w, const otg_uneven* u,
                                 uint point, __global otg_solid_point* c) {
  *c = w->points[point];
  const otg_vec3_d at = otgLoad(c->position), face = otgLoad(c->faceNormal);
  const otg_vec3_d probe =
      otgProbe_d(at, otgLoad(c->along), c->reach, otgLoad(c->surfaceNormal), (int)c->kind, w->diagonal, w->thickness);
  otgStore(c->at, at);
  otgStore(c->probe, probe);
  c->depth = -1;
  double least = INFINITY, bestOut = 0, bestBack = 0;
  otg_vec3_d best = face;
  for (uint k = 0; k < s->directions; ++k) {
    const otg_vec3_d normal = otgLoad(u->directions[k].normal);
    const double depth = u->directions[k].depth, limit = otgMin_d(OTG_UNEVEN_WITHIN * depth, least);
    if (otgEndsAt_d(face, normal, c->mesh)) continue;
    const double out = otgWayOutOf(u, 1, probe, normal, limit);
    if (!(out < limit)) continue;
    const double back = otgWayOutOf(u, 0, probe, otgScale_d(normal, -1.0), limit);
    if (!(out + back < least && out + back <= depth)) continue;
    least = out + back;
    bestOut = out;
    bestBack = back;
    best = normal;
  }
  if (isfinite(least)) otgSetCandidate(u, c, best, bestOut, bestBack);
}

OTG_INLINED void otgMakeCrossings(__local const otg_uneven_scratch* s, const otg_solid_work* w, const otg_uneven* u,
                                  uint first) {
  for (uint k = get_local_id(0); k < s->crossings; k += OTG_GROUP) {
    otgMakeCrossing(s, w, u, s->points[s->parts + k], u->candidates + first + k);
  }
  OTG_SYNC_ALL;
}

#endif  // OTG_UNEVEN_CANDIDATES_H
