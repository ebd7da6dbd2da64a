// SPDX-License-Identifier: BSD-3-Clause
#include "opencl/results/take_records.h"

#include <algorithm>
#include <cstring>
#include <numeric>
#include <vector>

#include "collide/pairwise/contact_regions.h"
#include "collide/stages.h"

namespace otg::opencl {
namespace {

template <class Record>
Record recordAt(const Answer& answer, std::uint32_t i) {
  Record record{};
  std::memcpy(&record, answer.records + i * answer.recordSize, std::min(sizeof record, answer.recordSize));
  return record;
}

bool isContact(otg_int kind) {
  return kind == OTG_RECORD_FACE_A || kind == OTG_RECORD_FACE_B || kind == OTG_RECORD_COPLANAR;
}

struct Entry {
  TrianglePair pair;
  std::uint32_t record;
};

void takeContacts(const Query& query, const Answer& answer, const std::vector<Entry>& entries, Workspace& workspace) {
  workspace.contacts.clear();
  for (const Entry& entry : entries) {
    const auto r = recordAt<otg_contact_record>(answer, entry.record);
    Contact contact{};
    if (isContact(r.kind)) {
      contact = {{r.position[0], r.position[1], r.position[2]},
                 {r.normal[0], r.normal[1], r.normal[2]},
                 r.depth,
                 r.a,
                 r.b,
                 0,
                 featureOf(r.kind)};
    } else if (r.kind != OTG_RECORD_OPEN || !contactOfPair(query, entry.pair, contact)) {
      continue;
    }
    workspace.contacts.push_back(contact);
  }
  assignRegions(query, workspace);
  workspace.stats.contactsBeforeReduction = workspace.contacts.size();
}

/// The number of the pair that a record belongs to.
std::uint32_t pairOfRecord(const Answer& answer, std::uint32_t which) {
  return recordAt<otg_pair_record>(answer, which).pair;
}

}  // namespace

bool recordIntersects(const Query& query, const PairFrame& frame, const Answer& answer, std::uint32_t which) {
  const auto record = recordAt<otg_pair_record>(answer, which);
  CollideStats ignored;
  if (record.kind == OTG_RECORD_OPEN) return decidePair(query, frame, {record.a, record.b}, ignored);
  return record.kind != OTG_RECORD_APART;
}

RecordsByPair::RecordsByPair(const Answer& answer, std::size_t pairs) : from_(pairs + 1, 0), records_(answer.count) {
  for (std::uint32_t r = 0; r < answer.count; ++r) ++from_[pairOfRecord(answer, r) + 1];
  std::partial_sum(from_.begin(), from_.end(), from_.begin());
  std::vector<std::uint32_t> next(from_.begin(), from_.end() - 1);
  for (std::uint32_t r = 0; r < answer.count; ++r) records_[next[pairOfRecord(answer, r)]++] = r;
}

void takeCounts(const Answer& answer, CollideStats& stats) {
  stats.boxTests = answer.count64(OTG_COUNT_BOX_TESTS);
  stats.candidatePairs = answer.count64(OTG_COUNT_TRIANGLE_TESTS);
  stats.decidedByDouble = answer.counters[OTG_COUNT_UNDECIDED];
}

std::uint64_t takeRecords(const Query& query, const PairFrame& frame, const Answer& answer,
                          std::span<const std::uint32_t> which, bool contacts, Workspace& workspace) {
  std::vector<Entry> entries;
  entries.reserve(which.size());
  CollideStats byHost;
  for (const std::uint32_t i : which) {
    const auto record = recordAt<otg_pair_record>(answer, i);
    const TrianglePair pair{record.a, record.b};
    if (record.kind == OTG_RECORD_APART) continue;
    if (record.kind == OTG_RECORD_OPEN && !decidePair(query, frame, pair, byHost)) continue;
    entries.push_back({pair, i});
  }
  std::sort(entries.begin(), entries.end(), [](const Entry& x, const Entry& y) { return x.pair < y.pair; });
  workspace.candidates.clear();
  workspace.intersecting.clear();
  workspace.intersecting.reserve(entries.size());
  for (const Entry& entry : entries) workspace.intersecting.push_back(entry.pair);
  workspace.stats.intersectingPairs = entries.size();
  workspace.stats.decidedExactly = byHost.decidedExactly;
  if (contacts && answer.hasContacts()) takeContacts(query, answer, entries, workspace);
  return byHost.decidedExactly;
}

void collideFromRecords(const Query& query, const Answer& answer, std::span<const std::uint32_t> which,
                        Workspace& workspace) {
  const bool pairwise = isPairwise(query);
  workspace.stats = {};
  takeRecords(query, makePairFrame(query), answer, which, pairwise, workspace);
  if (pairwise && answer.hasContacts()) {
    reduceContacts(query, workspace);
  } else {
    collideIntersecting(query, workspace);
  }
  numberAsCaller(query, workspace);
}

}  // namespace otg::opencl
