// SPDX-License-Identifier: BSD-3-Clause
// Queries whose mid and narrow phase are chosen one by one, as in the tables of the published design.
#pragma once

#include <vector>

#include "cli/query_profile.h"
#include "opencl/published/levels.h"
#include "opencl/published/near_phase.h"

namespace otg::cli {

/// One way to put the phases together.
struct Mixture {
  enum class Middle { kCpu, kDevice, kLevels } middle = Middle::kLevels;  ///< kCpu: by the query's own traversal
  enum class Near { kCpu, kContactsFirst, kFilterFirst } near = Near::kContactsFirst;
  opencl::LevelsOptions levels;
};

/// Of one query, or medians: milliseconds of the CPU's clock, and what the phases report.
struct MixtureRun {
  double middle = 0;  ///< candidates, in host memory
  double near = 0;    ///< triangles that intersect; on a device the contacts of the model `pairwise`, too
  double rest = 0;    ///< contacts that are not there yet, and the reduction
  opencl::LevelsReport levels;
  opencl::NearReport nearPhase;
  double total() const { return middle + near + rest; }
};

/// workspace.reduced as otg::collide leaves it. With `profile` reports have times, which costs some.
MixtureRun collideMixed(opencl::Backend& backend, const Query& query, const Mixture& mixture, Workspace& workspace,
                        bool profile = false);
/// As collideMixed(), up to the narrow phase: workspace.intersecting.
void findPairsMixed(opencl::Backend& backend, const Query& query, const Mixture& mixture, Workspace& workspace);

/// Medians over `repeat` queries (0: as repeatTimes) after one to warm up; times of the reports come from queries of
/// their own. What is counted is that of the last one.
MixtureRun measureMixed(opencl::Backend& backend, const Query& query, const Mixture& mixture, Workspace& workspace,
                        int repeat);
/// The same as otg collide --profile shows it.
QueryTimes timesOf(const MixtureRun& run);

const char* nameOf(Mixture::Near near);
const char* nameOf(opencl::PrefixSums way);
/// Medians: gather, upload, kernel, read_back, host.
std::vector<QueryStage> stagesOf(const opencl::NearTimes& times);

}  // namespace otg::cli
