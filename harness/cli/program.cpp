// SPDX-License-Identifier: BSD-3-Clause
#include "cli/program.h"

#include <cstdio>
#include <exception>
#include <iostream>
#include <new>
#include <set>
#include <string>

#include "collide/pair_limit.h"
#include "ode/base/environment_report.h"
#include "ode_trimesh_gpu/version.h"
#include "scenes/nearest_word.h"

namespace otg::cli {
namespace {

/// The command that the words lead to.
const CLI::App& innermost(const CLI::App& app) {
  const auto used = app.get_subcommands();
  return used.empty() ? app : innermost(*used.front());
}

/// For each word that no command or option of the program has: which one is meant.
/// A command that is like none is named alone.
void suggest(const CLI::App& app) {
  const CLI::App& command = innermost(app);
  std::set<std::string> options, commands;
  for (const CLI::Option* option : command.get_options()) {
    for (const std::string& name : option->get_lnames()) options.insert("--" + name);
  }
  for (const CLI::App* inner : command.get_subcommands({})) commands.insert(inner->get_name());
  for (const std::string& given : command.remaining()) {
    const std::string word = given.substr(0, given.find('='));
    const bool isOption = word.rfind("--", 0) == 0;
    const std::string meant = scenes::nearestWord(word, isOption ? options : commands, word.size() / 3 + 1);
    if (!meant.empty()) {
      std::fprintf(stderr, "'%s': did you mean '%s'?\n", word.c_str(), meant.c_str());
    } else if (!isOption && !commands.empty()) {
      std::fprintf(stderr, "'%s' is no command\n", word.c_str());
    }
    if (!isOption) break;  // what follows a command that is not known may be anything
  }
}

}  // namespace

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
      if (app.exit(error, std::cout, std::cerr) == 0) return kOk;
      suggest(app);
      return kBadUsage;
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
