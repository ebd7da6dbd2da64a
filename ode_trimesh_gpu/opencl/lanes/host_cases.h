// SPDX-License-Identifier: BSD-3-Clause
// Queries that no device gets, or not all of.
#pragma once

#include <cmath>

#include "collide/convex/convex_pair_contacts.h"
#include "collide/pair_frame.h"
#include "collide/pair_history.h"
#include "collide/query.h"
#include "collide/rotation_tolerance.h"
#include "collide/shell/shell_roles.h"
#include "collide/solid/solid_contacts.h"
#include "collide/stages.h"
#include "collide/surface/surface_contacts.h"

namespace otg::opencl {

/// Whether the query is one that otg::collide refuses by an exception.
inline bool isRefused(const Query& query) {
  const Vec3d& t = query.bInA.t;
  return !std::isfinite(t.x) || !std::isfinite(t.y) || !std::isfinite(t.z) ||
         !(rotationDefect(query.bInA) <= kRelativeRotationTolerance);
}

/// Whether there is nothing that a device could do: the CPU knows the result.
inline bool isIdleQuery(const Query& query, const PairFrame& frame) {
  return query.a->tree().nodes.empty() || query.b->tree().nodes.empty() || !frame.finite;
}

/// Whether the CPU makes the contacts, of triangles that a device may have found.
inline bool areContactsOfHost(const Query& query) {
  return mayBeShells(query) || (!isPairwise(query) && (haveParts(query) || stateBefore(query).isJammed));
}

/// Whether a batch leaves all of the pair to the CPU. Pairs on a surface are not looked at before: most are quick
/// there.
inline bool isForHost(const Query& query) {
  return areContactsOfHost(query) || isConvexPair(query) || isSurfacePair(query);
}

/// Whether isForHost() may be true of pairs with the mesh and one that is not convex.
inline bool mayBeForHost(const CollisionMesh* mesh) {
  return mesh->mesh().meshClass() != MeshClass::kSolid || mesh->parts() != nullptr || mayBeFlatGround(*mesh);
}

}  // namespace otg::opencl
