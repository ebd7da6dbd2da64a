// SPDX-License-Identifier: BSD-3-Clause
// Candidates for contacts, worked out.
#pragma once

#include "collide/solid/contour.h"
#include "collide/solid/region_cells.h"

namespace otg {

/// The candidate with what its surroundings in its mesh say of it.
SupportPoint supportPoint(const PlacedMeshes& meshes, const Contour& contour, const PointSeed& seed);
/// The same with the other mesh's triangle of a crossing.
SupportPoint supportPoint(const PlacedMeshes& meshes, const PointSeed& seed, std::uint32_t triangle);

/// What a contact there is made from.
ContactFeature featureOf(const SupportPoint& point);

/// SupportPoint::rank of a welded vertex.
std::uint32_t rankOfVertex(const PlacedMeshes& meshes, int mesh, std::uint32_t vertex);

}  // namespace otg
