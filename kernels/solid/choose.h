// SPDX-License-Identifier: BSD-3-Clause
// From the candidates of one region to its contacts, by one work-group; as the second half of
// collide/solid/region_contacts.cpp.
//
// OTG_SOLID_CONTACTS: the most contacts of one region; OTG_SOLID_POINTS: the most candidates. With OTG_SOLID_LARGE
// planes may stand for several pieces. With OTG_RAYS_KNOWN all candidates were measured: their depths and shifts lie in
// place of `along`. OTG_GROUP is a power of two.
#ifndef OTG_SOLID_CHOOSE_H
#define OTG_SOLID_CHOOSE_H
#include "solid/merge.h"
//
#include "solid/pass.h"
#include "solid/point.h"
#include "solid/rays.h"

#if OTG_WARP && OTG_GROUP >= 32
/// Bits of the lanes of the warp for which x holds; the value of one lane for all. All lanes of the warp call it.
OTG_INLINED uint otgBallot(int x) {
  uint bits;
  __asm__ volatile("{ .reg .pred p; setp.ne.s32 p, %1, 0; vote.sync.ballot.b32 %0, p, 0xffffffff; }"
                   : "=r"(bits)
                   : "r"(x));
  return bits;
}
OTG_INLINED double otgOfLane(double x, uint lane) {
  const uint2 own = as_uint2(x);
  uint2 its;
  __asm__ volatile("shfl.sync.idx.b32 %0, %1, %2, 0x1f, 0xffffffff;" : "=r"(its.x) : "r"(own.x), "r"(lane));
  __asm__ volatile("shfl.sync.idx.b32 %0, %1, %2, 0x1f, 0xffffffff;" : "=r"(its.y) : "r"(own.y), "r"(lane));
  return as_double(its);
}
#endif

/// Of the candidates that are not taken the first, then always the first behind it that is worth that much more. Those
/// taken have a worth below 0: the place of the last one. All lanes call it. `round`: of those that look.
OTG_INLINED uint otgMostWorth(__local otg_solid_choice* s, uint all, uint* round) {
  const uint lane = get_local_id(0);
  OTG_SYNC;
#if OTG_WARP && OTG_GROUP >= 32
  // By one warp, 32 at a time: no lane waits at a barrier for what is a chain of comparisons.
  if (lane < 32) {
    uint best = OTG_NOT_THERE;
    double more = 0;
    for (uint base = 0; base < all; base += 32) {
      const double worth = base + lane < all ? OTG_RANK(s)[base + lane] : -1;
      uint better = otgBallot(best == OTG_NOT_THERE ? !(worth < 0) : worth > more);
      while (better != 0) {
        const uint first = otgLowestBit(better);
        best = base + first;
        more = OTG_SOLID_FARTHER * otgOfLane(worth, first);
        better = otgBallot(worth > more) & ~((2u << first) - 1);
      }
    }
    if (lane == 0) s->next[0] = best;
  }
  OTG_SYNC;
  return s->next[0];
#else
  // The first that is not taken, then always the first behind it that is worth that much more: each looked for by all
  // lanes. A word is made ready for the next time while that of the last time may still be read.
  uint best = OTG_NOT_THERE;
  double more = 0;
  for (int goesOn = 1; goesOn; ++*round) {
    if (lane == 0) s->next[(*round + 1) % 3] = OTG_NOT_THERE;
    const uint from = best == OTG_NOT_THERE ? 0 : best + 1;
    for (uint j = from + (lane + OTG_GROUP - from % OTG_GROUP) % OTG_GROUP; j < all; j += OTG_GROUP) {
      const double worth = OTG_RANK(s)[j];
      if (best == OTG_NOT_THERE ? worth < 0 : !(worth > more)) continue;
      atomic_min(s->next + *round % 3, j);
      break;
    }
    OTG_SYNC;
    const uint next = s->next[*round % 3];
    goesOn = next != OTG_NOT_THERE;
    if (goesOn) {
      best = next;
      more = OTG_SOLID_FARTHER * OTG_RANK(s)[best];
    }
  }
  return best;
#endif
}

