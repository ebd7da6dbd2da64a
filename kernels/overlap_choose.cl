// SPDX-License-Identifier: BSD-3-Clause
// From candidates to the contacts of large regions: one work-group for each, and one more that hands the description's
// head and the hits of small regions on. As the second half of collide/solid/region_contacts.cpp.
//
// OTG_GROUP: size of work-groups, a power of two.
#define OTG_SOLID_POINTS OTG_WORK_CANDIDATES
#define OTG_SOLID_CONTACTS 64
#define OTG_SOLID_LARGE 1
#define OTG_RAYS_KNOWN
#include "overlap_direction.h"
//
#include "solid_choose.h"

/// `out`: the description; `results`: head, contacts, hits of small regions. `regions`: places for regions.
__kernel __attribute__((reqd_work_group_size(OTG_GROUP, 1, 1))) void overlapChoose(
    __global const otg_overlap_task* restrict tasks, __global const uchar* restrict out, __global uchar* arena,
    uint turns, uint regions, __global otg_overlap_progress* restrict progress, __global uchar* restrict results) {
  __local otg_solid_choice choice;
  __local int isWorked;
  const uint slot = get_group_id(0), lane = get_local_id(0), most = tasks->most;
  __global otg_contacts_head* head = (__global otg_contacts_head*)results;
  __global otg_chosen_contact* contacts = (__global otg_chosen_contact*)(head + 1);
  if (slot == regions) {
    const otg_found_lists l = otgListsFor(out, tasks, 0);
    __global const uint* from = (__global const uint*)out;  // the totals and the state
    __global uint* to = (__global uint*)results;
    for (uint i = lane; i < OTG_OVERLAP_HEAD(1) / 4; i += OTG_GROUP) to[i] = from[i];
    __global otg_found_inside* small = (__global otg_found_inside*)(contacts + (size_t)regions * most);
    for (uint i = lane; i < (l.works ? l.head->counts[OTG_OVERLAP_SMALL] : 0); i += OTG_GROUP) small[i] = l.small[i];
    if (lane == 0) {
      head->progress = *progress;
      progress->arenaUnits = 0;
    }
    return;
  }
  __global otg_region_work* r = otgRegionAt(arena, slot);
  __global const otg_overlap_task* task = tasks + slot / OTG_OVERLAP_REGIONS;
  uint status = r->status, count = 0;
  if (otgIsWorked(r, &isWorked)) {
    const otg_solid_work w = otgWorkOf(arena, slot);
    if (!turns && otgSeeks(r, task) && !otgIsThin(&w)) {
      status |= OTG_FOUND_TURNS;
    } else {
      if (lane == 0) {
        choice.bad = 0;
        choice.contacts = 0;
      }
      otgTakeEstimates(&choice, &w);
      otgFilterAndMerge(&choice, &w);
      if (choice.count == 0) {
        status |= OTG_FOUND_BAD;
      } else {
        otgMeasureGathered(&choice, &w, most, 0, 0, 0);
        otgSpreadCandidates(&choice, &w, most);
        otgMeasure(&choice, &w, 0, 0, 0);
        otgEmit(&choice, &w, 0, contacts + (size_t)slot * most);
        count = choice.count;
        status |= OTG_FOUND_DONE;
      }
    }
  } else if (status & OTG_FOUND_COUNTS) {
    status |= OTG_FOUND_BAD;
  }
  if (lane == 0) {
    __global otg_found_contacts* f = head->regions + slot;
    f->status = status;
    f->count = count;
    for (uint k = 0; k < 3; ++k) f->direction[k] = r->direction[k];
  }
}
