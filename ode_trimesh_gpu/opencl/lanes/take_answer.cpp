// SPDX-License-Identifier: BSD-3-Clause
#include "opencl/lanes/take_answer.h"

#include <algorithm>
#include <numeric>
#include <vector>

#include "collide/pairwise/reduction.h"
#include "collide/solid/look_ahead.h"
#include "collide/solid/solid_contacts.h"
#include "collide/stages.h"
#include "opencl/results/take_records.h"

namespace otg::opencl {

std::uint64_t takeAll(const Query& query, const PairFrame& frame, const Answer& answer, bool contacts,
                      Workspace& workspace) {
  std::vector<std::uint32_t> all(answer.count);
  std::iota(all.begin(), all.end(), 0u);
  workspace.stats = {};
  takeCounts(answer, workspace.stats);
  const std::uint64_t byHost = takeRecords(query, frame, answer, all, contacts, workspace);
  workspace.stats.decidedExactly = std::max<std::uint64_t>(byHost, answer.counters[OTG_COUNT_OPEN]);
  return byHost;
}

namespace {

void takeReduced(const PairAnswer& answer, Workspace& workspace) {
  workspace.candidates.clear();
  workspace.intersecting.clear();
  workspace.contacts.clear();
  workspace.reduced.assign(answer.contacts.begin(), answer.contacts.end());
  workspace.stats = {};
  takeCounts(answer.found, workspace.stats);
  workspace.stats.intersectingPairs = answer.found.counters[OTG_COUNT_INTERSECTING];
  workspace.stats.contactsBeforeReduction = answer.found.counters[OTG_COUNT_CONTACTS];
  workspace.stats.decidedExactly = answer.found.counters[OTG_COUNT_OPEN];
}

}  // namespace

namespace {

template <class Found>
bool takeSolid(const Query& query, const otg_overlap_state& head, const Found& found, Workspace& workspace) {
  workspace.candidates.clear();
  workspace.intersecting.clear();
  workspace.stats = {};
  workspace.stats.intersectingPairs = head.counts[OTG_OVERLAP_INTERSECTING];
  if (!solidContactsOf(query, found, workspace)) return false;
  if (mayMeetAhead(query)) lookAhead(query, workspace);
  finishPair(query, workspace);
  numberAsCaller(query, workspace);
  return true;
}

}  // namespace

bool takeDescribed(const Query& query, const FoundOverlap& overlap, Workspace& workspace) {
  return takeSolid(query, *overlap.head, overlap, workspace);
}

bool takeMade(const Query& query, const FoundContacts& found, Workspace& workspace) {
  return takeSolid(query, found.head->state, found, workspace);
}

void addAhead(const Query& query, std::span<const Contact> contacts, Workspace& workspace) {
  workspace.clear();
  workspace.stats = {};
  for (Contact c : contacts) {
    c.triangleA = query.a->mesh().triangleOfCaller(c.triangleA);
    c.triangleB = query.b->mesh().triangleOfCaller(c.triangleB);
    workspace.contacts.push_back(c);
  }
  lookAhead(query, workspace);
  finishPair(query, workspace);
  numberAsCaller(query, workspace);
}

Taken takeAnswer(const Query& query, const PairFrame& frame, const PairAnswer& answer, bool contacts,
                 Workspace& workspace) {
  if (answer.reduced) {
    takeReduced(answer, workspace);
    return {};
  }
  const std::uint64_t decided = takeAll(query, frame, answer.found, contacts, workspace);
  return {contacts && answer.found.hasContacts() ? HostRest::kReduction : HostRest::kContacts, decided};
}

void finishAnswer(const Query& query, HostRest rest, Workspace& workspace) {
  if (rest == HostRest::kNothing) return;
  if (rest == HostRest::kReduction) {
    reduceContacts(query, workspace);
  } else {
    collideIntersecting(query, workspace);
  }
  numberAsCaller(query, workspace);
}

}  // namespace otg::opencl
