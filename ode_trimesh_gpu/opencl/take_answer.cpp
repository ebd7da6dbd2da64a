// SPDX-License-Identifier: BSD-3-Clause
#include "opencl/take_answer.h"

#include <numeric>
#include <vector>

#include "opencl/take_records.h"

namespace otg::opencl {

void takeAll(const Query& query, const PairFrame& frame, const Answer& answer, bool contacts, Workspace& workspace) {
  std::vector<std::uint32_t> all(answer.count);
  std::iota(all.begin(), all.end(), 0u);
  workspace.stats = {};
  takeCounts(answer, workspace.stats);
  takeRecords(query, frame, answer, all, contacts, workspace);
}

void takeReduced(const PairAnswer& answer, Workspace& workspace) {
  workspace.candidates.clear();
  workspace.intersecting.clear();
  workspace.contacts.clear();
  workspace.reduced.assign(answer.contacts.begin(), answer.contacts.end());
  workspace.stats = {};
  takeCounts(answer.found, workspace.stats);
  workspace.stats.intersectingPairs = answer.found.counters[OTG_COUNT_INTERSECTING];
  workspace.stats.contactsBeforeReduction = answer.found.counters[OTG_COUNT_CONTACTS];
}

}  // namespace otg::opencl
