// SPDX-License-Identifier: BSD-3-Clause
// Memory that looking ahead (look_ahead.h) keeps from one query to the next.
#pragma once

#include <memory>

#include "base/scratch_memory.h"
#include "collide/query.h"
#include "mesh/convex_geometry.h"

namespace otg {

struct AheadScratch {
  Workspace workspace;
  ScratchMemory memory;
  ConvexGeometry floor;  ///< FlatGround::makeBox()
};

inline AheadScratch& aheadOf(Workspace& workspace) {
  if (!workspace.ahead) workspace.ahead = std::make_unique<AheadScratch>();
  return *workspace.ahead;
}
/// A workspace that goes with this one, for queries of its pair after a translation.
inline Workspace& scratchAhead(Workspace& workspace) {
  return aheadOf(workspace).workspace;
}
/// Memory that nothing is in, until the next who requests it.
inline std::pmr::memory_resource* emptyMemory(Workspace& workspace) {
  aheadOf(workspace).memory.reset();
  return &aheadOf(workspace).memory;
}

}  // namespace otg
