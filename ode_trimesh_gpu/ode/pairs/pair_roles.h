// SPDX-License-Identifier: BSD-3-Clause
// Which of two meshes is A. The one place that decides it: frames, symbolic signs and numbers in ties follow from it.
#pragma once

#include "ode/geom/mesh_side.h"

namespace otg {

/// Whether the first of two geoms, both with a mesh, is A. It depends on the geometry alone, so that contacts do not
/// depend on which geom was created first: A has the smaller radius, as a body has beside its ground. If they are equal
/// it has more triangles, or at last the larger hash of its contents. Of two equal meshes A has the smaller coordinate
/// along the world's axis on which they are farthest apart. So a pair that trembles stays as it is. A pair that
/// remembers something (`remembers`) stays as it was then.
bool isFirstMeshA(const MeshGeom& side1, const Transformd& pose1, const MeshGeom& side2, const Transformd& pose2,
                  bool remembers) noexcept;

}  // namespace otg
