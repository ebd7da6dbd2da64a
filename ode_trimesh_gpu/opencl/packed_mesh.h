// SPDX-License-Identifier: BSD-3-Clause
// A mesh with its tree as it lies on a device.
#pragma once

#include <cstdint>
#include <vector>

#include "bvh/collision_mesh.h"
#include "shared/device_layout.h"

namespace otg::opencl {

enum class MeshLayout {
  kEightWide,  ///< PackedTree: eight children, several triangles a leaf, triangles in the order of the leaves, a cut
  kBinary,     ///< BinaryTree: one triangle a leaf, triangles in the order of their numbers, no cut
};

struct MeshUnit {
  float x, y, z;
  std::uint32_t w;
};

/// What is sent for one mesh. Nodes are PackedNode in both layouts.
struct PackedMesh {
  std::vector<MeshUnit> units;
  otg_device_mesh place{};  ///< relative to the first unit

  /// The place of a mesh whose first unit is number `begin`.
  otg_device_mesh placeAt(std::uint32_t begin) const;
};

/// For kEightWide: `leafTriangles`, the most triangles of a leaf; `cutOrder` as in Tuning.
PackedMesh packMesh(const CollisionMesh& mesh, MeshLayout layout, std::uint32_t leafTriangles,
                    std::uint32_t cutOrder = 0);

}  // namespace otg::opencl
