// SPDX-License-Identifier: BSD-3-Clause
// Surfaces that touch each other along edges: as floors of flush blocks, or two blocks with one edge in common.
#pragma once

#include <optional>
#include <vector>

#include "mesh/topology.h"

namespace otg {

/// A mesh's vertices after those at which surfaces touch have been taken apart.
struct SeparateSurfaces {
  std::vector<Triangle> triangles;      ///< the given ones, with other vertices
  std::vector<std::uint32_t> vertexOf;  ///< of each vertex the given one; the given ones come first, each as itself
  std::vector<std::uint32_t> weld;      ///< as Topology::weld: the smallest vertex at the same point of a surface
  std::vector<std::uint32_t> twin;      ///< as Topology::twin
};

/// Where an edge has more than two triangles, solid and empty wedges alternate round it. The two triangles at the sides
/// of one solid wedge are neighbours. Then each point of a surface has a vertex of its own, and each half-edge a
/// neighbour. One surface may touch itself along an edge, too: then two edges have the same ends. `topology`: by
/// positions.
///
/// Angles are compared exactly. Triangles that lie on each other, to the rounding of coordinates, have no order: in
/// air a wedge begins there and ends, in a body one ends and the next begins.
///
/// Nothing where no edge has more than two triangles, or where one has fewer or two that go the same way along it.
/// Nothing either where wedges overlap, as with two triangles that lie on each other and face the same way.
std::optional<SeparateSurfaces> separateSurfaces(std::span<const Vec3f> vertices, std::span<const Triangle> triangles,
                                                 const Topology& topology);

}  // namespace otg
