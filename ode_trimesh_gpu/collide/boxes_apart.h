// SPDX-License-Identifier: BSD-3-Clause
// Whether two meshes cannot meet, by their bounds alone.
#pragma once

#include "collide/query.h"

namespace otg {

/// Whether the bounding balls of two meshes are apart by more than rounding, or their boxes along an axis of either. A
/// box lies along the axes of its own mesh. Then nothing of them meets, and neither lies inside the other. False says
/// nothing. `defect`: no less than rotationDefect() of the pose.
bool areBoxesApart(const TriMesh& a, const TriMesh& b, const Transformd& bInA, double defect);

/// Whether a query is about nothing: its boxes are apart, and apart is all that there is to say. Of shells, where
/// `solid` looks at what is near and on which side it is, there is more.
bool meetsNothing(const Query& query);

}  // namespace otg
