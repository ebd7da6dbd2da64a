// SPDX-License-Identifier: BSD-3-Clause
// From the points of one region to its contacts, by one work-group; as collide/solid/region_contacts.cpp.
#ifndef OTG_SOLID_CHOOSE_H
#define OTG_SOLID_CHOOSE_H
#include "solid_thin.h"
//
#include "solid_rays.h"

/// Clamps both ways and their sum, which is returned, to the region's extent along the normal.
OTG_INLINED double otgClampWays(double limit, double* out, double* back) {
  *out = otgMin_d(limit, *out);
  *back = otgMin_d(limit, *back);
  return otgMin_d(limit, *out + *back);
}

/// Whether a middle of a stretch is hardly deeper than its ends are on average: then they hold it.
OTG_INLINED int otgSaysNothingNew(const otg_solid_work* w, __global const otg_solid_point* p, otg_vec3_d probe,
                                  otg_vec3_d normal, double limit, double depth) {
  const double reach = otgReachOfEnds_d(p->reach, w->diagonal);
  double ends = 0;
  OTG_ROLLED
  for (int side = -1; side <= 1; side += 2) {
    const otg_vec3_d at = otgAdd_d(probe, otgScale_d(otgLoad(p->along), side * reach));
    double out = otgPlaneExit(w, 1, at, normal), back = otgPlaneExit(w, 0, at, otgScale_d(normal, -1.0));
    ends += 0.5 * otgClampWays(limit, &out, &back);
  }
  return depth <= OTG_SOLID_DEEPER_THAN_ENDS * ends;
}

/// Every point as a candidate: where it is measured, its normal, its estimated depth.
OTG_INLINED void otgEstimate(const otg_solid_work* w) {
  __local otg_solid_choice* s = w->s;
  const uint lane = get_local_id(0);
  if (lane == 0) s->corners = 0;
  OTG_SYNC;
  for (uint i = lane; i < w->pointCount; i += OTG_GROUP) {
    if (!w->points[i].flat) atomic_inc(&s->corners);
  }
  OTG_SYNC;
  // The corners of an overlap are never flat points, as long as anything is not flat.
  const int skipFlat = s->isFlat && s->corners >= 3;
  for (uint i = lane; i < w->candidates; i += OTG_GROUP) {
    __global otg_solid_point* p = otgPointOf(w, i);
    const uint number = (uint)(p - w->points);
    s->alive[i] = 0;
    if (skipFlat && p->flat) continue;
    const int kind = (int)p->kind;
    // Edges across each other hold each other where they are nearest, not in their middles.
    const int onA = s->across != OTG_NOT_THERE && number == s->sharp[0][s->across / OTG_SOLID_MOST_STRETCHES];
    const int onB = s->across != OTG_NOT_THERE && number == s->sharp[1][s->across % OTG_SOLID_MOST_STRETCHES];
    const otg_vec3_d at = onA   ? otgVec_d(s->places[0], s->places[1], s->places[2])
                          : onB ? otgVec_d(s->places[3], s->places[4], s->places[5])
                                : otgLoad(p->position);
    otgStore(p->at, at);
    const otg_vec3_d probe =
        otgProbe_d(at, otgLoad(p->along), p->reach, otgLoad(p->surfaceNormal), kind, w->diagonal, w->thickness);
    const otg_vec3_d normal = otgNormalAt(w, probe);
    const double limit = otgExtentAlong(w, normal);
    double out = otgPlaneExit(w, 1, probe, normal), back = otgPlaneExit(w, 0, probe, otgScale_d(normal, -1.0));
    const double depth = otgClampWays(limit, &out, &back);
    if (kind >= OTG_POINT_MIDDLE && !onA && !onB && otgSaysNothingNew(w, p, probe, normal, limit, depth)) continue;
    otgStore(p->probe, probe);
    otgStore(p->normal, normal);
    p->limit = limit;
    p->shift = 0.5 * (out - back);
    OTG_DEPTH(s)[i] = depth;
    OTG_RANK(s)[i] = otgRankOfKind_d(kind, out + back);
    s->alive[i] = 1;
  }
  OTG_SYNC_ALL;
}

/// Where the contact would be: the middle of the overlap, beside the point and not beside the probe.
OTG_INLINED otg_vec3_d otgMiddleOf(__global const otg_solid_point* p) {
  const otg_vec3_d at = otgLoad(p->at), normal = otgLoad(p->normal);
  const double moved = otgDot_d(otgSub_d(otgLoad(p->probe), at), normal);
  return otgAdd_d(at, otgScale_d(normal, moved + p->shift));
}

