// SPDX-License-Identifier: BSD-3-Clause
// The command that runs the suite, for any program that offers it.
#pragma once

#include <CLI/CLI.hpp>
#include <memory>
#include <string>

#include "physics/suite.h"

namespace otg::physics {

struct CommandOptions {
  SuiteOptions suite;
  bool quick = false, full = false, list = false;
  std::string model = "auto", backend = "cpu", jsonFile, plotFile, meshFolder;
  std::vector<std::string> forms{"native", "ours"};
};

void addOptions(CLI::App& command, CommandOptions& options);
/// Exit status: 0 all demands met, 2 wrong usage, 3 a demand missed that ODE's own geoms meet.
int runCommand(CommandOptions options);

}  // namespace otg::physics
