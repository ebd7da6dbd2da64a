// SPDX-License-Identifier: BSD-3-Clause
// A mesh with its tree as it lies on a device.
#pragma once

#include <cstdint>
#include <vector>

#include "bvh/collision_mesh.h"
#include "shared/layout/device_layout.h"
#include "shared/layout/given.h"

namespace otg::opencl {

enum class MeshLayout {
  kEightWide,  ///< PackedTree: eight children, several triangles a leaf, triangles in the order of the leaves, a cut
  kBinary,     ///< BinaryTree: one triangle a leaf, triangles in the order of their numbers, no cut
};

using MeshUnit = otg_mesh_unit;

/// What is sent for one mesh. Nodes are PackedNode in both layouts.
struct PackedMesh {
  std::vector<MeshUnit> units;
  otg_device_mesh place{};  ///< relative to the first unit

  /// The place of a mesh whose first unit is number `begin`.
  otg_device_mesh placeAt(std::uint32_t begin) const;
};

/// The two units of a node; the three of a triangle, one for each corner.
MeshUnit nodeCenter(const Vec3f& center, std::uint32_t first);
MeshUnit nodeExtent(const Vec3f& extent, std::int32_t count);
MeshUnit triangleCorner(const TriMesh& mesh, std::uint32_t triangle, std::uint32_t corner);

}  // namespace otg::opencl
