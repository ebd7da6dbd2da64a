// SPDX-License-Identifier: BSD-3-Clause
// The physics suite as a program of its own: for working on a contact model, `physics_suite --scene stack5` finishes in
// seconds.
#include <cstdio>
#include <exception>

#include "physics/command_line.h"

int main(int argc, char** argv) {
  try {
    CLI::App app("Scenes that judge contacts: ODE's own geoms, its dTriMesh and this library's, with the same limits");
    otg::physics::CommandOptions options;
    otg::physics::addOptions(app, options);
    CLI11_PARSE(app, argc, argv);
    return otg::physics::runCommand(options);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "physics_suite: %s\n", error.what());
    return 1;
  }
}
