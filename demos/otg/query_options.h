// SPDX-License-Identifier: BSD-3-Clause
// The options of a collision query on the command line, shared by `collide` and `pairs`.
#pragma once

#include <array>
#include <memory>
#include <string>
#include <vector>

#include "collide/query.h"
#include "opencl/backend.h"
#include "opencl/device_info.h"
#include "otg/command.h"

namespace otg::cli {

struct QueryOptions {
  std::string fileA, fileB;
  std::string pose = "0,0,0,1,0,0,0";
  std::string backend = "auto";
  std::string midphase = "cpu", nearphase = "cpu";
  std::string descent, build, contacts = "auto", reduction;
  int axes = 6;
  std::vector<int> bins;
  int maxContacts = 64;
  int contactsPerRegion = 16;
  int device = -1;

  /// The files, the pose and how to traverse.
  void addInputOptions(CLI::App& command);
  /// Where the query runs and how trees are built; part of addInputOptions.
  void addBackendOptions(CLI::App& command);
  /// What happens to the contacts.
  void addContactOptions(CLI::App& command);
  /// Throws UsageError or InputError for what cannot be had.
  CollideOptions collideOptions() const;
  BuildStrategy buildStrategy() const;
  /// The device that was asked for; null for the CPU. Throws InputError when it cannot be had.
  std::shared_ptr<opencl::Backend> openBackend() const;
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
