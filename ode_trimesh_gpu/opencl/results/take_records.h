// SPDX-License-Identifier: BSD-3-Clause
// From the records that a device wrote to the stages of a workspace.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "collide/pair_frame.h"
#include "collide/query.h"
#include "opencl/results/result_buffer.h"
#include "opencl/run_parts.h"

namespace otg::opencl {

/// The records `which` of the result, all of one query, to workspace.intersecting and, if they hold contacts and
/// `contacts`, to workspace.contacts with their regions. The CPU decides what the device left open. The order of
/// records, which depends on how work-groups were scheduled, leaves no trace. Sets the counts of these two stages in
/// workspace.stats. Returns how many pairs of triangles the CPU decided in exact arithmetic.
std::uint64_t takeRecords(const Query& query, const PairFrame& frame, const Answer& answer,
                          std::span<const std::uint32_t> which, bool contacts, Workspace& workspace);

/// Whether the record says that its pair intersects.
bool recordIntersects(const Query& query, const PairFrame& frame, const Answer& answer, std::uint32_t which);

/// The records of a result by the pairs of a batch to which they belong, ascending.
class RecordsByPair {
 public:
  /// By `threads`, if there are any.
  RecordsByPair(const Answer& answer, std::size_t pairs, const RunParts* threads);
  std::span<const std::uint32_t> of(std::size_t pair) const {
    return std::span(records_).subspan(from_[pair], from_[pair + 1] - from_[pair]);
  }

 private:
  std::vector<std::uint32_t> from_, records_;
};

/// The records of a piece of a batch, which stay in the memory of its lane.
struct PieceRecords {
  PieceRecords(const Answer& records, std::size_t pairs, const RunParts* threads)
      : answer(records), byPair(records, pairs, threads) {}
  Answer answer;
  RecordsByPair byPair;
};

/// The counts of the device to statistics.
void takeCounts(const Answer& answer, CollideStats& stats);

/// What the CPU does of a pair of a batch that the device leaves to it: its contacts, as otg::collide leaves them.
void collideFromRecords(const Query& query, const Answer& answer, std::span<const std::uint32_t> which,
                        Workspace& workspace);

}  // namespace otg::opencl