/// The largest depth of those alive. All lanes call it.
OTG_INLINED double otgDeepest(const otg_solid_work* w) {
  double most = 0;
  for (uint i = get_local_id(0); i < w->candidates; i += OTG_GROUP) {
    if (w->s->alive[i]) most = otgMax_d(OTG_DEPTH(w->s)[i], most);
  }
  return otgLargestOf(w->s, most);
}

OTG_INLINED void otgDropShallow(const otg_solid_work* w, double least) {
  for (uint i = get_local_id(0); i < w->candidates; i += OTG_GROUP) {
    if (OTG_DEPTH(w->s)[i] < otgLeastOfKind_d((int)otgPointOf(w, i)->kind, least)) w->s->alive[i] = 0;
  }
  OTG_SYNC;
}

/// Moves the candidate at place k to the front. By one lane.
OTG_INLINED void otgBringToFront(__local otg_solid_choice* s, uint k) {
  const ushort taken = s->order[k];
  for (; k > 0; --k) s->order[k] = s->order[k - 1];
  s->order[0] = taken;
}

/// Drops what is shallow for its kind, then of points that lie together and agree in direction all but the first.
/// s->order gets the others, s->count of them.
OTG_INLINED void otgFilterAndMerge(const otg_solid_work* w) {
  __local otg_solid_choice* s = w->s;
  const uint lane = get_local_id(0);
  uint count = 0, total;
  otgDropShallow(w, 0.5 * otgDeepest(w));  // half the fractions: estimates err
  double highest = 0;
  for (uint i = lane; i < w->candidates; i += OTG_GROUP) {
    if (s->alive[i]) highest = otgMax_d(OTG_RANK(s)[i], highest);
  }
  highest = otgLargestOf(s, highest);
  if (lane == 0) s->highest = highest;
  // The features by which ties are settled lie where spread comes later.
  __local ulong* orders = (__local ulong*)OTG_SPREAD(s);
  for (uint i = lane; i < w->candidates; i += OTG_GROUP) {
    s->step[i] = s->alive[i] ? otgRankStep_d(OTG_RANK(s)[i], highest) : INT_MAX;
    if (!s->alive[i]) continue;
    orders[i] = otgPointOf(w, i)->order;
    const otg_vec3_d middle = otgMiddleOf(otgPointOf(w, i));
    OTG_X(s)[i] = middle.x;  // in place of the points, which are not asked for any more
    OTG_Y(s)[i] = middle.y;
    OTG_Z(s)[i] = middle.z;
  }
  OTG_SYNC;
  for (uint base = 0; base < w->candidates; base += OTG_GROUP) {
    const uint i = base + lane;
    const int isAlive = i < w->candidates && s->alive[i];
    if (isAlive) {
      const int step = s->step[i];
      const ulong order = orders[i];
      uint place = 0;
      for (uint j = 0; j < w->candidates; ++j) {
        place += s->step[j] < step || (s->step[j] == step && orders[j] < order);
      }
      s->order[place] = (ushort)i;
    }
    otgPlaceAmong(OTG_COUNTS(s), isAlive, &total);
    count += total;
  }
  OTG_SYNC;
  // Where the bodies are round the deepest is one point, and it is the first; where they are flat many tremble about
  // it.
  if (lane == 0 && !s->isFlat && count > 0) {
    uint first = 0;
    while (first < count && !(OTG_RANK(s)[s->order[first]] >= highest)) ++first;
    otgBringToFront(s, first);
  }
  OTG_SYNC;
  const double reach = OTG_SOLID_MERGE_DISTANCE * w->diagonal;
  for (uint k = 0; k < count; ++k) {
    const uint kept = s->order[k];
    if (s->alive[kept]) {
      const otg_vec3_d middle = otgVec_d(OTG_X(s)[kept], OTG_Y(s)[kept], OTG_Z(s)[kept]);
      const otg_vec3_d normal = otgLoad(otgPointOf(w, kept)->normal);
      for (uint j = k + 1 + lane; j < count; j += OTG_GROUP) {
        const uint i = s->order[j];
        if (!s->alive[i]) continue;
        const otg_vec3_d d = otgSub_d(otgVec_d(OTG_X(s)[i], OTG_Y(s)[i], OTG_Z(s)[i]), middle);
        if (otgDot_d(d, d) <= reach * reach &&
            otgDot_d(otgLoad(otgPointOf(w, i)->normal), normal) >= OTG_SOLID_MERGE_COSINE) {
          s->alive[i] = 0;
        }
      }
    }
    OTG_SYNC;
  }
  if (lane == 0) {
    uint kept = 0;
    for (uint k = 0; k < count; ++k) {
      if (s->alive[s->order[k]]) s->order[kept++] = s->order[k];
    }
    s->count = kept;
  }
  OTG_SYNC;
}

