// SPDX-License-Identifier: BSD-3-Clause
// The reduction step of a query.
#include "collide/pairwise/reduction.h"

#include <chrono>

namespace otg {

void reduceContacts(const Query& query, Workspace& workspace) {
  using Clock = std::chrono::steady_clock;
  const CollideOptions& options = query.options;
  const auto start = options.timings ? Clock::now() : Clock::time_point{};
  switch (options.reduction.method) {
    case Reduction::kNone:
      workspace.reduced = limitContacts(workspace.contacts, options.maxContacts);
      break;
    case Reduction::kBinning:
      workspace.reduced =
          limitContacts(reduceByBinning(workspace.contacts, options.reduction.bins), options.maxContacts);
      break;
    case Reduction::kCone:
      workspace.reduced = limitContacts(reduceToCone(workspace.contacts), options.maxContacts);
      break;
  }
  if (options.timings) {
    workspace.stats.reductionMs = std::chrono::duration<double, std::milli>(Clock::now() - start).count();
  }
}

}  // namespace otg
