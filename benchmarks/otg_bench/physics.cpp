// SPDX-License-Identifier: BSD-3-Clause
// `otg bench physics`: worlds of mesh bodies judged against limits and ODE's own geoms.
#include "otg_bench/bench.h"
#include "physics/command_line.h"

namespace otg::cli {

void addBenchPhysics(CLI::App& bench, Action& action) {
  CLI::App* command = bench.add_subcommand("physics",
                                           "Worlds of resting, stacked, rolling, falling bodies: our meshes, ODE's, "
                                           "its primitives (exit status 3: a demand missed)");
  auto options = std::make_shared<physics::CommandOptions>();
  physics::addOptions(*command, *options);
  command->callback([options, &action] { action = [options] { return physics::runCommand(*options); }; });
}

}  // namespace otg::cli
