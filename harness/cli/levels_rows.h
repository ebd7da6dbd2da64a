// SPDX-License-Identifier: BSD-3-Clause
// What `collide --profile` and `bench thesis` show of the traversal `levels`.
#pragma once

#include <vector>

#include "cli/query_profile.h"
#include "opencl/published/levels.h"

namespace otg::cli {

/// Each time by itself.
opencl::LevelsTimes medianOf(const std::vector<opencl::LevelsTimes>& times);

/// In the order in which they run. `total`: milliseconds of a query that takes no times; host is what is left of it.
std::vector<QueryStage> stagesOf(const opencl::LevelsTimes& times, double total);

/// Rows of {depth, box_tests, overlapping, leaf_pairs, spawned}, each after what `before` holds.
Json depthRows(const std::vector<opencl::LevelsStep>& steps, const Json& before = Json::object());

}  // namespace otg::cli
