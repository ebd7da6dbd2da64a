// SPDX-License-Identifier: BSD-3-Clause
// Pairs of a space that do not meet. These are most of them, so they are sorted out before anything is made for them.
#pragma once

#include "ode/pairs/pair_task.h"

namespace otg {

/// What two geoms at these poses are to each other, by their bounds alone.
enum class Nearness : std::uint8_t {
  kMayMeet,  ///< or their poses are no good, or they are no plain pair of meshes: preparePair() finds out
  kFar,      ///< PairTask::State::kNothing
  kApart     ///< likewise, and what is remembered of the pair ends
};

/// The meshes are taken, and the geoms in use. May set poses.areNear.
Nearness nearnessOf(const MeshGeom& side1, const MeshGeom& side2, PairPoses& poses);

/// A pair that is kApart has been queried.
void endApart(const MeshGeom& side1, const MeshGeom& side2);

}  // namespace otg
