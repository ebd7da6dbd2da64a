// SPDX-License-Identifier: BSD-3-Clause
// From the result of a lane to a workspace.
#pragma once

#include <span>

#include "opencl/lanes/pair_lane.h"

namespace otg::opencl {

/// takeRecords for the result of one query.
std::uint64_t takeAll(const Query& query, const PairFrame& frame, const Answer& answer, bool contacts,
                      Workspace& workspace);

/// What the CPU still has to do when it has a result.
enum class HostRest {
  kNothing,    ///< the device has reduced the contacts
  kReduction,  ///< it has made them
  kContacts    ///< it has found the triangles that intersect
};

/// What the device found, into the workspace; and how many pairs of triangles the CPU decided in exact arithmetic.
struct Taken {
  HostRest rest = HostRest::kNothing;
  std::uint64_t decidedExactly = 0;
};
Taken takeAnswer(const Query& query, const PairFrame& frame, const PairAnswer& answer, bool contacts,
                 Workspace& workspace);

/// The contacts of a pair from what is known of its overlap. False where the CPU sees it in another way.
bool takeDescribed(const Query& query, const FoundOverlap& overlap, Workspace& workspace);

/// The same where the device has made those of the large regions. False where it left some of them to the CPU.
bool takeMade(const Query& query, const FoundContacts& found, Workspace& workspace);

/// Adds to all contacts of a pair, as the caller numbers triangles, what lookAhead() finds: workspace.reduced.
void addAhead(const Query& query, std::span<const Contact> contacts, Workspace& workspace);

/// Does the rest.
void finishAnswer(const Query& query, HostRest rest, Workspace& workspace);

}  // namespace otg::opencl
