// SPDX-License-Identifier: BSD-3-Clause
// Which triangles of a mesh a shape touches, and a mesh of some of them: for programs that have a say about triangles.
#pragma once

#include <span>
#include <vector>

#include "primitives/convex_shape.h"
#include "primitives/plane_contacts.h"

namespace otg {

/// Triangles with a point in the half space; ascending. So are the other lists. Degenerate triangles are in none.
std::vector<std::uint32_t> trianglesTouching(const CollisionMesh& mesh, const PlaneGeom& plane);
/// Triangles with a point in the ball.
std::vector<std::uint32_t> trianglesTouching(const CollisionMesh& mesh, const Vec3d& center, double radius);
/// Triangles with a point in the shape, or in the facets around it if it is round. The pose takes the shape's points to
/// the mesh's frame. The workspace is scratch. Throws what collide() throws.
std::vector<std::uint32_t> trianglesTouching(const CollisionMesh& mesh, const ConvexShape& shape,
                                             const Transformd& shapeInMesh, Workspace& workspace);

/// A mesh of some triangles of another one: its triangle k is chosen[k]. May throw std::bad_alloc.
std::shared_ptr<const CollisionMesh> meshOfTriangles(const TriMesh& mesh, std::span<const std::uint32_t> chosen);

}  // namespace otg
