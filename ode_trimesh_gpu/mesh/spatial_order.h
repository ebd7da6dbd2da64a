// SPDX-License-Identifier: BSD-3-Clause
// Numbering triangles and vertices along a space-filling curve, so that what lies together in space lies together in
// memory. Inside the mesh layer only.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "mesh/topology.h"

namespace otg {

/// Triangles along the Morton curve of their centres (G. M. Morton, "A computer oriented geodetic data base", IBM
/// 1966), ties by number; vertices in the order in which those triangles use them, unused ones last. Entry i is the old
/// number of what gets number i.
struct SpatialOrder {
  std::vector<std::uint32_t> triangles, vertices;
};
SpatialOrder findSpatialOrder(std::span<const Vec3f> vertices, std::span<const Triangle> triangles);

/// The inverse of a permutation.
std::vector<std::uint32_t> inverseOf(std::span<const std::uint32_t> order);

/// What buildTopology would say of the renumbered mesh.
Topology renumber(const Topology& topology, const SpatialOrder& order);

}  // namespace otg
