// SPDX-License-Identifier: BSD-3-Clause
// What two meshes are to each other, and what their pair remembers from query to query.
#pragma once

#include "collide/query.h"

namespace otg {

/// Closed and oriented: it has an inside.
bool isSolid(const TriMesh& mesh);
/// A shell whose triangles agree in their winding and share edges by twos at most.
bool isSheet(const TriMesh& mesh);
/// Whether two meshes have contacts of the model `solid`, as long as their contour closes: two solids, or a solid with
/// a sheet.
bool haveSolidContacts(const TriMesh& a, const TriMesh& b);

/// Where B's middle lies in A's frame: relative motion is measured there.
Vec3d middleOfB(const Query& query, const Transformd& bInA);
/// The diameter of the smaller mesh.
double smallerSize(const Query& query);

/// What a query starts from: what the pair remembers, as far as it still holds.
SolidHistory::State stateBefore(const Query& query);
/// Leaves what the query found in query.history, if there is one.
void keepState(const Query& query, const SolidHistory::State& before, SolidHistory::State state);

}  // namespace otg