/// The first, then again and again the one of most worth: farthest from those chosen, in position and normal, and deep.
OTG_INLINED void otgSpreadCandidates(const otg_solid_work* w, uint places) {
  __local otg_solid_choice* s = w->s;
  const uint lane = get_local_id(0), all = s->count, count = min(places, all);
  const double scale = w->diagonal > 0 ? 1 / (w->diagonal * w->diagonal) : 0;
  double deepest = 0;
  for (uint j = lane; j < all; j += OTG_GROUP) {
    const uint c = s->order[j];
    deepest = otgMax_d(OTG_DEPTH(s)[c], deepest);
    OTG_SPREAD(s)[c] = INFINITY;
    s->alive[c] = j > 0;  // not taken
  }
  deepest = otgLargestOf(s, deepest);
  if (lane == 0 && count > 0) s->picked[0] = s->order[0];
  OTG_SYNC;
  for (uint i = 1; i < count; ++i) {
    __global const otg_solid_point* last = otgPointOf(w, s->picked[i - 1]);
    const otg_vec3_d at = otgLoad(last->at), normal = otgLoad(last->normal);
    for (uint j = lane; j < all; j += OTG_GROUP) {
      const uint c = s->order[j];
      double worth = -1;
      if (s->alive[c]) {
        __global const otg_solid_point* p = otgPointOf(w, c);
        const double apart = otgApart_d(otgLoad(p->at), otgLoad(p->normal), at, normal, scale);
        OTG_SPREAD(s)[c] = otgMin_d(apart, OTG_SPREAD(s)[c]);
        worth = otgWorth_d(OTG_SPREAD(s)[c], OTG_DEPTH(s)[c], deepest);
      }
      OTG_RANK(s)[j] = worth;
    }
    OTG_SYNC;
    if (lane == 0) {
      uint best = 0;
      double more = -1;
      while (best + 1 < all && !(OTG_RANK(s)[best] >= 0)) ++best;
      more = OTG_SOLID_FARTHER * OTG_RANK(s)[best];
      for (uint j = best + 1; j < all; ++j) {
        const double worth = OTG_RANK(s)[j];
        if (worth > more) {
          best = j;
          more = OTG_SOLID_FARTHER * worth;
        }
      }
      s->picked[i] = s->order[best];
      s->alive[s->order[best]] = 0;
    }
    OTG_SYNC;
  }
  for (uint i = lane; i < count; i += OTG_GROUP) s->order[i] = s->picked[i];
  if (lane == 0) s->count = count;
  OTG_SYNC;
}

/// The ways out of the first `count` candidates, by rays. All lanes call it.
OTG_INLINED void otgCastRays(const otg_solid_work* w, uint count, __global const float4* meshes,
                             const otg_device_mesh* placeA, const otg_device_mesh* placeB, const otg_solid_mesh* a,
                             const otg_solid_mesh* b) {
  __local otg_solid_choice* s = w->s;
  const double far = 4 * (double)(placeA->radius + placeB->radius);
  const double skin = 1e-9 * (double)(placeA->radius < placeB->radius ? placeB->radius : placeA->radius);
  const otg_vec3_d origin = otgLoad(w->region->origin);
  for (uint r = get_local_id(0); r < 2 * count; r += OTG_GROUP) {
    __global const otg_solid_point* p = otgPointOf(w, s->order[r / 2]);
    const otg_vec3_d from = otgAdd_d(otgLoad(p->probe), origin), normal = otgLoad(p->normal);
    const int isOut = r % 2 == 0;  // out of B, else back out of A
    const double way = otgExitDistance(meshes, isOut ? placeB : placeA, isOut ? b : a, from,
                                       otgScale_d(normal, isOut ? 1.0 : -1.0), far, skin);
    if (way == -2) s->bad = 1;
    s->ways[r] = otgMax_d(way, 0);
  }
  OTG_SYNC;
}

