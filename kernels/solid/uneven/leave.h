// SPDX-License-Identifier: BSD-3-Clause
// Which of its ways each part of an uneven region leaves by, so that one short translation does it for all: as leavesOf
// in collide/solid/leaving.cpp. All lanes call these functions, where nothing else is said.
#ifndef OTG_UNEVEN_LEAVE_H
#define OTG_UNEVEN_LEAVE_H
#include "solid/uneven/scratch.h"

OTG_INLINED int otgIsOutBy(__global const otg_uneven_way* way, otg_vec3_d t) {
  return otgIsOut_d(otgLoad(way->normal), way->depth, t);
}

/// Whether a translation satisfies all the ways that hold a part together. For one lane.
OTG_INLINED int otgIsHeldTogether(__local const otg_uneven_scratch* s, const otg_uneven* u, uint part, otg_vec3_d t) {
  for (uint k = 0; k < s->together[part]; ++k) {
    if (!otgIsOutBy(u->ways + s->first[part] + k, t)) return 0;
  }
  return 1;
}

/// Whether it satisfies these, or one of the others. For one lane.
OTG_INLINED int otgIsHeld(__local const otg_uneven_scratch* s, const otg_uneven* u, uint part, otg_vec3_d t) {
  if (otgIsHeldTogether(s, u, part, t)) return 1;
  for (uint k = s->together[part]; k < s->count[part]; ++k) {
    if (otgIsOutBy(u->ways + s->first[part] + k, t)) return 1;
  }
  return 0;
}

/// The parts that have to leave, the deepest first.
OTG_INLINED void otgOrderParts(__local otg_uneven_scratch* s) {
  uint leaving = 0, total;
  for (uint base = 0; base < s->parts; base += OTG_GROUP) {
    const uint i = base + get_local_id(0);
    const int leaves = i < s->parts && s->count[i] > 0;
    if (leaves) {
      const double soonest = s->soonest[i];
      uint place = 0;
      for (uint j = 0; j < s->parts; ++j) {
        const double other = s->soonest[j];
        place += (uint)((s->count[j] > 0) & ((other > soonest) | ((other == soonest) & (j < i))));
      }
      s->ordered[place] = (ushort)i;
    }
    otgPlaceAmong(OTG_COUNTS(s), leaves, &total);
    leaving += total;
  }
  if (get_local_id(0) == 0) s->leaving = leaving;
  OTG_SYNC;
}

/// Has the translation satisfy one more half-space: whether one of that length can. For one lane.
OTG_INLINED int otgAddHalfSpace(__local otg_uneven_scratch* s, __global const otg_uneven_way* way, double longest) {
  const otg_vec3_d normal = otgLoad(way->normal);
  const double depth = way->depth;
  otg_vec3_d t = otgVec_d(s->out[0], s->out[1], s->out[2]);
  if (s->spaceCount == OTG_UNEVEN_HALF_SPACES) {
    s->bad = 1;
    return 0;
  }
  if (!otgIsOut_d(normal, depth, t)) {
    if (!otgShortestOnBoundary_d(s->spaces, s->spaceCount, normal, depth, &t)) return 0;
    if (otgDot_d(t, t) > longest * longest) return 0;
  }
  s->spaces[s->spaceCount].normal = normal;
  s->spaces[s->spaceCount++].depth = depth;
  s->out[0] = t.x;
  s->out[1] = t.y;
  s->out[2] = t.z;
  return 1;
}

/// Has it satisfy a part: all of the ways that hold it together, or the one of the others that takes least. For one
/// lane.
OTG_INLINED void otgAddPart(__local otg_uneven_scratch* s, const otg_uneven* u, uint part) {
  __global const otg_uneven_way* ways = u->ways + s->first[part];
  const otg_vec3_d t = otgVec_d(s->out[0], s->out[1], s->out[2]);
  const uint count = s->count[part], together = s->together[part];
  double most = 0, least = INFINITY;
  uint soonest = OTG_NOT_THERE;
  for (uint k = 0; k < count; ++k) {
    const double missing = ways[k].depth - otgDot_d(otgLoad(ways[k].normal), t);
    if (k < together) {
      most = otgMax_d(missing, most);
    } else if (soonest == OTG_NOT_THERE || missing < least ||
               (missing == least && ways[k].depth < ways[soonest].depth)) {
      soonest = k;
      least = missing;
    }
  }
  const double longest = OTG_UNEVEN_LONGEST * s->soonest[s->ordered[0]];
  if (soonest != OTG_NOT_THERE && least < most && otgAddHalfSpace(s, ways + soonest, longest)) return;
  for (uint k = 0; k < together; ++k) otgAddHalfSpace(s, ways + k, longest);
}

/// The shortest translation that satisfies one part after the other.
OTG_INLINED void otgFindTranslation(__local otg_uneven_scratch* s, const otg_uneven* u) {
  const uint lane = get_local_id(0), leaving = s->leaving;
  OTG_SYNC;
  if (lane == 0) {
    for (uint k = 0; k < 3; ++k) s->out[k] = 0;
    s->spaceCount = 0;
  }
  for (uint begin = 0; begin < leaving;) {
    OTG_SYNC;
    if (lane == 0) s->next = leaving;
    OTG_SYNC;
    // The next one that is not held yet: each lane looks as far as its first.
    const otg_vec3_d t = otgVec_d(s->out[0], s->out[1], s->out[2]);
    for (uint k = begin + lane; k < leaving; k += OTG_GROUP) {
      if (otgIsHeld(s, u, s->ordered[k], t)) continue;
      atomic_min(&s->next, k);
      break;
    }
    OTG_SYNC;
    const uint next = s->next;
    if (lane == 0 && next < leaving) otgAddPart(s, u, s->ordered[next]);
    begin = next + 1;
  }
  OTG_SYNC;
}

/// How many candidates a part is that has to leave. For one lane.
OTG_INLINED uint otgTakenWays(__local const otg_uneven_scratch* s, uint part) {
  return s->taken[part] == s->count[part] ? s->together[part] : 1;
}

/// By which way each part leaves: the soonest of its ways that the translation satisfies. How many candidates they are.
OTG_INLINED uint otgTakeWays(__local otg_uneven_scratch* s, const otg_uneven* u) {
  const otg_vec3_d t = otgVec_d(s->out[0], s->out[1], s->out[2]);
  uint candidates = 0, total;
  for (uint base = 0; base < s->parts; base += OTG_GROUP) {
    const uint i = base + get_local_id(0);
    const int leaves = i < s->parts && s->count[i] > 0;
    if (leaves) {
      __global const otg_uneven_way* ways = u->ways + s->first[i];
      uint taken = s->count[i];
      for (uint k = otgIsHeldTogether(s, u, i, t) ? taken : s->together[i]; k < s->count[i]; ++k) {
        if (otgIsOutBy(ways + k, t) && (taken == s->count[i] || ways[k].depth < ways[taken].depth)) taken = k;
      }
      s->taken[i] = (ushort)taken;
    }
    otgPlaceAmong(OTG_COUNTS(s), leaves ? otgTakenWays(s, i) : 0, &total);
    candidates += total;
  }
  OTG_SYNC;
  return candidates;
}

#endif  // OTG_UNEVEN_LEAVE_H