/// Where a candidate is, while they are spread.
OTG_INLINED otg_vec3_d otgPlaceOf(__local const otg_solid_choice* s, const otg_solid_work* w, uint c) {
#ifdef OTG_RAYS_KNOWN
  return otgVec_d(OTG_X(s)[c], OTG_Y(s)[c], OTG_Z(s)[c]);
#else
  return otgLoad(otgPointOf(w, c)->at);
#endif
}

/// The first, then again and again the one of most worth: farthest from those chosen, in position and normal, and deep.
OTG_INLINED void otgSpreadCandidates(__local otg_solid_choice* s, const otg_solid_work* w, uint places) {
  const uint lane = get_local_id(0), all = s->count, count = min(places, all);
  const double scale = w->diagonal > 0 ? 1 / (w->diagonal * w->diagonal) : 0;
  double deepest = 0;
  for (uint j = lane; j < all; j += OTG_GROUP) {
    const uint c = s->order[j];
    deepest = otgMax_d(OTG_DEPTH(s)[c], deepest);
    OTG_SPREAD(s)[c] = INFINITY;
    s->alive[c] = j > 0;  // not taken
#ifdef OTG_RAYS_KNOWN
    const otg_vec3_d at = otgLoad(otgPointOf(w, c)->at);
    OTG_X(s)[c] = at.x;
    OTG_Y(s)[c] = at.y;
    OTG_Z(s)[c] = at.z;
#endif
  }
  deepest = otgLargestOf(s->reduce, deepest);
  if (lane == 0) {
    if (count > 0) s->picked[0] = s->order[0];
    s->next[0] = OTG_NOT_THERE;
  }
  OTG_SYNC;
  uint round = 0;
  for (uint i = 1; i < count; ++i) {
    const uint last = s->picked[i - 1];
    const otg_vec3_d at = otgPlaceOf(s, w, last), normal = otgNormalOf(s, w, last);
    for (uint j = lane; j < all; j += OTG_GROUP) {
      const uint c = s->order[j];
      double worth = -1;
      if (s->alive[c]) {
        const double apart = otgApart_d(otgPlaceOf(s, w, c), otgNormalOf(s, w, c), at, normal, scale);
        OTG_SPREAD(s)[c] = otgMin_d(apart, OTG_SPREAD(s)[c]);
        worth = otgWorth_d(OTG_SPREAD(s)[c], OTG_DEPTH(s)[c], deepest);
      }
      OTG_RANK(s)[j] = worth;
    }
    const uint best = otgMostWorth(s, all, &round);
    OTG_SYNC;
    if (lane == 0) {
      s->picked[i] = s->order[best];
      s->alive[s->order[best]] = 0;
    }
    OTG_SYNC;
  }
  for (uint i = lane; i < count; i += OTG_GROUP) s->order[i] = s->picked[i];
  if (lane == 0) s->count = count;
  OTG_SYNC;
}

#ifdef OTG_RAYS_KNOWN
OTG_INLINED void otgCastRays(__local otg_solid_choice* s, const otg_solid_work* w, uint count,
                             __global const float4* meshes, OTG_MESH* a, OTG_MESH* b) {
  (void)s, (void)w, (void)count, (void)meshes, (void)a, (void)b;
}

