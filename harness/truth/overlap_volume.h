// SPDX-License-Identifier: BSD-3-Clause
// The overlap of two closed meshes measured without any of the library's collision code: what contacts are judged by.
#pragma once

#include "mesh/tri_mesh.h"

namespace otg::truth {

/// Volume of the intersection of two solids and where its middle is, in A's frame.
struct Overlap {
  double volume = 0;
  Vec3d centroid{0, 0, 0};  ///< the origin when the volume is 0
};

/// Both meshes must be closed and oriented outward; they need not be convex. Nested components count as their
/// orientation says.
///
/// Source of method: a solid's characteristic function is the signed sum over its triangles of "lies below that
/// triangle". So the volume of the intersection is a signed sum over pairs of triangles. A term integrates the lower of
/// the two heights over the common part of their projections, a convex polygon of at most six corners. The sum is
/// continuous in the coordinates: no predicates, no special positions. In long double.
Overlap overlapOf(const TriMesh& a, const TriMesh& b, const Transformd& bInA);

/// How the volume falls when A moves: what an elastic overlap would push it with.
struct VolumeGradient {
  Overlap overlap;
  Vec3d push;    ///< -dV / d(translation of A), units squared: the mean outward normal times area
  Vec3d moment;  ///< -dV / d(rotation of A about the centroid), units cubed per radian
};

/// Central differences of overlapOf's sum with steps of `step` times the smaller mesh's radius.
VolumeGradient volumeGradient(const TriMesh& a, const TriMesh& b, const Transformd& bInA, double step = 1e-7);

}  // namespace otg::truth
