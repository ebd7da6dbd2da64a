// SPDX-License-Identifier: BSD-3-Clause
// The tables `overlaps` and `distances` of `otg bench queries`.
#pragma once

#include <vector>

#include "otg_bench/scene.h"

namespace otg::cli {

/// dGpuTriMeshOverlaps() of so many pairs: of the bodies of `otg bench batch`; and of each mesh with its copy where
/// they touch and where they nearly do, a little elsewhere in each pair. On one thread of the CPU, on all, and on the
/// devices that are open; `auto` says which of them that choice takes.
Json overlapRows(const BenchOptions& options, const std::vector<int>& pairCounts, int repeat, bool withDevices);

/// The same of dGpuTriMeshGetDistances(), with meshes that nearly touch and meshes half a radius further apart; at most
/// 1,000 pairs on one thread.
Json distanceRows(const BenchOptions& options, const std::vector<int>& pairCounts, int repeat, bool withDevices);

}  // namespace otg::cli
