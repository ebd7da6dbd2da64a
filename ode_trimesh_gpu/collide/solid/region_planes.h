// SPDX-License-Identifier: BSD-3-Clause
// A region's pieces as half spaces, from which depths are estimated.
#pragma once

#include "collide/simd/surface_kernels.h"
#include "collide/solid/regions.h"

namespace otg {

/// Adds the pieces of mesh m to surface[m], a plane each. Of a mesh with very many pieces those that lie together and
/// face alike share a plane. Returns whether any do.
bool collectPlanes(const OverlapRegions& all, const Region& region, PlaneSet (&surface)[2]);

}  // namespace otg
