// SPDX-License-Identifier: BSD-3-Clause
// What the contact model `solid` looks at of a mesh, as it lies on a device.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "opencl/meshes/packed_mesh.h"

namespace otg::opencl {

/// New units for some places of a mesh on a device, counted from its first unit; each place once.
struct PackedChanges {
  std::vector<std::uint32_t> at;
  std::vector<MeshUnit> units;
  void add(std::uint32_t place, const MeshUnit& unit) {
    at.push_back(place);
    units.push_back(unit);
  }
};

/// Each number once, ascending.
void sortUnique(std::vector<std::uint32_t>& numbers);

/// Sets OTG_MESH_CLOSED or OTG_MESH_SHEET of solids and sheets, and appends the section that
/// shared/layout/solid_layout.h describes (OTG_MESH_LISTED, OTG_MESH_SOLID) unless the mesh is too odd for devices. The
/// rings come right before it.
void addSolid(PackedMesh& out, const CollisionMesh& collisionMesh);

/// What of a section, which begins at unit `begin`, is to be sent after vertices have moved in place and `triangles`
/// (ascending) have other corners. `head`: the fourth words of its first OTG_SOLID_TRIANGLES units. False where the
/// mesh has become too odd for devices.
bool addSolidChanges(PackedChanges& out, const CollisionMesh& collisionMesh, std::span<const std::uint32_t> triangles,
                     std::uint32_t begin, std::span<const std::uint32_t> head);

}  // namespace otg::opencl
