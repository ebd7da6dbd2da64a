// SPDX-License-Identifier: BSD-3-Clause
#include "opencl/meshes/packed_motion.h"

#include <algorithm>
#include <cstdlib>

#include "shared/layout/solid_layout.h"

namespace otg::opencl {

PackedPlaces::PackedPlaces(const PackedTree& tree, std::span<const std::uint32_t> binaryNodes, const PackedMesh& packed)
    : place_(packed.place),
      nodes_(tree.nodes.size()),
      leafOf_(packed.place.triangles),
      soupOf_(packed.place.triangles) {
  for (std::uint32_t i = 0; i < nodes_.size(); ++i) {
    const PackedNode& node = tree.nodes[i];
    nodes_[i].binary = binaryNodes[i];
    nodes_[i].first = static_cast<std::uint32_t>(node.first);
    nodes_[i].count = node.count;
    if (i == 0) nodes_[i].parent = kNone;
    for (std::int32_t k = 0; k < std::abs(node.count); ++k) {
      const auto at = static_cast<std::uint32_t>(node.first + k);
      if (node.isLeaf()) {
        leafOf_[tree.triangles[at]] = i;
        soupOf_[tree.triangles[at]] = at;
      } else {
        nodes_[at].parent = i;
      }
    }
  }
  for (std::uint32_t i = 0; i < tree.cut.size(); ++i) cut_.emplace_back(tree.cut[i], i);
  std::sort(cut_.begin(), cut_.end());
  if ((place_.flags & OTG_MESH_LISTED) == 0) return;
  const std::size_t section = std::size_t{place_.rings} + place_.triangles;
  for (std::size_t i = 0; i < OTG_SOLID_TRIANGLES; ++i) sectionHead_.push_back(packed.units[section + i].w);
}

void PackedPlaces::addNodes(const CollisionMesh& mesh, std::span<const std::uint32_t> triangles,
                            PackedChanges& out) const {
  const BoxScale<float>* const scale = mesh.boxScale();
  // Up from the leaves, each level once; a node that is above leaves of different depths comes more often.
  std::vector<std::uint32_t> level, all;
  for (const std::uint32_t t : triangles) level.push_back(leafOf_[t]);
  while (!level.empty()) {
    sortUnique(level);
    all.insert(all.end(), level.begin(), level.end());
    for (std::uint32_t& node : level) node = nodes_[node].parent;
    std::erase(level, kNone);
  }
  sortUnique(all);
  for (const std::uint32_t i : all) {
    const Node& node = nodes_[i];
    const BvhNode& binary = mesh.tree().nodes[node.binary];
    const BoxOf box =
        scale == nullptr ? BoxOf{binary.center, binary.extent} : scaledBox(*scale, binary.center, binary.extent);
    out.add(place_.nodes + 2 * i, nodeCenter(box.center, node.first));
    out.add(place_.nodes + 2 * i + 1, nodeExtent(box.extent, node.count));
    const auto cut = std::lower_bound(cut_.begin(), cut_.end(), std::pair{i, 0u});
    if (cut == cut_.end() || cut->first != i) continue;
    out.add(place_.cut + 2 * cut->second, nodeCenter(box.center, i));
    out.add(place_.cut + 2 * cut->second + 1, nodeExtent(box.extent, node.count));
  }
}

std::optional<PackedChanges> PackedPlaces::changesOf(const CollisionMesh& mesh,
                                                     std::vector<std::uint32_t>&& triangles) const {
  sortUnique(triangles);
  PackedChanges out;
  if (triangles.empty()) return out;
  addNodes(mesh, triangles, out);
  for (const std::uint32_t t : triangles) {
    for (std::uint32_t k = 0; k < 3; ++k) {
      out.add(place_.soup + 3 * soupOf_[t] + k, triangleCorner(mesh.mesh(), t, k));
    }
  }
  if (!sectionHead_.empty() && !addSolidChanges(out, mesh, triangles, place_.rings + place_.triangles, sectionHead_)) {
    return std::nullopt;
  }
  return out;
}

}  // namespace otg::opencl
