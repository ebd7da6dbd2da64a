// SPDX-License-Identifier: BSD-3-Clause
// The near phase after the published traversal: pairs of leaves with one triangle each.
//
// OTG_GROUP: work-items of a work-group. OTG_LEAF is 1. OTG_CONTACTS as in pair_record.h. OTG_FUSED: 1 as published,
// one kernel that tests and makes the contact; 0 to list hits, of which pairResults makes contacts. OTG_ENTER: 1 if
// contacts are reduced on the device.
#define OTG_SINGLE 1
#include "pairwise/contact_links.h"
#include "shared/layout/published_given.h"
#include "walk/pair_state.h"

#define OTG_LEVELS_KERNEL __kernel __attribute__((reqd_work_group_size(OTG_GROUP, 1, 1)))

/// The beginning of the near phase, for one work-item: what pairCut does for the traversal that is used.
OTG_LEVELS_KERNEL void levelsReset(OTG_GIVEN(LevelsReset)) {
  if (get_global_id(0) != 0) return;
  otgResetState(state, 0, &pair.a, &pair.b);
  chosen[OTG_FLAGS] = otgFirstFlags(&pair.a, &pair.b, method);
}

#if OTG_FUSED
/// The float filter, the decision in double of what it leaves open, and the contact.
OTG_LEVELS_KERNEL void levelsNear(OTG_GIVEN(LevelsNearFused)) {
  const uint i = get_global_id(0);
  __global otg_record* records = (__global otg_record*)(results + OTG_RESULT_HEAD);
  if (i >= count) return;
  const uint2 places = leaves[i];
  const int answer = otgTestTriangles(meshes, &pair, places.x, places.y);
  if (answer == OTG_DISJOINT) return;
  const uint slot = otgTakeHit(counters, answer);
  if (slot >= hitCapacity) return;
  otgMakeRecord(meshes, pair.a.soup + 3 * places.x, pair.b.soup + 3 * places.y, answer == OTG_UNDECIDED, bInA, 0,
                records + slot);
}

/// After levelsNear, which cannot know how large the tables have to be: what pairResults does after making a record.
OTG_LEVELS_KERNEL void levelsEnter(
#if OTG_ENTER
    OTG_GIVEN(LevelsEnter)
#else
    OTG_GIVEN(LevelsEnd)
#endif
) {
#if OTG_ENTER
  __local otg_tally tally;
  const uint count = min(counters[OTG_COUNT_HITS], hitCapacity);
  const otg_links l = otgLinksOf(counters, results, links, tables, tableSize, hitCapacity);
  otgBeginTally(&tally);
  for (uint i = get_global_id(0); i < count; i += get_global_size(0)) {
    otgEnterHit(&l, state, chosen + OTG_FLAGS, i, OTG_PAIR_TO_HOST, &tally);
  }
  otgEndTally(state, &tally);
#else
  __local uint last;
  otgFinish(counters, results, &last);
#endif
}
#else
/// The float filter alone: places of triangles that intersect or that it leaves open.
OTG_LEVELS_KERNEL void levelsNear(OTG_GIVEN(LevelsNear)) {
  const uint i = get_global_id(0);
  if (i >= count) return;
  const uint2 places = leaves[i];
  const int answer = otgTestTriangles(meshes, &pair, places.x, places.y);
  if (answer == OTG_DISJOINT) return;
  const uint slot = otgTakeHit(counters, answer);
  if (slot >= hitCapacity) return;
  hits[slot] = (uint2)(places.x | (answer == OTG_UNDECIDED ? OTG_HIT_UNDECIDED : 0), places.y);
}
#endif
