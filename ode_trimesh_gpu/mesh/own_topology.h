// SPDX-License-Identifier: BSD-3-Clause
// Meshes that touch themselves: what their own indices say of their surface, where positions would join too much.
#pragma once

#include <optional>

#include "mesh/topology.h"

namespace otg {

/// The topology of a mesh by its indices alone, each vertex a point of its own; `weld`: its weldByPosition(). Nothing
/// unless some vertices lie at the same place and the indices make a closed surface: each edge has two triangles that
/// go opposite ways along it. Nothing either where two triangles lie on each other and face the same way, or a triangle
/// has two corners at one place: then positions are right.
std::optional<Topology> ownTopology(std::span<const Vec3f> vertices, std::span<const Triangle> triangles,
                                    std::span<const std::uint32_t> weld);

}  // namespace otg
