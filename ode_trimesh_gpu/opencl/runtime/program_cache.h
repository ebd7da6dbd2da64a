// SPDX-License-Identifier: BSD-3-Clause
// Built programs, kept on disk.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace otg::opencl {

using Bytes = std::vector<unsigned char>;

/// Files in one folder, named by a hash of the key. A file holds its key and a checksum; one that is damaged, of
/// another format or of another key is as good as none. No function throws anything but std::bad_alloc: a cache that
/// cannot be read or written is an empty one.
class ProgramCache {
 public:
  /// Empty: no cache. Folders are made when something is stored.
  explicit ProgramCache(std::string folder) : folder_(std::move(folder)) {}
  /// The environment variable OTG_CACHE_DIR (empty turns the cache off), else ode_trimesh_gpu below XDG_CACHE_HOME or
  /// ~/.cache.
  static ProgramCache standard();

  std::optional<Bytes> load(const std::string& key) const;
  /// Whole or not at all, also when several processes store at once. False when it could not be written.
  bool store(const std::string& key, const Bytes& program) const;
  /// Path of the file for a key.
  std::string pathOf(const std::string& key) const;

 private:
  std::string folder_;
};

}  // namespace otg::opencl
