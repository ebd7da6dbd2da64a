// SPDX-License-Identifier: BSD-3-Clause
#include "cli/cooked_file.h"

#include <cstdio>
#include <cstring>
#include <filesystem>
#include <memory>
#include <system_error>

namespace otg::cli {
namespace {

struct CloseFile {
  void operator()(std::FILE* file) const { std::fclose(file); }
};
using File = std::unique_ptr<std::FILE, CloseFile>;

}  // namespace

bool isCookedFile(const std::string& path) {
  const File file(std::fopen(path.c_str(), "rb"));
  char first[8] = {};
  return file != nullptr && std::fread(first, 1, 8, file.get()) == 8 && std::memcmp(first, "OTGMESH", 8) == 0;
}

UncookedMesh loadCookedFile(const std::string& path) {
  std::error_code error;
  const std::uintmax_t size = std::filesystem::file_size(path, error);
  const File file(error ? nullptr : std::fopen(path.c_str(), "rb"));
  if (file == nullptr) return {nullptr, "The file cannot be read."};
  return uncookFile(file.get(), size);
}

}  // namespace otg::cli
