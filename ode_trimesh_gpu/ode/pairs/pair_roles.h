// SPDX-License-Identifier: BSD-3-Clause
// Which of two meshes is A. The one place that decides it: frames, symbolic signs and numbers in ties follow from it.
#pragma once

#include "ode/geom/mesh_side.h"

namespace otg {

/// Whether the first of two geoms, both with a mesh, is A. It depends on the geometry alone, so that contacts do not
/// depend on which geom was created first: A has the smaller radius, as a body has beside its ground, or of the same
/// the more triangles, or at last the larger hash of its contents. Of two equal meshes A is the one with the smaller
/// coordinate along the world's axis on which they are farther apart, so that a pair that trembles stays as it is. A
/// pair that remembers something (`remembers`) stays as it was then.
bool isFirstMeshA(const MeshGeom& side1, const Transformd& pose1, const MeshGeom& side2, const Transformd& pose2,
                  bool remembers) noexcept;

}  // namespace otg