/// Gives the candidate at place k the depth that was measured.
OTG_INLINED double otgTakeDepth(__local otg_solid_choice* s, const otg_solid_work* w, uint k) {
  const uint c = s->order[k];
  __global otg_solid_point* p = otgPointOf(w, c);
  p->shift = p->along[1];
  return OTG_DEPTH(s)[c] = p->along[0];
}
#else
/// The ways out of the first `count` candidates, by rays. All lanes call it.
OTG_INLINED void otgCastRays(__local otg_solid_choice* s, const otg_solid_work* w, uint count,
                             __global const float4* meshes, OTG_MESH* a, OTG_MESH* b) {
  const double far = 4 * (double)(a->radius + b->radius);
  const double skin = 1e-9 * (double)(a->radius < b->radius ? b->radius : a->radius);
  const otg_vec3_d origin = otgLoad(w->region->origin);
  for (uint r = get_local_id(0); r < 2 * count; r += OTG_GROUP) {
    __global const otg_solid_point* p = otgPointOf(w, s->order[r / 2]);
    const otg_vec3_d from = otgAdd_d(otgLoad(p->probe), origin), normal = otgLoad(p->normal);
    const int isOut = r % 2 == 0;  // out of B, else back out of A
    const double way = otgExitDistance(meshes, isOut ? b : a, from, otgScale_d(normal, isOut ? 1.0 : -1.0), far, skin);
    if (way == -2) s->bad = 1;
    s->ways[r] = otgMax_d(way, 0);
  }
  OTG_SYNC;
}

/// Gives the candidate at place k the depth that the rays measured.
OTG_INLINED double otgTakeDepth(__local otg_solid_choice* s, const otg_solid_work* w, uint k) {
  const uint c = s->order[k];
  double out = s->ways[2 * k], back = s->ways[2 * k + 1];
  const double depth = otgClampWays(otgPointOf(w, c)->limit, &out, &back);
  if (otgLeavesBeside_d(depth, OTG_DEPTH(s)[c], otgPointOf(w, c)->passes)) return OTG_DEPTH(s)[c];
  OTG_DEPTH(s)[c] = depth;
  otgPointOf(w, c)->shift = 0.5 * (out - back);  // unordered: all lanes have read it
  return depth;
}
#endif

