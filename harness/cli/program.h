// SPDX-License-Identifier: BSD-3-Clause
// What the programs `otg` and `otg_bench` have in common: from the command line to an exit status.
#pragma once

#include "cli/command.h"

namespace otg::cli {

/// What `otg --help` and `otg bench --help` say of the benchmarks.
inline constexpr const char* kBenchSummary =
    "Measure; times are milliseconds of one thread, medians, where nothing else is said";

/// Reads the command line, runs the command that it names, and turns errors into messages and exit statuses.
/// `name` is what help texts call the program; `addCommands` adds its commands.
int runProgram(const char* name, const char* summary, void (*addCommands)(CLI::App&, Action&), int argc, char** argv);

/// The program's name and the message on stderr; returns `status`.
int fail(ExitStatus status, const std::string& message);

}  // namespace otg::cli
