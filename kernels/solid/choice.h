// SPDX-License-Identifier: BSD-3-Clause
// What a work-group knows of the candidates of one region while it chooses among them. See solid/choose.h for what is
// defined before.
#ifndef OTG_SOLID_CHOICE_H
#define OTG_SOLID_CHOICE_H
#ifndef OTG_WARP
#define OTG_WARP 0  ///< as in contact_choose.h
#endif
#include "solid/region.h"

#define OTG_SOLID_MOST_CONTACTS (OTG_SOLID_REGIONS * OTG_SOLID_CONTACTS)
#if OTG_SOLID_LARGE
#define OTG_SOLID_MEASURED (OTG_SOLID_MEASURED_PER_CONTACT * OTG_SOLID_CONTACTS)
#define OTG_FACING_PARTS 4
#else
#define OTG_SOLID_MEASURED OTG_SOLID_CONTACTS
#define OTG_FACING_PARTS 2
#endif

// The same memory for what is never needed at the same time. By candidate: depth, rank, distance from those chosen,
// place. Up to twice as many points have two heights each in place of all but depth and z: see otgAddDeepestPass.
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
#ifdef OTG_RAYS_KNOWN
  double normals[3 * OTG_SOLID_POINTS];  ///< by candidate
#endif
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

/// Of a candidate that is alive.
OTG_INLINED otg_vec3_d otgNormalOf(__local const otg_solid_choice* s, const otg_solid_work* w, uint c) {
#ifdef OTG_RAYS_KNOWN
  return otgVec_d(s->normals[c], s->normals[OTG_SOLID_POINTS + c], s->normals[2 * OTG_SOLID_POINTS + c]);
#else
  return otgLoad(otgPointOf(w, c)->normal);
#endif
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

/// Of an uneven region the largest depth of those of `count` candidates that push the same way as candidate c: an
/// overlap may be far deeper in one wall than in another. `order`: the candidates; null: all that are alive. By one
/// lane.
OTG_INLINED double otgDeepestAlong(__local const otg_solid_choice* s, const otg_solid_work* w, uint c,
                                   __local const ushort* order, uint count) {
  const otg_vec3_d normal = otgLoad(otgPointOf(w, c)->normal);
  double most = 0;
  for (uint j = 0; j < count; ++j) {
    const uint i = order != 0 ? order[j] : j;
    if (!s->alive[i] || !(OTG_DEPTH(s)[i] > most)) continue;
    if (otgDot_d(otgLoad(otgPointOf(w, i)->normal), normal) >= OTG_SOLID_MERGE_COSINE) most = OTG_DEPTH(s)[i];
  }
  return most;
}

/// Drops what is shallow for its kind beside the deepest times `share`. All lanes call it.
OTG_INLINED void otgDropShallow(__local otg_solid_choice* s, const otg_solid_work* w, double share) {
  const double deepest = otgDeepest(s, w);
  for (uint i = get_local_id(0); i < w->candidates; i += OTG_GROUP) {
    const double most = w->isUneven && s->alive[i] ? otgDeepestAlong(s, w, i, 0, w->candidates) : deepest;
    s->step[i] = s->alive[i] && !(OTG_DEPTH(s)[i] < otgLeastOfKind_d((int)otgPointOf(w, i)->kind, share * most));
  }
  OTG_SYNC;
  for (uint i = get_local_id(0); i < w->candidates; i += OTG_GROUP) s->alive[i] = (uchar)s->step[i];
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

#endif  // OTG_SOLID_CHOICE_H
