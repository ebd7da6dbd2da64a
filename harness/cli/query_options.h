// SPDX-License-Identifier: BSD-3-Clause
// The options of a collision query on the command line, shared by `collide` and `pairs`.
#pragma once

#include <array>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "cli/command.h"
#include "cli/mixture.h"
#include "collide/query.h"
#include "dispatch/dispatcher.h"
#include "opencl/backend.h"
#include "opencl/published/levels.h"
#include "opencl/runtime/device_info.h"

namespace otg::cli {

struct QueryOptions {
  std::string fileA, fileB;
  std::string pose = "0,0,0,1,0,0,0";
  std::string backend, midphase, nearphase;  ///< empty: not said
  std::string descent, build, contacts = "auto", reduction;
  int axes = 6;
  std::vector<int> bins;
  int maxContacts = 64;
  int maxPairs = kMostCandidatePairs;
  int contactsPerRegion = 16;
  double regionMerge = 0;
  std::vector<int> devices;
  int threads = 0;
  opencl::LevelsOptions levels;  ///< of --midphase levels
  bool splitNear = false;
  std::string prefixSums = "published";

  /// The files, the pose and how to traverse.
  void addInputOptions(CLI::App& command);
  /// Where the query runs and how trees are built; part of addInputOptions.
  void addBackendOptions(CLI::App& command);
  /// How many threads work on a batch.
  void addThreadOption(CLI::App& command);
  /// What happens to the contacts.
  void addContactOptions(CLI::App& command);
  /// Throws UsageError or InputError for what cannot be had.
  CollideOptions collideOptions() const;
  BuildStrategy buildStrategy() const;
  /// Where each phase is to run; without a word the CPU. Throws UsageError.
  Placement placement() const;
  /// Whether the published traversal is to run on a device.
  bool isLevels() const { return midphase == "levels"; }
  /// Whether the near phase is to run there for triangles that are gathered for it.
  bool isGatheredNear() const { return nearphase == "published" || nearphase == "filtered"; }
  opencl::LevelsOptions levelsOptions() const;
  /// The phases, where they are chosen one by one in a way that only the published design has. Throws UsageError.
  std::optional<Mixture> mixture() const;
  /// The devices that were requested; none for the CPU alone, and, with a note, where there is none. Throws InputError
  /// for the number of a device that does not exist.
  std::vector<int> deviceNumbers() const;
  /// The first of them, where both phases are to run on it or are a mixture(); null for the CPU, and, with a note, when
  /// it cannot be opened. Kernels are built when they are first used.
  std::shared_ptr<opencl::Backend> openBackend() const;
  /// With these threads and with those of these devices that can be opened. Costs are measured if something depends on
  /// them.
  std::unique_ptr<Dispatcher> openDispatcher() const;
};

/// All OpenCL devices; none, and a note on stderr, where a driver would end the program.
std::vector<opencl::DeviceInfo> findDevices();

/// Both meshes with their trees; the same object twice when both paths are the same.
struct LoadedPair {
  std::shared_ptr<const CollisionMesh> a, b;
  double buildMs = 0;  ///< of both trees, for one build (after loading and validation)
};
LoadedPair loadPair(const QueryOptions& options, int repeat);

const char* nameOf(Traversal traversal);
const char* nameOf(DescentRule rule);
const char* nameOf(BuildStrategy strategy);

/// Hash over the bytes of every contact: position, normal, depth, triangle A, triangle B.
std::string hashOf(const std::vector<Contact>& contacts);

}  // namespace otg::cli
