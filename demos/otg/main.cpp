// SPDX-License-Identifier: BSD-3-Clause
// The command-line program `otg`.
#include "cli/program.h"
#include "otg/commands.h"
#include "otg/hand_over.h"

namespace {

void addCommands(CLI::App& app, otg::cli::Action& action) {
  using namespace otg::cli;
  addCheckCommand(app, action);
  addCookCommand(app, action);
  addCollideCommand(app, action);
  addPairsCommand(app, action);
  addBatchCommand(app, action);
  addSimulateCommand(app, action);
  addSoakCommand(app, action);
  app.add_subcommand("bench", kBenchSummary);  // for the list of commands; see hand_over.h
  addDevicesCommand(app, action);
}

}  // namespace

int main(int argc, char** argv) {
  if (otg::cli::isForBenchmarks(argc, argv)) return otg::cli::handOverToBenchmarks(argc, argv);
  return otg::cli::runProgram(
      "otg",
      "Triangle-mesh collision for the Open Dynamics Engine: check meshes, collide them, step worlds, measure.\n"
      "With --json one JSON document goes to stdout and nothing else. A pose places B in A's frame.\n"
      "Exit status: 0 success, 1 the input is bad, 2 wrong usage.",
      &addCommands, argc, argv);
}
