// SPDX-License-Identifier: BSD-3-Clause
#include "otg/hand_over.h"

#include <unistd.h>

#include <cerrno>
#include <filesystem>
#include <string>
#include <string_view>
#include <system_error>
#include <vector>

#include "cli/program.h"

namespace otg::cli {
namespace {

/// The number of the first word that is no option; argc if there is none.
int commandWord(int argc, char** argv) {
  int i = 1;
  while (i < argc && argv[i][0] == '-') ++i;
  return i;
}

/// The path of `otg_bench` beside this program. Without a folder where the system does not say where this program is,
/// and it was found on the search path: there the other one is, too.
std::string benchmarksBeside(const char* self) {
  std::error_code unknown;
  std::filesystem::path program = std::filesystem::read_symlink("/proc/self/exe", unknown);
  if (unknown) program = self;
  return program.replace_filename("otg_bench").string();
}

}  // namespace

bool isForBenchmarks(int argc, char** argv) {
  const int word = commandWord(argc, argv);
  return word < argc && std::string_view(argv[word]) == "bench";
}

int handOverToBenchmarks(int argc, char** argv) {
  const std::string program = benchmarksBeside(argv[0]);
  std::vector<char*> words(argv, argv + argc);
  words.erase(words.begin() + commandWord(argc, argv));
  words.push_back(nullptr);
  execvp(program.c_str(), words.data());
  const int error = errno;
  if (error == ENOENT) {
    return fail(kBadInput, "otg bench needs otg_bench: cmake --build --preset default --target otg_bench");
  }
  return fail(kBadInput, program + ": " + std::generic_category().message(error));
}

}  // namespace otg::cli
