// SPDX-License-Identifier: BSD-3-Clause
// From contacts to the few that the caller requested: regions, bins, the limit, with tables in global memory. For one
// pair of meshes, or for those pairs of a batch that have too many hits for batch_reduce.cl: a hit knows its pair.
//
// OTG_GROUP: size of work-groups, 64 at least. OTG_KEPT as in contact_choose.h. OTG_CONTACTS is 1. OTG_SINGLE: 1
// for one pair (chooseContacts is the last kernel), 0 for a batch.
#include "pairwise/contact_choose.h"
#include "pairwise/contact_finish.h"
#include "shared/layout/pairwise_given.h"

/// Room for contacts of one pair that may be the best of their bins: some are found not to be.
#define OTG_MAYBE (4 * OTG_KEPT)

/// Fifteen lanes to a hit unite it with its neighbours, and one enters its contact into the table of bins: those come
/// first, side by side, because they have much more to do.
__kernel __attribute__((reqd_work_group_size(OTG_GROUP, 1, 1))) void uniteContacts(OTG_GIVEN(UniteContacts)) {
  otg_links l = otgLinksOf(counters, records, links, tables, tableSize, capacity);
  const size_t count = min(counters[OTG_COUNT_HITS], capacity);
#if OTG_SINGLE
  const otg_reduction first = reductions[0];
  l.bins = otgBinsOf(&first, tableSize);
#endif
  for (size_t t = get_global_id(0); t < 16 * count; t += get_global_size(0)) {
    const int bins = t < count;
    const uint hit = (uint)(bins ? t : (t - count) / 15), share = bins ? 0 : 1 + (uint)((t - count) % 15);
    const int kind = l.records[hit].kind;
    const uint pair = l.records[hit].pair;
    if (!otgIntersects(kind) || (results[OTG_FLAGS + pair] & OTG_PAIR_LEFT_OUT)) continue;
    __global const otg_pair_state* state = states + pair;
    if (!bins) {
      __global const uint *ringsA = (__global const uint*)(meshes + state->ringsA),
                          *ringsB = (__global const uint*)(meshes + state->ringsB);
      const uint2 own = otgTrianglesOf(l.records + hit);
      const uint edgeA = share / 4, edgeB = share % 4;
      OTG_FOR_NEIGHBOURS(ringsA, ringsB, own, edgeA, edgeB, otgUniteWithHit(&l, hit, pair, other));
    } else if (otgIsContact(kind)) {
      const otg_reduction how = reductions[state->reduction];
      if (how.method == OTG_REDUCE_BINNING) otgEnterBin(&l, state, &how, hit, pair);
    }
  }
}

/// Lists the contacts that may stay (OTG_MAYBE places a pair) and the regions that have contacts (OTG_KEPT). Empties
/// the tables that are not needed any more.
__kernel __attribute__((reqd_work_group_size(OTG_GROUP, 1, 1))) void selectContacts(OTG_GIVEN(SelectContacts)) {
  const otg_links l = otgLinksOf(counters, records, links, tables, tableSize, capacity);
  const uint count = min(counters[OTG_COUNT_HITS], capacity);
  otgEmptyTables(l.pairTable, l.binTable, l.mask, get_global_id(0), get_global_size(0));
  for (uint hit = get_global_id(0); hit < count; hit += get_global_size(0)) {
    const uint pair = l.records[hit].pair;
    const int kind = l.records[hit].kind;
    if (!otgIntersects(kind) || (results[OTG_FLAGS + pair] & OTG_PAIR_LEFT_OUT)) continue;
    __global otg_pair_state* state = states + pair;
    const uint root = otgFind(&l, hit);
    otgBidForFirst(&l, hit, root);
    if (!otgIsContact(kind)) continue;
    volatile __global uint* mark = otgLink(&l, OTG_LINK_MARK, root);
    if (*mark == 0 && atomic_xchg(mark, 1) == 0) {
      const uint place = atomic_inc(&state->roots);
      if (place < OTG_KEPT) roots[(size_t)pair * OTG_KEPT + place] = root;
    }
    const otg_reduction how = reductions[state->reduction];
    if (how.method == OTG_REDUCE_BINNING && !otgMayBeBest(&l, state, &how, hit)) continue;
    const uint place = atomic_inc(&state->kept);
    if (place < OTG_MAYBE) kept[(size_t)pair * OTG_MAYBE + place] = hit;
  }
}

