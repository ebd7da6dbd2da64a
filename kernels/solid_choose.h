// SPDX-License-Identifier: BSD-3-Clause
// From the candidates of one region to its contacts, by one work-group; as the second half of
// collide/solid/region_contacts.cpp.
//
// OTG_SOLID_CONTACTS: the most contacts of one region; OTG_SOLID_POINTS: the most candidates. With OTG_SOLID_LARGE
// planes may stand for several pieces. With OTG_RAYS_KNOWN all candidates were measured: their depths and shifts lie in
// place of `along`. OTG_GROUP is a power of two.
#ifndef OTG_SOLID_CHOOSE_H
#define OTG_SOLID_CHOOSE_H
#include "solid_region.h"
//
#include "solid_rays.h"

#define OTG_SOLID_MOST_CONTACTS (OTG_SOLID_REGIONS * OTG_SOLID_CONTACTS)
#if OTG_SOLID_LARGE
#define OTG_SOLID_MEASURED (OTG_SOLID_MEASURED_PER_CONTACT * OTG_SOLID_CONTACTS)
#define OTG_FACING_PARTS 4
#else
#define OTG_SOLID_MEASURED OTG_SOLID_CONTACTS
#define OTG_FACING_PARTS 2
#endif

// The same memory for what is never needed at the same time. By candidate: depth, rank, distance from those chosen,
// place.
#define OTG_DEPTH(s) ((s)->numbers)
#define OTG_RANK(s) ((s)->numbers + OTG_SOLID_POINTS)
#define OTG_SPREAD(s) ((s)->numbers + 2 * OTG_SOLID_POINTS)
#define OTG_X(s) ((s)->numbers + 3 * OTG_SOLID_POINTS)
#define OTG_Y(s) ((s)->numbers + 4 * OTG_SOLID_POINTS)
#define OTG_Z(s) ((s)->numbers + 5 * OTG_SOLID_POINTS)
// Of the pair, by contact: as in contact_choose.h. In place of all six.
#define OTG_SPOT(s) ((__local uint2*)(s)->numbers)
#define OTG_NEAREST(s) ((__local uint*)(OTG_SPOT(s) + OTG_SOLID_MOST_CONTACTS))
#define OTG_SORTED(s) ((__local ushort*)(OTG_NEAREST(s) + OTG_SOLID_MOST_CONTACTS))

/// Of a candidate while those that lie together are merged; 0: it is dropped.
#define OTG_STAYS_OPEN 1
#define OTG_STAYS 2

/// What a work-group knows of the region that it works on, in local memory.
typedef struct {
  double numbers[6 * OTG_SOLID_POINTS];  ///< see OTG_DEPTH and what follows it
  // By candidate: a point, or one of the points that are left.
  int step[OTG_SOLID_POINTS];
  uchar alive[OTG_SOLID_POINTS];
  ushort order[OTG_SOLID_POINTS];  ///< candidates as they are ranked
  ushort picked[OTG_SOLID_MEASURED];
  double ways[2 * OTG_SOLID_MEASURED];  ///< out of B and back out of A, by place in the order
  uint facing[OTG_FACING_PARTS * OTG_SOLID_CONTACTS];
  double reduce[OTG_GROUP];
  uint places[OTG_GROUP];
  uint4 counts[(OTG_GROUP + 3) / 4];  ///< a word for each lane: OTG_COUNTS
  double highest;
  uint next[3];
  uint bad, count, contacts, allocated;
  uint low[3], high[3], seeds, seen;
} otg_solid_choice;

/// What solidEstimate says of the candidates.
OTG_INLINED void otgTakeEstimates(__local otg_solid_choice* s, const otg_solid_work* w) {
  for (uint i = get_local_id(0); i < w->candidates; i += OTG_GROUP) {
    __global const otg_solid_point* p = otgPointOf(w, i);
    const double depth = p->depth;
    OTG_DEPTH(s)[i] = depth;
    OTG_RANK(s)[i] = p->rank;
    s->alive[i] = depth >= 0;
  }
  OTG_SYNC;
}

/// Where the contact would be: the middle of the overlap, beside the point and not beside the probe.
OTG_INLINED otg_vec3_d otgMiddleOf(__global const otg_solid_point* p) {
  const otg_vec3_d at = otgLoad(p->at), normal = otgLoad(p->normal);
  const double moved = otgDot_d(otgSub_d(otgLoad(p->probe), at), normal);
  return otgAdd_d(at, otgScale_d(normal, moved + p->shift));
}

