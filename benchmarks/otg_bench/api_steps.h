// SPDX-License-Identifier: BSD-3-Clause
// Where the time of dGpuTriMeshCollidePairs() goes.
#pragma once

#include <vector>

#include "cli/command.h"
#include "ode_trimesh_gpu/batch.h"

namespace otg::cli {

/// Does `repeat` times, step by step, what dGpuTriMeshCollidePairs() does with these pairs and `places` places for
/// each. Medians in ms:
///   geoms_read_ms        from pairs of geoms to queries
///   computed_ms          dealing out, and computing by whoever it is dealt to
///   device_ms            of that, the device's share from its first query to its last contact; null unless `onDevice`
///   contacts_written_ms  histories, statistics, contacts as ODE's, and letting go
Json collideSteps(const std::vector<dGpuTriMeshPair>& pairs, int places, int repeat, bool onDevice);

}  // namespace otg::cli
