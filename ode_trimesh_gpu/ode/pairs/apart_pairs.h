// SPDX-License-Identifier: BSD-3-Clause
// Pairs of a space that do not meet. These are most of them, so they are sorted out before anything is made for them.
#pragma once

#include "ode/pairs/pair_task.h"

namespace otg {

/// Whether a query of two geoms at these poses has no contacts and changes nothing, by their bounds alone. False says
/// nothing: preparePair() finds out. The meshes are taken, and the geoms in use. May set poses.areNear.
bool comesToNothing(const MeshGeom& side1, const MeshGeom& side2, PairPoses& poses);

}  // namespace otg
