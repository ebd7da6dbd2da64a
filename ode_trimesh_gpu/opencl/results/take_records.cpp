// SPDX-License-Identifier: BSD-3-Clause
#include "opencl/results/take_records.h"

#include <algorithm>
#include <cstring>
#include <utility>
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

/// A counting sort by parts of the records, each with counts of its own.
RecordsByPair::RecordsByPair(const Answer& answer, std::size_t pairs, const RunParts* threads)
    : from_(pairs + 1, 0), records_(answer.count) {
  constexpr std::size_t kMostParts = 64, kRecords = 1 << 15;  // of a part, at least
  const std::size_t parts = threads ? std::clamp<std::size_t>(answer.count / kRecords, 1, kMostParts) : 1;
  std::vector<std::uint32_t> next(parts * pairs, 0);  // by part and pair: how many, then the place of the next
  const auto everyPart = [&](const auto& work) {
    const auto some = [&](std::size_t begin, std::size_t end) {
      for (std::size_t part = begin; part < end; ++part) {
        const std::size_t first = answer.count * part / parts, last = answer.count * (part + 1) / parts;
        for (std::size_t r = first; r < last; ++r) {
          const auto record = static_cast<std::uint32_t>(r);
          work(next[part * pairs + pairOfRecord(answer, record)], record);
        }
      }
    };
    if (parts > 1) {
      (*threads)(parts, some);
    } else {
      some(0, 1);
    }
  };
  everyPart([](std::uint32_t& count, std::uint32_t) { ++count; });
  std::uint32_t place = 0;
  for (std::size_t pair = 0; pair < pairs; ++pair) {
    from_[pair] = place;
    for (std::size_t part = 0; part < parts; ++part) place += std::exchange(next[part * pairs + pair], place);
  }
  from_[pairs] = place;
  everyPart([&](std::uint32_t& at, std::uint32_t record) { records_[at++] = record; });
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
