// SPDX-License-Identifier: BSD-3-Clause
// The table `rays` of `otg bench queries`.
#pragma once

#include <vector>

#include "otg_bench/scene.h"

namespace otg::cli {

/// dGeomGpuTriMeshCastRays() of so many rays at each mesh: those of a camera's picture, line by line (`camera`), and
/// from anywhere around to anywhere (`around`). On one thread of the CPU (arrays of `alone` rays at most), on all, and
/// on the device that is open; `auto` says which of them that choice takes.
Json rayRows(const BenchOptions& options, const std::vector<int>& counts, int alone, int repeat, bool withDevices);

}  // namespace otg::cli
