// SPDX-License-Identifier: BSD-3-Clause
// Options, and what is printed where.
#include "physics/command_line.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <fstream>

#include "physics/process_pool.h"
#include "physics/report.h"

namespace otg::physics {
namespace {

/// In a process of its own, because processes are forked later and must not inherit an initialised ODE.
bool libraryAccepts(Model model) {
  bool accepted = false;
  runInProcesses(
      1, 1, 60,
      [&](std::size_t) {
        const OdeSession session;
        return std::string(isAccepted(model) ? "yes" : "no");
      },
      [&](std::size_t, const JobOutcome& outcome) { accepted = outcome.output == "yes"; });
  return accepted;
}

void printScenes() {
  for (const Scene& scene : allScenes())
    fmt::print("{:<10} {:<24} {}{}\n", scene.family, scene.name, scene.what,
               scene.realUse ? " [--real]"
               : scene.quick ? ""
                             : " [not in --quick]");
}

}  // namespace

void addOptions(CLI::App& command, CommandOptions& options) {
  auto* quick =
      command.add_flag("--quick", options.quick, "One run for each stepper, without the long scenes (default)");
  command.add_flag("--full", options.full, "All scenes, also varied along time step, order, place, size, buffer, seed")
      ->excludes(quick);
  command.add_option("--scene", options.suite.scenes, "Only these scenes, one run for each stepper unless --full");
  command.add_flag("--real", options.suite.realUse, "The scenes of real use instead: real meshes, long runs");
  command.add_option("--mesh-dir", options.meshFolder, "Folder of the real meshes (default: OTG_MESH_DIR)")
      ->check(CLI::ExistingDirectory);
  command.add_option("--filter", options.suite.filter, "Only runs whose 'family/scene form conditions' contains this");
  command.add_option("--model", options.model, "Contact model of our geoms")
      ->check(CLI::IsMember({"auto", "pairwise", "solid"}))
      ->capture_default_str();
  command.add_option("--form", options.forms, "As what bodies collide; native is added where a limit refers to it")
      ->check(CLI::IsMember({"native", "stock", "ours"}))
      ->capture_default_str();
  command.add_option("--backend", options.backend, "Where our geoms collide; opencl: on the default device")
      ->check(CLI::IsMember({"cpu", "opencl"}))
      ->capture_default_str();
  command.add_option("--jobs", options.suite.workers, "Processes at a time (default: one for each processor)");
  command.add_option("--timeout", options.suite.timeout, "Seconds of wall time for one run")->capture_default_str();
  command.add_flag("--list", options.list, "Say which scenes there are and end");
  // Without a file it is the flag that the other commands of otg have.
  command
      .add_option("--json", options.jsonFile,
                  "Write all results to this file; without one, to stdout instead of the table")
      ->expected(0, 1)
      ->type_name("[FILE]")
      ->default_str("-");
  command.add_option("--plot", options.plotFile, "Draw energy over time to this file (.svg or .png; needs gnuplot)");
}

int runCommand(CommandOptions options) {
  if (options.list) {
    printScenes();
    return 0;
  }
  for (const std::string& name : options.suite.scenes) {
    if (!findScene(name)) {
      fmt::print(stderr, "unknown scene {}: see --list\n", name);
      return 2;
    }
  }
  if (!options.meshFolder.empty()) setenv("OTG_MESH_DIR", options.meshFolder.c_str(), 1);
  for (const Scene& scene : allScenes()) {
    const auto& names = options.suite.scenes;
    const bool wanted = names.empty() ? scene.realUse && options.suite.realUse
                                      : std::find(names.begin(), names.end(), scene.name) != names.end();
    if (!wanted || missingFile(scene).empty()) continue;
    fmt::print(stderr, "skipping {}: the folder of meshes (--mesh-dir, OTG_MESH_DIR) has no {}\n", scene.name,
               missingFile(scene));
  }
  options.suite.model = *modelNamed(options.model);
  options.suite.opencl = options.backend == "opencl";
  options.suite.forms.clear();
  bool ours = false;
  for (const std::string& form : options.forms) {
    options.suite.forms.push_back(*formNamed(form));
    ours = ours || options.suite.forms.back() == Form::kOurs;
  }
  options.suite.extent = options.full ? Extent::kFull : options.suite.scenes.empty() ? Extent::kQuick : Extent::kPlain;
  if (ours && !libraryAccepts(options.suite.model)) {
    fmt::print(stderr, "this build of the library does not have the contact model {}\n", options.model);
    return 2;
  }
  const bool jsonOnly = options.jsonFile == "-";
  const SuiteResult suite = runSuite(options.suite);
  if (!jsonOnly) fmt::print("{}", tableOf(suite));
  if (jsonOnly) {
    fmt::print("{}\n", jsonOf(suite, options.suite));
  } else if (!options.jsonFile.empty()) {
    std::ofstream out(options.jsonFile);
    out << jsonOf(suite, options.suite) << "\n";
    if (!out.flush()) {
      fmt::print(stderr, "cannot write {}\n", options.jsonFile);
      return 2;
    }
  }
  if (!options.plotFile.empty()) {
    const std::string problem = plotEnergies(suite, options.plotFile);
    if (!problem.empty()) fmt::print(stderr, "{}\n", problem);
  }
  return suite.pass() ? 0 : 3;
}

}  // namespace otg::physics