#if OTG_SOLID_LARGE
/// Where planes are gathered: of the candidates that estimates cannot distinguish the farthest in of either mesh are
/// measured, and the deeper one is first; then the best by spread are measured, and the deepest of them is first.
OTG_INLINED void otgMeasureGathered(__local otg_solid_choice* s, const otg_solid_work* w, uint places,
                                    __global const float4* meshes, OTG_MESH* a, OTG_MESH* b) {
  const uint lane = get_local_id(0), all = w->isGathered ? s->count : 0;
  const double enough = (1 - OTG_SOLID_GATHERED_ERROR) * s->highest;
  if (lane == 0) s->seeds = 0;
  for (uint mesh = 0; mesh < 2; ++mesh) {
    uint best = OTG_NOT_THERE;
    double most = 0;
    for (uint k = lane; k < all; k += OTG_GROUP) {
      __global const otg_solid_point* p = otgPointOf(w, s->order[k]);
      if (p->mesh != mesh || OTG_RANK(s)[s->order[k]] < enough) continue;
      const double hint = otgDepthHint(w, mesh, otgLoad(p->at));
      if (best != OTG_NOT_THERE && !(hint > most)) continue;
      best = k;
      most = hint;
    }
    best = otgFirstOfLargest(s, most, best);
    // The two to be measured, at the front in turn.
    if (lane == 0 && best != OTG_NOT_THERE) s->picked[s->seeds++] = (ushort)best;
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
    otgCastRays(s, w, 1, meshes, a, b);
    if (lane == 0) {
      const double depth = otgTakeDepth(s, w, 0);
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
  otgSpreadCandidates(s, w, OTG_SOLID_MEASURED_PER_CONTACT * places);
  const uint count = s->count;
  otgCastRays(s, w, count, meshes, a, b);
  uint deep = OTG_NOT_THERE;
  double depth = 0;
  for (uint k = lane; k < count; k += OTG_GROUP) {
    const double own = otgTakeDepth(s, w, k);
    if (deep != OTG_NOT_THERE && !(own > depth)) continue;
    deep = k;
    depth = own;
  }
  OTG_SYNC_ALL;
  deep = otgFirstOfLargest(s, depth, deep);
  if (lane == 0 && count > 0) otgBringToFront(s, deep);
  OTG_SYNC;
}
#endif

/// Which place in the order has the deepest candidate.
OTG_INLINED uint otgDeepestPlace(__local const otg_solid_choice* s) {
  uint deepest = 0;
  for (uint k = 1; k < s->count; ++k) {
    if (OTG_DEPTH(s)[s->order[k]] > OTG_DEPTH(s)[s->order[deepest]]) deepest = k;
  }
  return deepest;
}

/// Edges that cross each other may be deepest beyond the stretches that are inside. By one lane.
OTG_INLINED void otgRaiseDeepest(__local otg_solid_choice* s, const otg_solid_work* w) {
  if (s->count == 0) return;
  const uint c = s->order[otgDeepestPlace(s)];
  OTG_DEPTH(s)[c] = otgMax_d(OTG_DEPTH(s)[c], w->leastDepth);
}

#ifndef OTG_RAYS_KNOWN
/// Puts the candidate of a pass among those chosen: in place of that of the same point, else behind them. Where there is
/// no place it takes that of the last one. By one lane.
OTG_INLINED void otgAddPass(__local otg_solid_choice* s, const otg_solid_work* w, OTG_MESH* a, otg_vec3_d normal,
                            uint places, const otg_edge_pass* pass) {
  __global const otg_solid_point* from = w->points + pass->from;
  const int isPoint = from->kind >= OTG_POINT_MIDDLE;
  uint k = 0;
  while (k < s->count && !(isPoint && otgPointOf(w, s->order[k]) == from)) ++k;
  // Behind the region's points there is room for one.
  const uint c = k < s->count ? s->order[k] : w->candidates;
  if (k == s->count && w->picks) w->picks[c] = (ushort)w->pointCount;
  __global otg_solid_point* p = otgPointOf(w, c);
  if (isPoint) {
    *p = *from;
  } else {
    const int isEdge = pass->to != OTG_NOT_THERE;
    const uint edge = isEdge ? otgEdgeBetween(w, a, pass->from, pass->to) : from->feature;
    const uint halfEdge = a->edges[edge].z;
    otgWritePoint(p, a, pass->middle, otgScale_d(pass->along, pass->reach), otgNormalOfEdge(a, halfEdge),
                  otgVec_d(0, 0, 0), OTG_POINT_MIDDLE, edge, isEdge ? 0 : from->ordinal / 2, halfEdge / 3,
                  OTG_NOT_THERE, 0);
  }
  const otg_vec3_d at = otgAdd_d(pass->middle, otgScale_d(pass->along, pass->at));
  otgStore(p->at, at);
  otgStore(p->probe, at);
  otgStore(p->normal, normal);
  p->shift = 0.5 * pass->way;
  OTG_DEPTH(s)[c] = pass->way;
  if (k == s->count && k == places) --k;
  s->order[k] = (ushort)c;
  s->count = max(s->count, k + 1);
}

/// The largest in a list of the region's points, or 0 if that is more. All lanes call it.
OTG_INLINED double otgHighestOf(__local otg_solid_choice* s, const otg_solid_work* w, __local const double* heights) {
  double highest = -INFINITY;
  for (uint i = get_local_id(0); i < w->pointCount; i += OTG_GROUP) highest = otgMax_d(heights[i], highest);
  return otgLargestOf(s->reduce, highest);
}

/// Few facets are deepest where two of their edges pass each other, and not all edges are candidates. All lanes call it.
OTG_INLINED void otgAddDeepestPass(__local otg_solid_choice* s, const otg_solid_work* w, OTG_MESH* a, OTG_MESH* b,
                                   uint places) {
  if (s->count == 0 || w->isUneven) return;  // for all lanes, as below
  const uint vertices = otgCountVertices(w);
  if (vertices > OTG_SOLID_FEW_VERTICES) return;
  const uint deepest = s->order[otgDeepestPlace(s)];
  const otg_vec3_d normal = otgLoad(otgPointOf(w, deepest)->normal);
  const double least = OTG_SOLID_DEEPER_THAN_ENDS * OTG_DEPTH(s)[deepest];
  otg_pass_room room;
  room.heights[0] = OTG_RANK(s);
  room.heights[1] = OTG_X(s);
  room.partners = (__local ulong*)OTG_Z(s);
  otgListHeights(w, normal, &room);
  OTG_SYNC;
  const double ofA = otgHighestOf(s, w, room.heights[0]), ofB = otgHighestOf(s, w, room.heights[1]);
  if (!(ofA + ofB > least)) return;
  otgListPartners(w, a, b, vertices, &room);
  OTG_SYNC;
  otg_edge_pass pass;
  const uint from = otgDeepestPass(w, &room, vertices, ofB, normal, least, &pass);
  const uint first = otgFirstOfLargest(s, pass.way, from);
  OTG_SYNC;
  if (first != OTG_NOT_THERE && first == from) otgAddPass(s, w, a, normal, places, &pass);
}
#endif

/// Depths by rays. Those of gathered planes were measured before; candidates of uneven regions are measured on the
/// triangles. What is shallow for its kind is dropped.
OTG_INLINED void otgMeasure(__local otg_solid_choice* s, const otg_solid_work* w, __global const float4* meshes,
                            OTG_MESH* a, OTG_MESH* b, uint places) {
  const uint lane = get_local_id(0), count = s->count;
  const uint cast = w->isGathered || w->isUneven ? 0 : count;
  otgCastRays(s, w, cast, meshes, a, b);
  for (uint k = lane; k < cast; k += OTG_GROUP) otgTakeDepth(s, w, k);
  OTG_SYNC_ALL;
  double deepest = 0;
  for (uint k = lane; k < count; k += OTG_GROUP) deepest = otgMax_d(OTG_DEPTH(s)[s->order[k]], deepest);
  deepest = otgLargestOf(s->reduce, deepest);
  for (uint k = lane; k < count; k += OTG_GROUP) s->alive[s->order[k]] = 1;
  OTG_SYNC;
  for (uint k = lane; k < count; k += OTG_GROUP) {
    const uint c = s->order[k];
    const double most = w->isUneven ? otgDeepestAlong(s, w, c, s->order, count) : deepest;
    s->step[c] = !(OTG_DEPTH(s)[c] < otgLeastOfKind_d((int)otgPointOf(w, c)->kind, most));
  }
  OTG_SYNC;
  for (uint k = lane; k < count; k += OTG_GROUP) s->alive[s->order[k]] = (uchar)s->step[s->order[k]];
  OTG_SYNC;
  otgKeepInOrder(s, count);
  if (lane == 0) otgRaiseDeepest(s, w);
  OTG_SYNC;
#ifdef OTG_RAYS_KNOWN
  (void)places;
#else
  otgAddDeepestPass(s, w, a, b, places);
  OTG_SYNC_ALL;
#endif
}

/// The piece of a mesh through which the contact's normal leaves, among pieces `begin` to `end`: its plane is the
/// nearest ahead. `nearest`: how far; OTG_NOT_THERE if there is none.
OTG_INLINED uint otgFacing(const otg_solid_work* w, uint mesh, uint begin, uint end, otg_vec3_d probe,
                           otg_vec3_d normal, double* nearest) {
  const otg_vec3_d direction = mesh == 1 ? normal : otgScale_d(normal, -1.0);
  double least = INFINITY;
  uint triangle = OTG_NOT_THERE;
  OTG_UNROLLED(2)
  for (uint j = begin; j < end; ++j) {
    __global const otg_solid_piece* p = w->pieces + j;
    const otg_vec3_d n = otgLoad(p->normal);
    const double cosine = otgDot_d(n, direction);
    const int isAhead = (p->mesh == mesh) & (cosine > 0.05);
    // Among planes equally far the piece whose box is nearest to the point.
    const double x = otgMax_d(otgMax_d(p->lo[0] - probe.x, 0), probe.x - p->hi[0]);
    const double y = otgMax_d(otgMax_d(p->lo[1] - probe.y, 0), probe.y - p->hi[1]);
    const double z = otgMax_d(otgMax_d(p->lo[2] - probe.z, 0), probe.z - p->hi[2]);
    const double d = otgMax_d((p->offset - otgDot_d(n, probe)) / (isAhead ? cosine : 1.0), 0) + x + y + z;
    triangle = isAhead & (d < least) ? p->triangle : triangle;
    least = isAhead & (d < least) ? d : least;
  }
  *nearest = least;
  return triangle;
}

/// The triangle of a mesh's last piece, or 0.
OTG_INLINED uint otgLastOf(const otg_solid_work* w, uint mesh) {
  for (uint j = w->pieceCount; j-- > 0;) {
    if (w->pieces[j].mesh == mesh) return w->pieces[j].triangle;
  }
  return 0;
}

/// ContactFeature of a point, and its flags.
OTG_INLINED uint otgFeatureOf(uint kind, uint mesh) {
  const uint first = kind == OTG_POINT_VERTEX ? 4 : kind == OTG_POINT_CROSSING ? 6 : 8;
  return (first + mesh) | (kind != OTG_POINT_CROSSING ? 1u << 8 : 0);
}

/// Appends the region's contacts to `out`, deepest first.
OTG_INLINED void otgEmit(__local otg_solid_choice* s, const otg_solid_work* w, uint number,
                         __global otg_chosen_contact* out) {
  const uint lane = get_local_id(0), count = s->count;
  const otg_vec3_d origin = otgLoad(w->region->origin);
  // Several lanes to a contact look for the triangle that it has not from its feature.
  const uint parts = OTG_FACING_PARTS * OTG_SOLID_CONTACTS / max(count, 1u);
  for (uint item = lane; item < count * parts; item += OTG_GROUP) {
    __global const otg_solid_point* p = otgPointOf(w, s->order[item / parts]);
    const uint part = item % parts, step = (w->pieceCount + parts - 1) / parts;
    const uint mesh = p->triangleA == OTG_NOT_THERE ? 0 : 1;
    const int isWanted = p->triangleA == OTG_NOT_THERE || p->triangleB == OTG_NOT_THERE;
    double nearest = INFINITY;
    s->facing[item] = OTG_NOT_THERE;
    if (isWanted) {
      s->facing[item] = otgFacing(w, mesh, min(part * step, w->pieceCount), min((part + 1) * step, w->pieceCount),
                                  otgLoad(p->probe), otgLoad(p->normal), &nearest);
    }
    s->ways[item] = nearest;
  }
  OTG_SYNC;
  for (uint k = lane; k < count; k += OTG_GROUP) {
    const uint i = s->order[k];
    __global const otg_solid_point* p = otgPointOf(w, i);
    uint place = 0, facing = OTG_NOT_THERE;
    for (uint j = 0; j < count; ++j) {
      const uint c = s->order[j];
      place += OTG_DEPTH(s)[c] > OTG_DEPTH(s)[i] ||
               (OTG_DEPTH(s)[c] == OTG_DEPTH(s)[i] && otgPointOf(w, c)->order < p->order);
    }
    double nearest = INFINITY;
    for (uint part = 0; part < parts; ++part) {
      const uint item = k * parts + part;
      if (s->facing[item] == OTG_NOT_THERE || !(s->ways[item] < nearest)) continue;
      nearest = s->ways[item];
      facing = s->facing[item];
    }
    if (facing == OTG_NOT_THERE) facing = otgLastOf(w, p->triangleA == OTG_NOT_THERE ? 0 : 1);
    const otg_vec3_d normal = otgLoad(p->normal);
    __global otg_chosen_contact* c = out + place;
    otgStore(c->position, otgAdd_d(otgMiddleOf(p), origin));
    otgStore(c->normal, normal);
    c->depth = OTG_DEPTH(s)[i];
    c->triangleA = p->triangleA != OTG_NOT_THERE ? p->triangleA : facing;
    c->triangleB = p->triangleB != OTG_NOT_THERE ? p->triangleB : facing;
    c->region = number;
    c->feature = otgFeatureOf(p->kind, p->mesh);
    c->element = p->feature;
    c->ordinal = p->ordinal;
    c->coherence = w->coherence;
  }
  OTG_SYNC_ALL;
}

#endif  // OTG_SOLID_CHOOSE_H
