// SPDX-License-Identifier: BSD-3-Clause
// The table `scale` of `otg bench build`.
#pragma once

#include "otg_bench/scene.h"

namespace otg::cli {

/// What geoms with a scale take beside the data's own mesh: bytes a triangle by the count of malloc (0 where the
/// system's has none), before and after a collision with the defaults; and the time of dGeomGpuTriMeshSetScale(). Then
/// how long the CPU takes to find the pairs of triangles of such a mesh and its copy where they touch. Once with the
/// tree that the geom has, once with one built from the scaled vertices.
Json scaleRows(const BenchOptions& options);

}  // namespace otg::cli