/// Enters the contacts that stay, of those in `kept`, with the numbers of their regions. Returns how many; more than
/// OTG_KEPT are not entered.
inline static uint otgEnterKept(const otg_links* l, __global const uint* kept, uint count, int binned,
                                __global const uint* roots, uint regions, __local otg_choice* c,
                                __local uint* entered) {
  const uint lane = get_local_id(0);
  if (lane == 0) *entered = 0;
  for (uint i = lane; i < regions; i += OTG_GROUP) c->ids[i] = otgRegionOf(l, roots[i]);
  barrier(CLK_LOCAL_MEM_FENCE);
  for (uint i = lane; i < count; i += OTG_GROUP) {
    const uint hit = kept[i];
    if (binned && l->binBest[*otgLink(l, OTG_LINK_BIN_SLOT, hit)] != hit + 1) continue;
    const ulong mine = otgRegionOf(l, otgFind(l, hit));
    uint region = 0;
    for (uint j = 0; j < regions; ++j) region += c->ids[j] < mine;
    const uint place = atomic_inc(entered);
    if (place >= OTG_KEPT) continue;
    c->hit[place] = hit;
    c->region[place] = region;
  }
  barrier(CLK_LOCAL_MEM_FENCE);
  const uint all = *entered;
  for (uint i = lane; i < all && all <= OTG_KEPT; i += OTG_GROUP) {
    otgEnterChoice(c, i, l->records, c->hit[i], c->region[i]);
  }
  barrier(CLK_LOCAL_MEM_FENCE);
  return all;
}

/// Work-group g chooses for pair g. `results` and `answer`: the head, the pairs' flags, places and counts, contacts.
/// They may be the same; what the host reads of a single pair goes to `answer`, which may be host memory, and of
/// a batch to `results`. What does not fit into the lists is left to the CPU.
__kernel __attribute__((reqd_work_group_size(OTG_GROUP, 1, 1))) void chooseContacts(OTG_GIVEN(ChooseContacts)) {
  __local otg_choice choice;
  __local uint entered;
  const uint lane = get_local_id(0), pair = get_group_id(0), pairs = get_num_groups(0);
  const otg_links l = otgLinksOf(counters, records, links, tables, tableSize, capacity);
  const uint flags = results[OTG_FLAGS + pair];
  __global const otg_pair_state* state = states + pair;
  const otg_reduction how = reductions[state->reduction];
  const int leftOut = (flags & OTG_PAIR_LEFT_OUT) != 0, unlisted = state->kept > OTG_MAYBE || state->roots > OTG_KEPT;
  const int works = !leftOut && !unlisted;
  const uint regions = works ? state->roots : 0;
  const uint all =
      otgEnterKept(&l, kept + (size_t)pair * OTG_MAYBE, works ? state->kept : 0, how.method == OTG_REDUCE_BINNING,
                   roots + (size_t)pair * OTG_KEPT, regions, &choice, &entered);
  const int tooMany = !leftOut && (unlisted || all > OTG_KEPT);
  const uint count = otgChoose(l.records, tooMany ? 0 : all, tooMany ? 0 : regions, how.places, &choice);
  if (lane == 0) {
    answer[OTG_FLAGS + pair] = flags | (tooMany ? OTG_PAIR_TO_HOST : 0);  // unordered: all lanes have read it
    answer[OTG_PLACE(pairs, pair)] = 0;
    answer[OTG_PLACE(pairs, pair) + 1] = count;
    if (leftOut || tooMany) {
      if (!OTG_SINGLE && !(flags & OTG_PAIR_SKIPPED)) atomic_inc(counters + OTG_COUNT_FLAGGED);
    } else if (state->intersecting) {
      atomic_add(counters + OTG_COUNT_INTERSECTING, state->intersecting);
      atomic_add(counters + OTG_COUNT_CONTACTS, state->contacts);
      atomic_add(counters + OTG_COUNT_REDUCED, count);
    }
  }
#if OTG_SINGLE
  otgWriteChoice(&choice, count, l.records, meshes, state->ringsA, state->ringsB,
                 (__global otg_chosen_contact*)((__global uchar*)answer + OTG_RESULT_CONTACTS(1)));
  // Every bin that was used has one of these. Those that did not fit into the list are not known.
  for (uint i = lane; i < state->kept && !unlisted; i += OTG_GROUP) {
    const uint slot = *otgLink(&l, OTG_LINK_BIN_SLOT, kept[i]);
    if (how.method == OTG_REDUCE_BINNING) l.binScore[slot] = l.binBest[slot] = 0;
  }
  const uint bins = unlisted ? otgBinsOf(&how, tableSize) : 0;
  otgEmptyTables(l.binScore, l.binBest, unlisted ? max(l.mask, bins ? (bins - 1) | 3 : 0) : 0, lane, OTG_GROUP);
  otgFinishPair(counters, answer, 1);
#else
  for (uint k = lane; k < count; k += OTG_GROUP) {
    const uint i = choice.ranks.order[choice.ranks.rank[k]];
    chosen[(size_t)pair * chosenRoom + k] = (uint2)(choice.hit[i], choice.region[i]);
  }
#endif
}

