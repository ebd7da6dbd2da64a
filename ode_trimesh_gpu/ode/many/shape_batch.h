// SPDX-License-Identifier: BSD-3-Clause
// Many pairs of a mesh and a geom of ODE's own, computed ahead by all threads.
#pragma once

#include <span>

#include "ode_trimesh_gpu/batch.h"

namespace otg {

/// Whether the pair is one of a mesh, given first (isMeshFor()), and a geom that contacts are computed ahead for.
bool isShapePair(dGeomID mesh, dGeomID other) noexcept;

/// Computes the pairs, the mesh first in each, none of them twice, and leaves what they give with the meshes, which
/// have no callbacks. Returns how many pairs are ready. No one may change or collide the geoms meanwhile. May throw
/// std::bad_alloc.
std::size_t prefetchShapes(std::span<const dGpuTriMeshPair> pairs);

}  // namespace otg