/// Gives the candidate at place k the depth that the rays measured.
OTG_INLINED double otgTakeDepth(const otg_solid_work* w, uint k) {
  __local otg_solid_choice* s = w->s;
  const uint c = s->order[k];
  double out = s->ways[2 * k], back = s->ways[2 * k + 1];
  const double depth = otgClampWays(otgPointOf(w, c)->limit, &out, &back);
  OTG_DEPTH(s)[c] = depth;
  otgPointOf(w, c)->shift = 0.5 * (out - back);
  return depth;
}

#if OTG_SOLID_LARGE
/// Where planes are gathered: of the candidates that estimates cannot tell apart the farthest in of either mesh are
/// measured, and the deeper one is first; then the best by spread are measured, and the deepest of them is first.
OTG_INLINED void otgMeasureGathered(const otg_solid_work* w, uint places, __global const float4* meshes,
                                    const otg_device_mesh* placeA, const otg_device_mesh* placeB,
                                    const otg_solid_mesh* a, const otg_solid_mesh* b) {
  __local otg_solid_choice* s = w->s;
  const uint lane = get_local_id(0), all = w->isGathered ? s->count : 0;
  const double enough = (1 - OTG_SOLID_GATHERED_ERROR) * s->highest;
  if (lane == 0) {
    uint best[2];
    for (uint mesh = 0; mesh < 2; ++mesh) {
      best[mesh] = OTG_NOT_THERE;
      double most = 0;
      for (uint k = 0; k < all; ++k) {
        __global const otg_solid_point* p = otgPointOf(w, s->order[k]);
        if (p->mesh != mesh || OTG_RANK(s)[s->order[k]] < enough) continue;
        const double hint = otgDepthHint(w, mesh, otgLoad(p->at));
        if (best[mesh] != OTG_NOT_THERE && !(hint > most)) continue;
        best[mesh] = k;
        most = hint;
      }
    }
    // The two to be measured, at the front in turn.
    s->seeds = 0;
    for (uint mesh = 0; mesh < 2; ++mesh) {
      if (best[mesh] != OTG_NOT_THERE) s->picked[s->seeds++] = (ushort)best[mesh];
    }
  }
  OTG_SYNC;
  const uint seeds = w->isGathered ? s->seeds : 0;
  uint deepest = OTG_NOT_THERE;
  double most = 0;
  for (uint k = 0; k < seeds; ++k) {
    const uint place = s->picked[k];
    const ushort first = s->order[0];
    OTG_SYNC;
    if (lane == 0) {
      s->order[0] = s->order[place];
      s->order[place] = first;
    }
    OTG_SYNC_ALL;
    otgCastRays(w, 1, meshes, placeA, placeB, a, b);
    if (lane == 0) {
      const double depth = otgTakeDepth(w, 0);
      if (deepest == OTG_NOT_THERE || depth > most) {
        deepest = place;
        most = depth;
      }
      s->order[place] = s->order[0];
      s->order[0] = first;
    }
    OTG_SYNC_ALL;
  }
  if (lane == 0 && deepest != OTG_NOT_THERE) otgBringToFront(s, deepest);
  OTG_SYNC_ALL;
  if (!w->isGathered) return;
  otgSpreadCandidates(w, OTG_SOLID_MEASURED_PER_CONTACT * places);
  const uint count = s->count;
  otgCastRays(w, count, meshes, placeA, placeB, a, b);
  for (uint k = lane; k < count; k += OTG_GROUP) otgTakeDepth(w, k);
  OTG_SYNC_ALL;
  if (lane == 0) {
    uint deep = 0;
    for (uint k = 1; k < count; ++k) {
      if (OTG_DEPTH(s)[s->order[deep]] < OTG_DEPTH(s)[s->order[k]]) deep = k;
    }
    otgBringToFront(s, deep);
  }
  OTG_SYNC;
}
#endif