#if !OTG_SINGLE

/// Counts to places, by one work-group.
__kernel __attribute__((reqd_work_group_size(OTG_GROUP, 1, 1))) void placeContacts(OTG_GIVEN(PlaceContacts)) {
  __local uint sums[OTG_GROUP];
  const uint lane = get_local_id(0), stretch = (pairs + OTG_GROUP - 1) / OTG_GROUP;
  const uint from = min(pairs, lane * stretch), to = min(pairs, from + stretch);
  uint sum = 0;
  for (uint i = from; i < to; ++i) sum += results[OTG_PLACE(pairs, i) + 1];
  sums[lane] = sum;
  barrier(CLK_LOCAL_MEM_FENCE);
  sum = 0;
  for (uint i = 0; i < lane; ++i) sum += sums[i];
  for (uint i = from; i < to; ++i) {
    results[OTG_PLACE(pairs, i)] = sum;
    sum += results[OTG_PLACE(pairs, i) + 1];
  }
}

/// One lane for each place that a pair may fill. The last kernel: see otgFinish.
__kernel __attribute__((reqd_work_group_size(OTG_GROUP, 1, 1))) void writeContacts(OTG_GIVEN(WriteContacts)) {
  __local uint last;
  const otg_links l = otgLinksOf(counters, records, links, tables, tableSize, capacity);
  __global otg_chosen_contact* out =
      (__global otg_chosen_contact*)((__global uchar*)results + OTG_RESULT_CONTACTS(pairs));
  otgEmptyTables(l.binScore, l.binBest, l.mask, get_global_id(0), get_global_size(0));
  for (size_t t = get_global_id(0); t < (size_t)pairs * chosenRoom; t += get_global_size(0)) {
    const uint pair = (uint)(t / chosenRoom), k = (uint)(t % chosenRoom);
    const uint place = results[OTG_PLACE(pairs, pair)] + k;
    if (k >= results[OTG_PLACE(pairs, pair) + 1] || place >= contactRoom) continue;
    otgWriteContact(l.records + chosen[t].x, chosen[t].y, meshes, states[pair].ringsA, states[pair].ringsB,
                    out + place);
  }
  otgFinish(counters, (__global uchar*)results, &last);
}

#endif
