// SPDX-License-Identifier: BSD-3-Clause
#include "cli/program.h"

#include <cstdio>
#include <exception>
#include <iostream>
#include <new>
#include <string>

#include "collide/pair_limit.h"
#include "ode/base/environment_report.h"
#include "ode_trimesh_gpu/version.h"

namespace otg::cli {

int fail(ExitStatus status, const std::string& message) {
  std::fprintf(stderr, "otg: %s\n", message.c_str());
  return status;
}

int runProgram(const char* name, const char* summary, void (*addCommands)(CLI::App&, Action&), int argc, char** argv) {
  reportEnvironment();
  try {
    CLI::App app(summary, name);
    app.require_subcommand(1);
    app.set_version_flag("--version", std::string("ode_trimesh_gpu ") + dGpuTriMeshGetVersion());
    app.set_help_all_flag("--help-all", "Print the help of all commands and exit");
    Action action;
    addCommands(app, action);
    try {
      app.parse(argc, argv);
    } catch (const CLI::ParseError& error) {
      return app.exit(error, std::cout, std::cerr) == 0 ? kOk : kBadUsage;
    }
    const int status = action();
    // Output that did not arrive (a full disk, a closed pipe) is no success.
    if (std::fflush(stdout) != 0) return fail(kBadInput, "writing to stdout failed");
    return status;
  } catch (const UsageError& error) {
    return fail(kBadUsage, error.what());
  } catch (const TooManyPairs& error) {
    return fail(kBadInput, error.what());
  } catch (const std::bad_alloc&) {
    return fail(kBadInput, "not enough memory");
  } catch (const std::exception& error) {
    return fail(kBadInput, error.what());
  }
}

}  // namespace otg::cli
