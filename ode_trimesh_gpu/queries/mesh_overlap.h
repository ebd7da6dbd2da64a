// SPDX-License-Identifier: BSD-3-Clause
// Whether two meshes have a point in common.
#pragma once

#include "collide/query.h"

namespace otg {

/// Whether any two triangles intersect, exactly (see nearPhase), or a part of one mesh lies wholly inside the other if
/// that is a solid. Ends once that is known. Of the query only a, b and bInA are read. Throws as middlePhase does.
bool overlap(const Query& query);

/// The first pair of triangles that is found to intersect. False if there is none.
bool findMeeting(const Query& query, TrianglePair& meeting);

/// One vertex of a connected part of mesh A that lies inside solid B, or of B inside A, in A's frame: for meshes whose
/// triangles do not intersect. False if there is none.
bool containedVertex(const Query& query, Vec3d& vertex);

}  // namespace otg
