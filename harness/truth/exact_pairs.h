// SPDX-License-Identifier: BSD-3-Clause
// Which triangles of two soups meet, in exact arithmetic: by CGAL, and by a search of separating axes that needs
// nothing but integers. Neither shares anything with the library's own tests.
#pragma once

#include <array>
#include <vector>

#include "collide/traversal.h"
#include "mesh/tri_mesh.h"

namespace otg::truth {

/// Corners, taken as exact: in the mesh's own frame, and where otgTransform() puts them in double.
struct ExactTriangle {
  std::array<Vec3d, 3> own, placed;
};

std::vector<ExactTriangle> exactTriangles(const TriMesh& mesh);  ///< of A, which stays where it is
std::vector<ExactTriangle> exactTriangles(const TriMesh& mesh, const Transformd& pose);

/// All pairs of closed triangles that have a point in common, ascending. A triangle meets nothing whose corners lie on
/// a line, in its own frame or where it is placed: far away, rounding may take the last of its area, or give it some.
std::vector<TrianglePair> pairsBySeparation(const std::vector<ExactTriangle>& a, const std::vector<ExactTriangle>& b);

/// The same by CGAL's exact predicates; std::logic_error where the program was built without it.
std::vector<TrianglePair> pairsByCgal(const std::vector<ExactTriangle>& a, const std::vector<ExactTriangle>& b);
bool isBuiltWithCgal();

}  // namespace otg::truth
