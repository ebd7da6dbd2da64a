// SPDX-License-Identifier: BSD-3-Clause
// Queries of two geoms of which one trembles, as bodies at rest do, and of the same at rest.
#pragma once

#include <ode/ode.h>

#include <cstdint>
#include <vector>

#include "cli/contact_hash.h"
#include "otg_bench/bench.h"

namespace otg::cli {

/// Of one pair of geoms, over all poses.
struct TremblingRun {
  std::vector<double> times, stillTimes;  ///< microseconds: the median of each pose
  std::uint64_t contacts = 0;
  Fnv1a hash;  ///< of all contacts
};

/// Adds one pose: `repeat` calls of dCollide() at rest, and as many with `mover` elsewhere by 1e-7 for each. It is put
/// back.
void addPose(dGeomID other, dGeomID mover, int repeat, TremblingRun& run);

/// A row's cells: of ours, beside a dTriMesh.
Json compare(const TremblingRun& ours, const TremblingRun& stock);

}  // namespace otg::cli
