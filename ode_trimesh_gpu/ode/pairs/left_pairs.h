// SPDX-License-Identifier: BSD-3-Clause
// Pairs of dTriMesh geoms that are left to ODE's own collider, because it holds more bodies there than we do.
#pragma once

#include <vector>

#include "collide/query.h"
#include "ode/geom/mesh_side.h"
#include "ode/pairs/pair_task.h"

namespace otg {

/// Whether all vertices lie in a plane, to a twentieth of the mesh's radius.
bool isFlat(const CollisionMesh& mesh);

/// The program's boxes have a margin (the preloaded library): flat meshes find each other.
void noteMargin() noexcept;

/// Of two dTriMesh geoms:
/// - flat ones, of which one lies along two axes of the world. ODE's boxes have no margin and that one's has no height:
///   such a pair is no longer reported once it is a hair too deep, and ODE rocks where we come to rest;
/// - one on a ground of loose slivers (needles), which has no side to stand on.
/// Says so once on stderr. Always false where ODE's collider cannot be reached.
bool isLeftToOde(const MeshGeom& side1, const MeshGeom& side2);

/// What ODE makes of such a pair, for a collider of ours that was handed it by dCollide().
int collideByOde(dGeomID o1, dGeomID o2, int flags, dContactGeom* contact, int skip);
/// The same for a prepared pair of an array, with its callers' triangles.
std::vector<Contact> contactsByOde(const PairTask& task, int most);

}  // namespace otg
