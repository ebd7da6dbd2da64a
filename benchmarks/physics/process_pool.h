// SPDX-License-Identifier: BSD-3-Clause
// Runs jobs in processes of their own. ODE keeps its random state and its trimesh scratch in globals, and stock trimesh
// aborts, crashes or hangs in some scenes: a process for each run makes runs independent and a crash a result.
#pragma once

#include <functional>
#include <string>
#include <vector>

namespace otg::physics {

struct JobOutcome {
  std::string output;  ///< what the job returned
  std::string error;   ///< empty, or how it ended otherwise: its exception, a signal, too slow
};

/// Calls job(i) for i in [0, count) in forked processes, at most `workers` at a time, each for at most `timeout`
/// seconds of wall time. `done` is called here, in the order in which they end. Call it before threads are started.
void runInProcesses(std::size_t count, int workers, double timeout, const std::function<std::string(std::size_t)>& job,
                    const std::function<void(std::size_t, JobOutcome)>& done);

}  // namespace otg::physics
