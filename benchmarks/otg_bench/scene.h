// SPDX-License-Identifier: BSD-3-Clause
// What benchmarks collide: a mesh with a second copy of itself in a named pose.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "bvh/collision_mesh.h"
#include "cli/command.h"
#include "cli/times.h"

namespace otg::cli {

struct BenchOptions {
  std::vector<std::string> files;
  std::vector<int> lumps;  ///< levels of generated lumps, in place of files; empty: 7 to 3
  std::string scene = "touch";
  std::string poses;
  std::string figures;               ///< of `bench thesis`: folder for its figures, or empty
  int repeat = 0;                    ///< 0: as many as fit into a fraction of a second, 3 to 50
  int pairs = 10000;                 ///< of `bench batch`
  std::vector<std::string> batches;  ///< of `bench batch`; empty: bodies, and for the model `solid` stacks
  std::vector<std::string>
      scenes;       ///< of `bench batch`, and of the traversal `levels` in `bench thesis`; empty: default
  bool cpu = true;  ///< of `bench batch`
  std::string contacts = "pairwise";   ///< of `bench batch`
  std::vector<std::string> tune;       ///< of `bench batch`
  std::vector<std::string> bodyFiles;  ///< of `bench batch`: further bodies
  bool json = false;

  void addTo(CLI::App& command, bool withScene);
};

struct BenchMesh {
  std::string name;
  std::shared_ptr<const TriMesh> mesh;
};

/// The files of the command line; without any, the armadillo* of the folder that OTG_MESH_DIR names; without that,
/// lumps. Largest first.
std::vector<BenchMesh> benchMeshes(const BenchOptions& options);

/// The files of --body-files as bodies of a batch: moved to the origin and scaled to radius 1. Those that do not have
/// 200 to 6,000 triangles are left out, with a note; throws InputError if that leaves none.
std::vector<BenchMesh> bodyMeshes(const BenchOptions& options);

/// The same mesh as the geom class builds it: sorted for locality. Files are read as they are, which is what other
/// libraries get.
std::shared_ptr<const TriMesh> sortedForLocality(const TriMesh& mesh);

/// The scene's matrix from --poses; without it, a pose of the same kind computed for the mesh: turned, then moved along
/// x to where the copies just touch, and from there by a fraction of the mesh's width: touch -0.05, deep -0.35,
/// nearmiss +0.002; deep10: turned by 10 degrees in nearly the same place.
Transformd benchPose(const BenchOptions& options, const CollisionMesh& mesh);

}  // namespace otg::cli