/// The largest depth of those alive. All lanes call it.
OTG_INLINED double otgDeepest(__local otg_solid_choice* s, const otg_solid_work* w) {
  double most = 0;
  for (uint i = get_local_id(0); i < w->candidates; i += OTG_GROUP) {
    if (s->alive[i]) most = otgMax_d(OTG_DEPTH(s)[i], most);
  }
  return otgLargestOf(s->reduce, most);
}

OTG_INLINED void otgDropShallow(__local otg_solid_choice* s, const otg_solid_work* w, double least) {
  for (uint i = get_local_id(0); i < w->candidates; i += OTG_GROUP) {
    if (OTG_DEPTH(s)[i] < otgLeastOfKind_d((int)otgPointOf(w, i)->kind, least)) s->alive[i] = 0;
  }
  OTG_SYNC;
}

/// The place at which the largest value is, the first of several, among those that lanes have; OTG_NOT_THERE where all
/// have that. All lanes call it.
OTG_INLINED uint otgFirstOfLargest(__local otg_solid_choice* s, double value, uint place) {
  const uint lane = get_local_id(0);
  OTG_SYNC;
  s->reduce[lane] = value;
  s->places[lane] = place;
  OTG_SYNC;
  for (uint half_ = OTG_GROUP / 2; half_ > 0; half_ /= 2) {
    if (lane < half_) {
      const uint mine = s->places[lane], other = s->places[lane + half_];
      const double x = s->reduce[lane], y = s->reduce[lane + half_];
      if (other != OTG_NOT_THERE && (mine == OTG_NOT_THERE || y > x || (y == x && other < mine))) {
        s->reduce[lane] = y;
        s->places[lane] = other;
      }
    }
    OTG_SYNC;
  }
  return s->places[0];
}

/// Of the candidates in order, s->count of them, keeps those that `stays` for each lane's own says. All lanes call it,
/// for lane, lane + OTG_GROUP and so on.
OTG_INLINED void otgKeepInOrder(__local otg_solid_choice* s, uint count) {
  const uint lane = get_local_id(0);
  uint kept = 0, total;
  for (uint base = 0; base < count; base += OTG_GROUP) {
    const uint k = base + lane;
    const ushort c = k < count ? s->order[k] : 0;
    const int stays = k < count && s->alive[c];
    const uint place = kept + otgPlaceAmong(OTG_COUNTS(s), stays, &total);
    // Places are not behind those that are read, and these lanes have read theirs.
    if (stays) s->order[place] = c;
    kept += total;
  }
  OTG_SYNC;
  if (lane == 0) s->count = kept;
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
OTG_INLINED void otgFilterAndMerge(__local otg_solid_choice* s, const otg_solid_work* w) {
  const uint lane = get_local_id(0);
  uint count = 0, total;
  otgDropShallow(s, w, 0.5 * otgDeepest(s, w));  // half the fractions: estimates err
  double highest = 0;
  for (uint i = lane; i < w->candidates; i += OTG_GROUP) {
    if (s->alive[i]) highest = otgMax_d(OTG_RANK(s)[i], highest);
  }
  highest = otgLargestOf(s->reduce, highest);
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
  if (lane == 0 && !w->isFlat && count > 0) {
    uint first = 0;
    while (first < count && !(OTG_RANK(s)[s->order[first]] >= highest)) ++first;
    if (first < count) otgBringToFront(s, first);
  }
  OTG_SYNC;
  // Whether one stays is settled once it is for all before it that lie near it: in rounds, of which few are needed.
  const double reach = OTG_SOLID_MERGE_DISTANCE * w->diagonal;
  for (int more = count > 0; more;) {
    uint open = 0;
    for (uint j = lane; j < count; j += OTG_GROUP) {
      const uint i = s->order[j];
      if (s->alive[i] != OTG_STAYS_OPEN) continue;
      const otg_vec3_d middle = otgVec_d(OTG_X(s)[i], OTG_Y(s)[i], OTG_Z(s)[i]);
      uchar stays = OTG_STAYS;
      for (uint k = 0; k < j && stays != 0; ++k) {
        const uint before = s->order[k];
        const uchar other = s->alive[before];
        if (other == 0) continue;
        const otg_vec3_d d = otgSub_d(otgVec_d(OTG_X(s)[before], OTG_Y(s)[before], OTG_Z(s)[before]), middle);
        if (!(otgDot_d(d, d) <= reach * reach)) continue;
        if (!(otgDot_d(otgLoad(otgPointOf(w, i)->normal), otgLoad(otgPointOf(w, before)->normal)) >=
              OTG_SOLID_MERGE_COSINE)) {
          continue;
        }
        stays = other == OTG_STAYS ? 0 : OTG_STAYS_OPEN;
      }
      if (stays == OTG_STAYS_OPEN) {
        ++open;
      } else {
        s->alive[i] = stays;
      }
    }
    otgPlaceAmong(OTG_COUNTS(s), open, &total);
    more = total > 0;
    OTG_SYNC;
  }
  otgKeepInOrder(s, count);
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
  }
  deepest = otgLargestOf(s->reduce, deepest);
  if (lane == 0) {
    if (count > 0) s->picked[0] = s->order[0];
    s->next[0] = OTG_NOT_THERE;
  }
  OTG_SYNC;
  uint round = 0;
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
    // The first that is not taken, then always the first behind it that is worth that much more: each looked for by all
    // lanes. A word is made ready for the next time while that of the last time may still be read.
    uint best = OTG_NOT_THERE;
    double more = 0;
    for (int goesOn = 1; goesOn; ++round) {
      if (lane == 0) s->next[(round + 1) % 3] = OTG_NOT_THERE;
      const uint from = best == OTG_NOT_THERE ? 0 : best + 1;
      for (uint j = from + (lane + OTG_GROUP - from % OTG_GROUP) % OTG_GROUP; j < all; j += OTG_GROUP) {
        const double worth = OTG_RANK(s)[j];
        if (best == OTG_NOT_THERE ? worth < 0 : !(worth > more)) continue;
        atomic_min(s->next + round % 3, j);
        break;
      }
      OTG_SYNC;
      const uint next = s->next[round % 3];
      goesOn = next != OTG_NOT_THERE;
      if (goesOn) {
        best = next;
        more = OTG_SOLID_FARTHER * OTG_RANK(s)[best];
      }
    }
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
  OTG_DEPTH(s)[c] = depth;
  otgPointOf(w, c)->shift = 0.5 * (out - back);
  return depth;
}
#endif

