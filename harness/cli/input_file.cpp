// SPDX-License-Identifier: BSD-3-Clause
#include "cli/input_file.h"

#include <filesystem>

#include "base/environment.h"

namespace otg::cli {

std::string findInput(const std::string& path) {
  std::error_code error;
  const std::string folder = readEnvironment().meshFolder;
  if (path.empty() || folder.empty() || std::filesystem::exists(path, error)) return path;
  const std::filesystem::path there = std::filesystem::path(folder) / path;
  return std::filesystem::is_regular_file(there, error) ? there.string() : path;
}

}  // namespace otg::cli
