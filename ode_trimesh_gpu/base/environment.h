// SPDX-License-Identifier: BSD-3-Clause
// The environment variables that the library and its programs know: all of them are read here.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace otg {

/// What the environment says now. A variable that is empty counts as not set, but for OTG_CACHE_DIR. One with a value
/// that is not allowed counts as not set, too, and has a sentence in `faults`. Switches are on or off: 1, on, yes, true
/// or 0, off, no, false, in any case of letters.
struct Environment {
  enum class Backend { kAuto, kCpu, kOpencl };
  enum class Contacts { kSolid, kPairwise };

  std::optional<Backend> backend;             ///< OTG_BACKEND
  std::optional<std::uint64_t> deviceMemory;  ///< OTG_DEVICE_MEMORY, bytes
  std::optional<unsigned> threads;            ///< OTG_THREADS
  std::string openclDevice;                   ///< OTG_OPENCL_DEVICE: a number, part of a name, or "none"
  std::optional<std::string> cacheFolder;     ///< OTG_CACHE_DIR; empty: nothing is kept
  std::string kernelFolder;                   ///< OTG_KERNEL_DIR
  std::string meshFolder;                     ///< OTG_MESH_DIR, of the programs
  std::string xdgCacheHome, home;             ///< XDG_CACHE_HOME and HOME, where they are absolute paths

  bool preload = true;                          ///< OTG_PRELOAD
  bool preloadJoin = true;                      ///< OTG_PRELOAD_JOIN
  bool preloadVerbose = false;                  ///< OTG_PRELOAD_VERBOSE
  std::optional<Contacts> preloadContacts;      ///< OTG_PRELOAD_CONTACTS
  std::optional<int> preloadMaxContacts;        ///< OTG_PRELOAD_MAX_CONTACTS
  std::optional<int> preloadContactsPerRegion;  ///< OTG_PRELOAD_CONTACTS_PER_REGION
  std::vector<std::string> preloadPrimitives;   ///< OTG_PRELOAD_PRIMITIVES: names of kPreloadPrimitives

  /// What is wrong, a sentence for each value, with what is allowed.
  std::vector<std::string> faults;
};

inline constexpr const char* kPreloadPrimitives[] = {"all",   "sphere", "box",    "capsule",    "cylinder",
                                                     "plane", "ray",    "convex", "heightfield"};
inline constexpr unsigned kMostThreads = 1024;

/// Reads it anew. Throws std::bad_alloc only. Not while another thread changes the environment.
Environment readEnvironment();

/// The sentence for a value that is not allowed.
std::string environmentFault(const char* name, const std::string& value, const std::string& allowed);

}  // namespace otg
