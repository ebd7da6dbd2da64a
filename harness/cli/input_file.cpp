// SPDX-License-Identifier: BSD-3-Clause
#include "cli/input_file.h"

#include <cstdlib>
#include <filesystem>

namespace otg::cli {

std::string findInput(const std::string& path) {
  std::error_code error;
  const char* folder = std::getenv("OTG_MESH_DIR");
  if (path.empty() || folder == nullptr || *folder == '\0' || std::filesystem::exists(path, error)) return path;
  const std::filesystem::path there = std::filesystem::path(folder) / path;
  return std::filesystem::is_regular_file(there, error) ? there.string() : path;
}

}  // namespace otg::cli
