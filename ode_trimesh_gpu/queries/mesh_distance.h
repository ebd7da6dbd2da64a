// SPDX-License-Identifier: BSD-3-Clause
// How far two meshes are apart, and where.
#pragma once

#include "collide/query.h"
#include "collide/traversal.h"

namespace otg {

struct MeshDistance {
  bool found = false;        ///< false: a mesh has no triangles, or nothing is within the limit
  double distance = 0;       ///< 0: they overlap, and pointA equals pointB
  Vec3d pointA{}, pointB{};  ///< nearest points of the surfaces, frame A; of overlapping meshes a point in both
  std::uint32_t triangleA = kNone, triangleB = kNone;  ///< kNone where a point lies inside a solid
};

/// Branch and bound over both trees. Lower bounds of a distance are the gaps of boxes: along the axes of either box
/// together, along the line of their centres, and along that of the nearest points so far. Of triangles that are
/// equally near the smallest numbers, A's first: the result is that of every tree. Overlap is decided exactly first
/// (mesh_overlap.h). Of the query only a, b and bInA are read. Nothing farther than `limit` is looked for. Throws as
/// middlePhase does.
MeshDistance meshDistance(const Query& query, double limit);

/// The parts of it, for poses that are rotations and meshes with triangles. Whether a part of one mesh lies inside the
/// other one, where no triangles meet; if so, the result.
bool contains(const Query& query, MeshDistance& answer);
/// The search alone, for meshes that do not overlap.
MeshDistance distanceApart(const Query& query, double limit);
/// What that says of the nearest triangles when it has found them; kNone for none.
MeshDistance distanceOfTriangles(const Query& query, const TrianglePair& nearest);

}  // namespace otg
