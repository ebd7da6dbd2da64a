// SPDX-License-Identifier: BSD-3-Clause
// Which vertices of each mesh lie inside the other: known at the contour, flooded along uncrossed edges, without any
// distance query.
#pragma once

#include <cstdint>
#include <vector>

#include "base/epoch_array.h"
#include "collide/solid/contour.h"

namespace otg {

struct InsideFlags {
  /// Vertices that are joined by uncrossed edges. Those of clusters (mesh/adjacency.h) without any crossed edge are
  /// named by cluster, the others one by one.
  struct Patch {
    std::uint32_t vertexBegin, vertexEnd;    ///< into vertices and positions of its mesh
    std::uint32_t clusterBegin, clusterEnd;  ///< into clusters of its mesh
  };
  std::vector<Patch> patches[2];            ///< those inside the other mesh
  std::vector<std::uint32_t> vertices[2];   ///< welded vertices inside the other mesh, by patch
  std::vector<Vec3d> positions[2];          ///< of `vertices`, in A's frame
  std::vector<std::uint32_t> clusters[2];   ///< clusters wholly inside the other mesh, by patch
  std::vector<std::uint32_t> contained[2];  ///< components without a crossing that lie wholly inside
  std::vector<std::uint8_t> crossed;        ///< scratch: of components
  std::size_t anomalies = 0;                ///< votes that contradicted their patch's majority

  /// The patch that the welded vertex belongs to, or kNone if it is outside.
  std::uint32_t patchOf(int mesh, std::uint32_t vertex) const {
    std::uint32_t p = vertexPatch[mesh].find(vertex);
    if (p == EpochArray::kMissing && (*clusterOf[mesh])[vertex] != kNone) {
      p = clusterPatch[mesh].find((*clusterOf[mesh])[vertex]);
    }
    return p < kOutside ? p : kNone;
  }
  bool isInside(int mesh, std::uint32_t vertex) const { return patchOf(mesh, vertex) != kNone; }

  // Filled by the flood.
  static constexpr std::uint32_t kOutside = 0xfffffffeu;
  const SharedArray<std::uint32_t>* clusterOf[2] = {nullptr, nullptr};
  /// Patch, or kOutside when visited and found outside, of vertices and of clusters.
  EpochArray vertexPatch[2], clusterPatch[2];
  EpochArray mixed;  ///< clusters that hold an end of a crossed edge
  EpochArray votes;  ///< ends of crossed edges: votes for inside less votes for outside
};

/// Patches of vertices joined by uncrossed edges; every crossing that ends at a patch votes; the majority decides, a
/// ray the ties; a patch with a vertex outside the other mesh's bounds is outside.
void floodInside(const PlacedMeshes& meshes, const Contour& contour, InsideFlags& flags);

}  // namespace otg
