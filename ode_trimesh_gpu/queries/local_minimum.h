// SPDX-License-Identifier: BSD-3-Clause
// Where the distance of a surface from a point outside of it is least among the surface's own neighbourhood.
#pragma once

#include "queries/closest_point.h"

namespace otg {

/// Of a point on an edge, given by one of its half-edges: whether no triangle of the edge comes nearer to a centre than
/// the point does, which is the edge's nearest one to it. `toCenter` leads from the point to the centre. Distances that
/// differ by less than `rounding` are equal: a distance d falls along a triangle that rises towards the centre by the
/// sine s by s^2 d / 2.
bool isMinimumOfEdge(const CollisionMesh& mesh, std::uint32_t halfEdge, const Vec3d& point, const Vec3d& toCenter,
                     double rounding);

/// The same of a vertex (welded) and all of its triangles.
bool isMinimumOfVertex(const CollisionMesh& mesh, std::uint32_t vertex, const Vec3d& toCenter, double rounding);

/// The same of the nearest point of a triangle, whatever it lies on.
bool isMinimum(const CollisionMesh& mesh, const SurfacePoint& point, const Vec3d& center, double rounding);

}  // namespace otg
