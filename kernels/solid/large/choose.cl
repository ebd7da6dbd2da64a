// SPDX-License-Identifier: BSD-3-Clause
// From candidates to the contacts of large regions: one work-group for each, and one more that hands the description's
// head and the hits of small regions on. As the second half of collide/solid/region_contacts.cpp.
//
// OTG_GROUP: size of work-groups, a power of two.
#define OTG_SOLID_POINTS OTG_WORK_CANDIDATES
#define OTG_SOLID_CONTACTS 64
#define OTG_SOLID_LARGE 1
#define OTG_RAYS_KNOWN
#include "solid/large/direction.h"
//
#include "solid/choose.h"

/// The head of one pair: the description's, what regions came to that are not made here, and the hits of small ones.
/// The last of all pairs gives the sums. All lanes call it.
OTG_INLINED void otgHandOn(__global const otg_overlap_task* tasks, __global const uchar* out, uint pair,
                           __global uchar* results, __global otg_found_inside* small, uint smallRoom,
                           __global otg_overlap_progress* progress, __local uint* first) {
  const uint lane = get_local_id(0), pairs = tasks->pairs;
  __global otg_contacts_head* head = (__global otg_contacts_head*)(results + OTG_CONTACTS_HEADS(0)) + pair;
  const otg_found_lists l = otgListsFor(out, tasks, pair * OTG_OVERLAP_REGIONS);
  __global const uint* from = (__global const uint*)l.head;
  __global uint* to = (__global uint*)&head->state;
  for (uint i = lane; i < sizeof(otg_overlap_state) / 4; i += OTG_GROUP) to[i] = from[i];
  for (uint r = lane; r < OTG_OVERLAP_REGIONS; r += OTG_GROUP) {
    otg_found_lists own = l;
    own.region = r;
    if (otgIsLargeRegion(&own)) continue;
    head->regions[r].status = 0;
    head->regions[r].count = 0;
    head->regions[r].first = 0;
  }
  const uint count = l.works ? l.head->counts[OTG_OVERLAP_SMALL] : 0;
  if (lane == 0) *first = atomic_add(&progress->small, count);
  OTG_SYNC;
  const int fits = *first <= smallRoom && smallRoom - *first >= count;
  for (uint i = lane; i < (fits ? count : 0); i += OTG_GROUP) small[*first + i] = l.small[i];
  if (lane != 0) return;
  head->small = fits ? count : 0;
  head->firstSmall = fits ? *first : 0;
  mem_fence(CLK_GLOBAL_MEM_FENCE);
  if (atomic_inc(&progress->done) != pairs - 1) return;
  __global otg_contacts_sums* sums = (__global otg_contacts_sums*)results;
  sums->totals = *(__global const otg_overlap_totals*)out;
  sums->progress.arenaUnits = atomic_xchg(&progress->arenaUnits, 0);
  sums->progress.slots = atomic_xchg(&progress->slots, 0);
  sums->progress.small = atomic_xchg(&progress->small, 0);
  sums->progress.done = atomic_xchg(&progress->done, 0);
}

/// `out`: the description; `results`: see otg_contacts_sums. A work-group for each of the slots, then one for each
/// pair. `stride`: places for the contacts of a region.
__kernel __attribute__((reqd_work_group_size(OTG_GROUP, 1, 1))) void overlapChoose(
    __global const otg_overlap_task* restrict tasks, __global const uchar* restrict out, __global uchar* arena,
    uint turns, uint slots, uint stride, uint smallRoom, __global otg_overlap_progress* restrict progress,
    __global uchar* restrict results) {
  __local otg_solid_choice choice;
  __local int isWorked;
  __local uint first;
  const uint slot = get_group_id(0), lane = get_local_id(0);
  __global uchar* body = results + OTG_CONTACTS_HEADS(tasks->pairs);
  __global otg_chosen_contact* contacts = (__global otg_chosen_contact*)body;
  if (slot >= slots) {
    __global otg_found_inside* small = (__global otg_found_inside*)(contacts + (size_t)slots * stride);
    otgHandOn(tasks, out, slot - slots, results, small, smallRoom, progress, &first);
    return;
  }
  __global otg_region_work* r = otgRegionAt(arena, slot);
  const uint place = r->place;
  if (place == OTG_NOT_THERE) return;
  __global const otg_overlap_task* task = tasks + place / OTG_OVERLAP_REGIONS;
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
        otgMeasureGathered(&choice, &w, task->most, 0, 0, 0);
        otgSpreadCandidates(&choice, &w, task->most);
        otgMeasure(&choice, &w, 0, 0, 0, 0);
        otgEmit(&choice, &w, 0, contacts + (size_t)slot * stride);
        count = choice.count;
        status |= OTG_FOUND_DONE;
      }
    }
  } else if (status & OTG_FOUND_COUNTS) {
    status |= OTG_FOUND_BAD | (r->pointFlags & OTG_REGION_UNEVEN ? OTG_FOUND_APART : 0);
  }
  if (lane == 0) {
    __global otg_contacts_head* head =
        (__global otg_contacts_head*)(results + OTG_CONTACTS_HEADS(0)) + place / OTG_OVERLAP_REGIONS;
    __global otg_found_contacts* f = head->regions + place % OTG_OVERLAP_REGIONS;
    f->status = status;
    f->count = count;
    f->first = slot * stride;
    for (uint k = 0; k < 3; ++k) f->direction[k] = r->direction[k];
  }
}
