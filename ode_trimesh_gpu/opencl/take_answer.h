// SPDX-License-Identifier: BSD-3-Clause
// From the answer of a lane to a workspace.
#pragma once

#include "opencl/pair_lane.h"

namespace otg::opencl {

/// takeRecords for an answer to one query.
void takeAll(const Query& query, const PairFrame& frame, const Answer& answer, bool contacts, Workspace& workspace);

/// Contacts that the device has reduced.
void takeReduced(const PairAnswer& answer, Workspace& workspace);

}  // namespace otg::opencl