#if OTG_SOLID_LARGE
/// Where planes are gathered: of the candidates that estimates cannot tell apart the farthest in of either mesh are
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

/// Depths by rays, until two agree with their estimates and none has disagreed: then the others are believed. Gathered
/// planes are not believed, and all are measured before. What is shallow for its kind is dropped.
OTG_INLINED void otgMeasure(__local otg_solid_choice* s, const otg_solid_work* w, __global const float4* meshes,
                            OTG_MESH* a, OTG_MESH* b) {
  const uint lane = get_local_id(0), count = s->count;
  otgCastRays(s, w, w->isGathered ? 0 : count, meshes, a, b);
  if (lane == 0) {
    int agree = 0, disagree = 0;
    for (uint k = 0; k < count && !w->isGathered; ++k) {
      if (agree >= 2 && !disagree) break;
      const double estimate = OTG_DEPTH(s)[s->order[k]], depth = otgTakeDepth(s, w, k);
      if (fabs(estimate - depth) <= OTG_SOLID_AGREES * (estimate < depth ? depth : estimate)) {
        ++agree;
      } else {
        disagree = 1;
      }
    }
  }
  OTG_SYNC_ALL;
  double deepest = 0;
  for (uint k = lane; k < count; k += OTG_GROUP) deepest = otgMax_d(OTG_DEPTH(s)[s->order[k]], deepest);
  deepest = otgLargestOf(s->reduce, deepest);
  for (uint k = lane; k < count; k += OTG_GROUP) {
    const uint c = s->order[k];
    s->alive[c] = !(OTG_DEPTH(s)[c] < otgLeastOfKind_d((int)otgPointOf(w, c)->kind, deepest));
  }
  OTG_SYNC;
  otgKeepInOrder(s, count);
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
  for (uint item = lane; item < count * OTG_FACING_PARTS; item += OTG_GROUP) {
    __global const otg_solid_point* p = otgPointOf(w, s->order[item / OTG_FACING_PARTS]);
    const uint part = item % OTG_FACING_PARTS, step = (w->pieceCount + OTG_FACING_PARTS - 1) / OTG_FACING_PARTS;
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
    for (uint part = 0; part < OTG_FACING_PARTS; ++part) {
      const uint item = k * OTG_FACING_PARTS + part;
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
