// SPDX-License-Identifier: BSD-3-Clause
// The candidates of one region in the order in which they come into question, without those that are shallow or lie
// beside another one.
#ifndef OTG_SOLID_MERGE_H
#define OTG_SOLID_MERGE_H
#include "solid/choice.h"

/// Moves the first candidate in order that ranks highest to the front. All lanes call it.
OTG_INLINED void otgHighestToFront(__local otg_solid_choice* s, uint count, double highest) {
  const uint lane = get_local_id(0);
  if (lane == 0) s->next[0] = OTG_NOT_THERE;
  OTG_SYNC;
  for (uint j = lane; j < count; j += OTG_GROUP) {
    if (!(OTG_RANK(s)[s->order[j]] >= highest)) continue;
    atomic_min(s->next, j);
    break;
  }
  OTG_SYNC;
  const uint first = s->next[0];
  if (first == OTG_NOT_THERE || first == 0) return;  // all see the same
  const ushort taken = s->order[first];
  // Those before it go one place back, the last ones first.
  for (uint chunk = first / OTG_GROUP + 1; chunk-- > 0;) {
    const uint j = chunk * OTG_GROUP + lane;
    const int moves = j > 0 && j <= first;
    const ushort before = s->order[moves ? j - 1 : 0];
    OTG_SYNC;
    if (moves) s->order[j] = before;
    OTG_SYNC;
  }
  if (lane == 0) s->order[0] = taken;
  OTG_SYNC;
}

/// Whether the candidate at place j in order stays, as far as that is settled: OTG_STAYS, OTG_STAYS_OPEN or 0.
OTG_INLINED int otgSettle(__local const otg_solid_choice* s, const otg_solid_work* w, uint j, double reach) {
  const otg_vec3_d middle = otgVec_d(OTG_X(s)[j], OTG_Y(s)[j], OTG_Z(s)[j]);
  int stays = OTG_STAYS;
  // Those that lie near it are found 32 at a time, so that none of these reads waits for another one.
  for (uint from = 0; from < j && stays != 0; from += 32) {
    const uint here = min(j - from, 32u);
    uint near = 0;
    OTG_UNROLLED(4)
    for (uint k = 0; k < here; ++k) {
      const int isThere = s->step[from + k] != 0;  // unordered
      const otg_vec3_d d = otgSub_d(otgVec_d(OTG_X(s)[from + k], OTG_Y(s)[from + k], OTG_Z(s)[from + k]), middle);
      near |= (uint)((otgDot_d(d, d) <= reach * reach) & isThere) << k;
    }
    for (; near != 0 && stays != 0; near &= near - 1) {
      const uint k = from + otgLowestBit(near);
      const otg_vec3_d own = otgNormalOf(s, w, s->order[j]), other = otgNormalOf(s, w, s->order[k]);
      if (!(otgDot_d(own, other) >= OTG_SOLID_MERGE_COSINE)) continue;
      stays = s->step[k] == OTG_STAYS ? 0 : OTG_STAYS_OPEN;  // unordered
    }
  }
  return stays;
}

/// The steps by which candidates are ranked, and the features by which ties are settled. All lanes call it.
OTG_INLINED void otgStepCandidates(__local otg_solid_choice* s, const otg_solid_work* w, double highest,
                                   __local ulong* orders) {
  const uint lane = get_local_id(0), all = w->candidates;
  for (uint i = lane; i < all; i += OTG_GROUP) {
    s->step[i] = s->alive[i] ? otgRankStep_d(OTG_RANK(s)[i], highest) : INT_MAX;
    orders[i] = s->alive[i] ? otgPointOf(w, i)->order : 0;
  }
  OTG_SYNC;
}

/// Drops what is shallow for its kind, then of points that lie together and agree in direction all but the first.
/// s->order gets the others, s->count of them.
OTG_INLINED void otgFilterAndMerge(__local otg_solid_choice* s, const otg_solid_work* w) {
  const uint lane = get_local_id(0);
  uint count = 0, total;
  otgDropShallow(s, w, 0.5);  // half the fractions: estimates err
  double highest = 0;
  for (uint i = lane; i < w->candidates; i += OTG_GROUP) {
    if (s->alive[i]) highest = otgMax_d(OTG_RANK(s)[i], highest);
  }
  highest = otgLargestOf(s->reduce, highest);
  if (lane == 0) s->highest = highest;
  // The features by which ties are settled lie where spread comes later.
  __local ulong* orders = (__local ulong*)OTG_SPREAD(s);
  otgStepCandidates(s, w, highest, orders);
  for (uint base = 0; base < w->candidates; base += OTG_GROUP) {
    const uint i = base + lane;
    const int isAlive = i < w->candidates && s->alive[i];
    if (isAlive) {
      const int step = s->step[i];
      const ulong order = orders[i];
      uint place = 0;
      OTG_UNROLLED(4)
      for (uint j = 0; j < w->candidates; ++j) {
        const int other = s->step[j];
        place += (uint)((other < step) | ((other == step) & (orders[j] < order)));
      }
      s->order[place] = (ushort)i;
    }
    otgPlaceAmong(OTG_COUNTS(s), isAlive, &total);
    count += total;
  }
  OTG_SYNC;
  // Where the bodies are round the deepest is one point, and it is the first; where they are flat many tremble about
  // it.
  if (!w->isFlat) otgHighestToFront(s, count, highest);
  // From here on by place in order: middles in place of the points, which are not needed any more, and who stays in
  // place of the steps.
  for (uint j = lane; j < count; j += OTG_GROUP) {
    const uint c = s->order[j];
    const otg_vec3_d middle = otgMiddleOf(otgPointOf(w, c));
#ifdef OTG_RAYS_KNOWN
    const otg_vec3_d normal = otgLoad(otgPointOf(w, c)->normal);
    s->normals[c] = normal.x;
    s->normals[OTG_SOLID_POINTS + c] = normal.y;
    s->normals[2 * OTG_SOLID_POINTS + c] = normal.z;
#endif
    OTG_X(s)[j] = middle.x;
    OTG_Y(s)[j] = middle.y;
    OTG_Z(s)[j] = middle.z;
    s->step[j] = OTG_STAYS_OPEN;
  }
  OTG_SYNC;
  // Whether one stays is settled once it is for all before it that lie near it: in rounds, of which few are needed.
  const double reach = OTG_SOLID_MERGE_DISTANCE * w->diagonal;
  for (int more = count > 0; more;) {
    uint open = 0;
    for (uint j = lane; j < count; j += OTG_GROUP) {
      if (s->step[j] != OTG_STAYS_OPEN) continue;
      const int stays = otgSettle(s, w, j, reach);
      open += stays == OTG_STAYS_OPEN;
      s->step[j] = stays;
    }
    otgPlaceAmong(OTG_COUNTS(s), open, &total);
    more = total > 0;
    OTG_SYNC;
  }
  for (uint j = lane; j < count; j += OTG_GROUP) s->alive[s->order[j]] = s->step[j] != 0;
  OTG_SYNC;
  otgKeepInOrder(s, count);
}

#endif  // OTG_SOLID_MERGE_H
