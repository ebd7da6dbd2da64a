// SPDX-License-Identifier: BSD-3-Clause
#include "opencl/runtime/program_cache.h"

#include <atomic>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <limits>
#include <system_error>

#include "base/environment.h"
#include "base/hash.h"
#include "base/system.h"

namespace otg::opencl {
namespace {

constexpr char kMagic[16] = "otg-program-3\n";

struct Head {
  char magic[16];
  std::uint64_t keySize, programSize, checksum;  // of the program: the key is compared
};
static_assert(sizeof(Head) == 40);

}  // namespace

ProgramCache ProgramCache::standard() {
  const Environment environment = readEnvironment();
  if (environment.cacheFolder) return ProgramCache(*environment.cacheFolder);
  if (!environment.xdgCacheHome.empty()) return ProgramCache(environment.xdgCacheHome + "/ode_trimesh_gpu");
  if (!environment.home.empty()) return ProgramCache(environment.home + "/.cache/ode_trimesh_gpu");
  return ProgramCache("");
}

std::string ProgramCache::pathOf(const std::string& key) const {
  char name[32];
  std::snprintf(name, sizeof name, "%016llx.clbin",
                static_cast<unsigned long long>(hashOfWords(key.data(), key.size())));
  return folder_ + "/" + name;
}

std::optional<Bytes> ProgramCache::load(const std::string& key) const {
  if (folder_.empty()) return std::nullopt;
  std::ifstream in(pathOf(key), std::ios::binary | std::ios::ate);
  if (!in) return std::nullopt;
  const std::streamoff end = in.tellg();
  const std::uint64_t size = end < 0 ? 0 : static_cast<std::uint64_t>(end);
  Head head;
  in.seekg(0);
  if (size < sizeof head || !in.read(reinterpret_cast<char*>(&head), sizeof head)) return std::nullopt;
  // The sizes are compared before memory is allocated: a damaged file may say anything.
  if (std::memcmp(head.magic, kMagic, sizeof kMagic) != 0 || head.keySize != key.size() ||
      head.programSize != size - sizeof head - key.size() || size < sizeof head + key.size()) {
    return std::nullopt;
  }
  std::string storedKey(key.size(), '\0');
  Bytes program(static_cast<std::size_t>(head.programSize));
  if (!in.read(storedKey.data(), static_cast<std::streamsize>(storedKey.size())) || storedKey != key)
    return std::nullopt;
  if (!in.read(reinterpret_cast<char*>(program.data()), static_cast<std::streamsize>(program.size())))
    return std::nullopt;
  if (program.empty() || hashOfWords(program.data(), program.size()) != head.checksum) return std::nullopt;
  return program;
}

bool ProgramCache::store(const std::string& key, const Bytes& program) const {
  if (folder_.empty()) return false;
  std::error_code error;
  std::filesystem::create_directories(folder_, error);
  if (error) return false;
  // A name of its own for every writer; the rename replaces what another one may have stored meanwhile.
  static std::atomic<unsigned> serial{0};
  const std::string path = pathOf(key);
  const std::string temporary = path + "." + std::to_string(processId()) + "." + std::to_string(serial++);
  Head head{};
  std::memcpy(head.magic, kMagic, sizeof kMagic);
  head.keySize = key.size();
  head.programSize = program.size();
  head.checksum = hashOfWords(program.data(), program.size());
  {
    std::ofstream out(temporary, std::ios::binary | std::ios::trunc);
    out.write(reinterpret_cast<const char*>(&head), sizeof head);
    out.write(key.data(), static_cast<std::streamsize>(key.size()));
    out.write(reinterpret_cast<const char*>(program.data()), static_cast<std::streamsize>(program.size()));
    out.close();
    if (!out) error = std::make_error_code(std::errc::io_error);
  }
  if (!error) std::filesystem::rename(temporary, path, error);
  if (!error) return true;
  std::error_code ignored;
  std::filesystem::remove(temporary, ignored);
  return false;
}

}  // namespace otg::opencl
