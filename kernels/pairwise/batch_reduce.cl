// SPDX-License-Identifier: BSD-3-Clause
// From records to contacts, one work-group to a pair: for pairs with at most OTG_KEPT hits, which most pairs of a batch
// are. Those that have more go the way of contact_reduce.cl. OTG_GROUP: size of work-groups. OTG_STAYS: 1 where those
// without a pair go through all barriers (staysOption).
#define OTG_SINGLE 0
#include "pairwise/contact_group.h"
#include "shared/layout/pairwise_given.h"

/// Work-group g takes pair g or, with `listed`, the g-th of `list`: of those with `least` to OTG_KEPT hits, and with
/// the flag `only`, if that is not 0. Writes their records and contacts; a pair's contacts lie side by side at the
/// place that `chosen` says. With `last` this is the last kernel.
__kernel __attribute__((reqd_work_group_size(OTG_GROUP, 1, 1))) void batchReduce(OTG_GIVEN(BatchReduce)) {
  __local otg_group_links g;
  __local uint place, isLast;
  const uint lane = get_local_id(0);
  const uint number = listed ? (get_group_id(0) < counters[OTG_COUNT_LISTED] ? list[get_group_id(0)] : OTG_NOT_THERE)
                             : (uint)get_group_id(0);
  const uint pair = number != OTG_NOT_THERE ? number : 0;
  const uint flags = chosen[OTG_FLAGS + pair];  // unordered: needed before the barrier, written behind it
  const uint found = states[pair].hits, begin = states[pair].firstHit;
  const int isAsked =
      only == 0 ? !(flags & (OTG_PAIR_REFUSED | OTG_PAIR_SKIPPED)) : (flags & (only | OTG_PAIR_LEFT_OUT)) == only;
  const int isMine =
      number != OTG_NOT_THERE && isAsked && found >= least && found <= OTG_KEPT && begin + found <= hitCapacity;
  const uint count = isMine ? found : 0;
  __global const otg_contact_record* records = (__global const otg_contact_record*)(results + OTG_RESULT_HEAD) + begin;
  const uint ringsA = states[pair].ringsA, ringsB = states[pair].ringsB;
  const int works = OTG_STAYS || count > 0 || (isMine && (flags & OTG_PAIR_TO_HOST));
  if (works) {
    otg_lane_tally tally = otgNoTally();
    otgBeginGroup(&g, count);
    barrier(CLK_LOCAL_MEM_FENCE);
    for (uint i = lane; i < count; i += OTG_GROUP) otgGroupHit(&g, i, records + i, &tally);
    otgGather(&g, &tally);
    barrier(CLK_LOCAL_MEM_FENCE);
    const int toHost = isMine && (g.open || (flags & OTG_PAIR_TO_HOST));
    const uint some = toHost ? 0 : count;
    const otg_reduction how = reductions[isMine ? states[pair].reduction : 0];
    const uint stay = otgGroupContacts(&g, records, some, meshes, ringsA, ringsB, &how);
    if (lane == 0) {
      place = 0;
      if (toHost) {
        chosen[OTG_FLAGS + pair] = flags | OTG_PAIR_TO_HOST;
        atomic_inc(counters + OTG_COUNT_FLAGGED);
      } else if (some > 0 && g.intersecting > 0) {
        atomic_add(counters + OTG_COUNT_INTERSECTING, g.intersecting);
        atomic_add(counters + OTG_COUNT_CONTACTS, g.contacts);
        place = atomic_add(counters + OTG_COUNT_REDUCED, stay);
      }
      if (isMine) {
        chosen[OTG_PLACE(pairCount, pair)] = place;
        chosen[OTG_PLACE(pairCount, pair) + 1] = stay;
      }
    }
    barrier(CLK_LOCAL_MEM_FENCE);
    __global otg_chosen_contact* out =
        (__global otg_chosen_contact*)((__global uchar*)chosen + OTG_RESULT_CONTACTS(pairCount)) + place;
    otgWriteChoice(&g.choice, place + stay <= contactRoom ? stay : 0, records, meshes, ringsA, ringsB, out);
  }
  if (last) otgFinish(counters, (__global uchar*)chosen, &isLast);
}