/// Depths by rays, until two agree with their estimates and none has disagreed: then the others are believed. Gathered
/// planes are not believed, and all are measured before. What is shallow for its kind is dropped.
OTG_INLINED void otgMeasure(const otg_solid_work* w, __global const float4* meshes, const otg_device_mesh* placeA,
                            const otg_device_mesh* placeB, const otg_solid_mesh* a, const otg_solid_mesh* b) {
  __local otg_solid_choice* s = w->s;
  const uint lane = get_local_id(0), count = s->count;
  otgCastRays(w, w->isGathered ? 0 : count, meshes, placeA, placeB, a, b);
  if (lane == 0) {
    int agree = 0, disagree = 0;
    for (uint k = 0; k < count && !w->isGathered; ++k) {
      if (agree >= 2 && !disagree) break;
      const double estimate = OTG_DEPTH(s)[s->order[k]], depth = otgTakeDepth(w, k);
      if (fabs(estimate - depth) <= OTG_SOLID_AGREES * (estimate < depth ? depth : estimate)) {
        ++agree;
      } else {
        disagree = 1;
      }
    }
    double deepest = 0;
    for (uint k = 0; k < count; ++k) deepest = otgMax_d(OTG_DEPTH(s)[s->order[k]], deepest);
    uint kept = 0;
    for (uint k = 0; k < count; ++k) {
      const uint c = s->order[k];
      if (!(OTG_DEPTH(s)[c] < otgLeastOfKind_d((int)otgPointOf(w, c)->kind, deepest))) s->order[kept++] = (ushort)c;
    }
    s->count = kept;
  }
  OTG_SYNC_ALL;
}

/// The piece of a mesh through which the contact's normal leaves: its plane is the nearest ahead.
OTG_INLINED uint otgFacing(const otg_solid_work* w, uint mesh, otg_vec3_d probe, otg_vec3_d normal) {
  const otg_vec3_d direction = mesh == 1 ? normal : otgScale_d(normal, -1.0);
  double nearest = INFINITY;
  uint triangle = OTG_NOT_THERE, any = 0;
  for (uint j = 0; j < w->s->listed[mesh]; ++j) {
    __global const otg_solid_piece* p = w->pieces + w->s->list[mesh][j];
    const otg_vec3_d n = otgLoad(p->normal);
    const double cosine = otgDot_d(n, direction);
    any = p->triangle;
    if (cosine <= 0.05) continue;
    // Among planes equally far the piece whose box is nearest to the point.
    const double x = otgMax_d(otgMax_d(p->lo[0] - probe.x, 0), probe.x - p->hi[0]);
    const double y = otgMax_d(otgMax_d(p->lo[1] - probe.y, 0), probe.y - p->hi[1]);
    const double z = otgMax_d(otgMax_d(p->lo[2] - probe.z, 0), probe.z - p->hi[2]);
    const double d = otgMax_d((p->offset - otgDot_d(n, probe)) / cosine, 0) + x + y + z;
    if (d < nearest) {
      nearest = d;
      triangle = p->triangle;
    }
  }
  return triangle == OTG_NOT_THERE ? any : triangle;
}

/// ContactFeature of a point, and its flags.
OTG_INLINED uint otgFeatureOf(uint kind, uint mesh) {
  const uint first = kind == OTG_POINT_VERTEX ? 4 : kind == OTG_POINT_CROSSING ? 6 : 8;
  return (first + mesh) | (kind != OTG_POINT_CROSSING ? 1u << 8 : 0);
}

/// Appends the region's contacts to `out`, deepest first.
OTG_INLINED void otgEmit(const otg_solid_work* w, uint number, __global otg_chosen_contact* out) {
  __local otg_solid_choice* s = w->s;
  const uint count = s->count;
  const otg_vec3_d origin = otgLoad(w->region->origin);
  for (uint k = get_local_id(0); k < count; k += OTG_GROUP) {
    const uint i = s->order[k];
    __global const otg_solid_point* p = otgPointOf(w, i);
    uint place = 0;
    for (uint j = 0; j < count; ++j) {
      const uint c = s->order[j];
      place += OTG_DEPTH(s)[c] > OTG_DEPTH(s)[i] ||
               (OTG_DEPTH(s)[c] == OTG_DEPTH(s)[i] && otgPointOf(w, c)->order < p->order);
    }
    const otg_vec3_d normal = otgLoad(p->normal), probe = otgLoad(p->probe);
    __global otg_chosen_contact* c = out + place;
    otgStore(c->position, otgAdd_d(otgMiddleOf(p), origin));
    otgStore(c->normal, normal);
    c->depth = OTG_DEPTH(s)[i];
    c->triangleA = p->triangleA != OTG_NOT_THERE ? p->triangleA : otgFacing(w, 0, probe, normal);
    c->triangleB = p->triangleB != OTG_NOT_THERE ? p->triangleB : otgFacing(w, 1, probe, normal);
    c->region = number;
    c->feature = otgFeatureOf(p->kind, p->mesh);
    c->element = p->feature;
    c->ordinal = p->ordinal;
    c->coherence = w->coherence;
  }
  OTG_SYNC_ALL;
}

#endif  // OTG_SOLID_CHOOSE_H
