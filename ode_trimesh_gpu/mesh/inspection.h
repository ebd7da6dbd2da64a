// SPDX-License-Identifier: BSD-3-Clause
// The checks of triangles and vertices behind a ValidationReport, one by one.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "mesh/topology.h"

namespace otg {

/// One flag for each triangle: all three vertices on a line. That is the case if two are at equal positions, or if the
/// height over the longest edge is at most 4 u m, where u = 2^-24 is the rounding unit of float and m the largest
/// coordinate (by magnitude) of the three vertices relative to `center`, the origin of the centred frame. A triangle
/// whose vertices were on a line before each of their centred coordinates was rounded to float has a height of at most
/// 2 sqrt(3) u m: it is caught, and a triangle that is reported has no plane that its float coordinates could tell.
std::vector<std::uint8_t> findDegenerate(std::span<const Vec3f> vertices, std::span<const Triangle> triangles,
                                         const Vec3f& center);

/// The same for one triangle; `center` as above.
bool isDegenerateTriangle(std::span<const Vec3f> vertices, const Triangle& triangle, const Vec3f& center);

/// One flag for each triangle: an earlier one has the same three points, in any order.
std::vector<std::uint8_t> findDuplicates(const Topology& topology, std::span<const Triangle> triangles);

/// One flag for each vertex: it is the welded representative of a point where more than one fan of triangles meets. A
/// fan is a set of triangles around the point that hang together through edges at it, however many triangles use those.
std::vector<std::uint8_t> findNonManifoldVertices(const Topology& topology, std::span<const Triangle> triangles);

}  // namespace otg
