// SPDX-License-Identifier: BSD-3-Clause
// The commands of the program `otg`, but for its benchmarks.
#pragma once

#include "cli/command.h"

namespace otg::cli {

void addCheckCommand(CLI::App& app, Action& action);
void addCookCommand(CLI::App& app, Action& action);
void addCollideCommand(CLI::App& app, Action& action);
void addPairsCommand(CLI::App& app, Action& action);
void addBatchCommand(CLI::App& app, Action& action);
void addDevicesCommand(CLI::App& app, Action& action);
void addSimulateCommand(CLI::App& app, Action& action);
void addSoakCommand(CLI::App& app, Action& action);

}  // namespace otg::cli
