// SPDX-License-Identifier: BSD-3-Clause
// Memory that looking ahead (look_ahead.h) keeps from one query to the next.
#pragma once

#include "base/scratch_memory.h"
#include "collide/query.h"

namespace otg {

struct AheadScratch {
  Workspace workspace;
  ScratchMemory memory;
};

}  // namespace otg
