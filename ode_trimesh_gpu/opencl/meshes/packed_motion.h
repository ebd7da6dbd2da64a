// SPDX-License-Identifier: BSD-3-Clause
// The parts of a packed mesh that change when some of its vertices move.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "bvh/packed_tree.h"
#include "opencl/meshes/packed_mesh.h"
#include "opencl/meshes/packed_solid.h"

namespace otg::opencl {

/// Where triangles, and the nodes above them, lie in a packed mesh of the layout kEightWide. Takes about 20 bytes for
/// each triangle.
class PackedPlaces {
 public:
  /// Of a packed mesh with its tree, and for each node of that the one of the binary tree which it stands for.
  PackedPlaces(const PackedTree& tree, std::span<const std::uint32_t> binaryNodes, const PackedMesh& packed);

  /// What is to be sent after CollisionMesh::moveSome() has changed `triangles` and nothing else of the packed mesh.
  /// They come in any order, some of them perhaps repeatedly. What lies there then is what packMesh() would make, but
  /// that the tree opens the nodes that it did. Empty where the mesh has to be packed anew. Throws std::bad_alloc.
  std::optional<PackedChanges> changesOf(const CollisionMesh& mesh, std::vector<std::uint32_t>&& triangles) const;

  /// By number: the places of triangles in the soup.
  const std::vector<std::uint32_t>& soup() const { return soupOf_; }

 private:
  struct Node {
    std::uint32_t binary, parent, first;
    std::int32_t count;
  };
  void addNodes(const CollisionMesh& mesh, std::span<const std::uint32_t> triangles, PackedChanges& out) const;

  otg_device_mesh place_;
  std::vector<Node> nodes_;
  std::vector<std::uint32_t> leafOf_, soupOf_;                ///< by triangle: its leaf, its place in the soup
  std::vector<std::pair<std::uint32_t, std::uint32_t>> cut_;  ///< nodes of the cut, ascending, and their places in it
  std::vector<std::uint32_t> sectionHead_;                    ///< fourth words of the section that addSolid() appends
};

}  // namespace otg::opencl
