// SPDX-License-Identifier: BSD-3-Clause
// The command-line program `otg`: reads the command line, runs the command, turns errors into exit statuses.
#include <cstdio>
#include <exception>
#include <new>

#include "mesh_io/mesh_file.h"
#include "otg/commands.h"
#include "otg_bench/bench.h"

namespace {

int fail(int status, const char* message) {
  std::fprintf(stderr, "otg: %s\n", message);
  return status;
}

}  // namespace

int main(int argc, char** argv) {
  using namespace otg::cli;
  try {
    CLI::App app(
        "Triangle-mesh collision for the Open Dynamics Engine: check meshes, collide them, step worlds, measure.\n"
        "With --json one JSON document goes to stdout and nothing else. A pose places B in A's frame.\n"
        "Exit status: 0 success, 1 the input is bad, 2 wrong usage.",
        "otg");
    app.require_subcommand(1);
    Action action;
    addCheckCommand(app, action);
    addCookCommand(app, action);
    addCollideCommand(app, action);
    addPairsCommand(app, action);
    addBatchCommand(app, action);
    addSimulateCommand(app, action);
    addBenchCommand(app, action);
    addDevicesCommand(app, action);
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
  } catch (const std::bad_alloc&) {
    return fail(kBadInput, "not enough memory");
  } catch (const std::exception& error) {
    return fail(kBadInput, error.what());
  }
}
