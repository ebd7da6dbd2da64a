// SPDX-License-Identifier: BSD-3-Clause
// `otg bench`: the benchmarks are a program of their own, so that `otg` builds without them.
#pragma once

namespace otg::cli {

/// The first word of the command line that is no option is `bench`.
bool isForBenchmarks(int argc, char** argv);
/// Runs the program `otg_bench` beside this one, in place of this one, with all words but `bench`. Returns only if that
/// fails: an exit status, after a message on stderr.
int handOverToBenchmarks(int argc, char** argv);

}  // namespace otg::cli
