// SPDX-License-Identifier: BSD-3-Clause
// Which vertices of each mesh lie inside the other: told by the contour and flooded along uncrossed edges, without any
// distance query.
#pragma once

#include <cstdint>
#include <vector>

#include "collide/solid/contour.h"

namespace otg {

struct InsideFlags {
  std::vector<std::uint32_t> vertices[2];   ///< welded vertices inside the other mesh, in the order of the flood
  FlatMap index[2];                         ///< welded vertex -> position in vertices
  std::vector<std::uint32_t> contained[2];  ///< components without a crossing that lie wholly inside
  std::size_t anomalies = 0;                ///< votes that contradicted their patch's majority

  bool isInside(int mesh, std::uint32_t vertex) const { return index[mesh].find(vertex) != FlatMap::kMissing; }
  void clear();

  // Scratch of the flood.
  FlatMap votes, visited;
  std::vector<std::uint32_t> patch;
};

/// Patches of vertices joined by uncrossed edges; every crossing that ends at a patch votes; the majority decides, a
/// ray the ties; a patch with a vertex outside the other mesh's bounds is outside.
void floodInside(const PlacedMeshes& meshes, const Contour& contour, InsideFlags& flags);

}  // namespace otg
