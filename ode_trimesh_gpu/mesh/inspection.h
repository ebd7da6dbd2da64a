// SPDX-License-Identifier: BSD-3-Clause
// The checks of triangles and vertices behind a ValidationReport, one by one.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "mesh/topology.h"

namespace otg {

/// One flag for each triangle: all three vertices on a line, in exact arithmetic on their coordinates. No triangle that
/// has area is flagged, however thin it is and wherever it lies.
std::vector<std::uint8_t> findDegenerate(std::span<const Vec3f> vertices, std::span<const Triangle> triangles);

/// The same for one triangle.
bool isDegenerateTriangle(std::span<const Vec3f> vertices, const Triangle& triangle);

/// One flag for each triangle: an earlier one has the same three points, in any order.
std::vector<std::uint8_t> findDuplicates(const Topology& topology, std::span<const Triangle> triangles);

/// One flag for each vertex: it is the welded representative of a point where more than one fan of triangles meets. A
/// fan is a set of triangles around the point that hang together through edges at it, however many triangles use those.
std::vector<std::uint8_t> findNonManifoldVertices(const Topology& topology, std::span<const Triangle> triangles);

}  // namespace otg
