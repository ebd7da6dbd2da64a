// SPDX-License-Identifier: BSD-3-Clause
// The exact answers, computed by CGAL. Its headers take long to compile, so they are seen by cgal_oracle.cpp alone.
#pragma once

#include <vector>

#include "collide/query.h"

namespace otg::test {

/// All pairs of triangles that have a point in common, ascending: A's float vertices and B's vertices as otgTransform
/// places them in double, as closed triangles. Those whose corners lie on a line, in their mesh or where they are
/// placed, are left out. Nothing is shared with the library beyond otgTransform: candidates and what is on a line are
/// CGAL's own.
std::vector<TrianglePair> cgalPairs(const TriMesh& a, const TriMesh& b, const Transformd& bInA);

/// Box of B placed by b -> R b + t, which is a parallelepiped when R is not quite orthonormal.
struct PlacedBoxes {
  Vec3d centerA, extentA, centerB, extentB;
  Transformd bInA;
};

/// Whether two closed boxes have a point in common, in rational arithmetic on the given numbers.
bool exactBoxesMeet(const PlacedBoxes& boxes);

}  // namespace otg::test
