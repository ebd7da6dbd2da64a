// SPDX-License-Identifier: BSD-3-Clause
// The program `otg_bench`, which `otg bench` hands over to.
#include "cli/program.h"
#include "otg_bench/bench.h"

int main(int argc, char** argv) {
  return otg::cli::runProgram("otg bench", otg::cli::kBenchSummary, &otg::cli::addBenchmarks, argc, argv);
}
