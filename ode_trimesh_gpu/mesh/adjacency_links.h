// SPDX-License-Identifier: BSD-3-Clause
// Who is whose neighbour in a mesh: what lies around vertices, edges and components, and small clusters of vertices.
#pragma once

#include <cstdint>
#include <span>

#include "base/shared_array.h"
#include "mesh/topology.h"

namespace otg {

/// Depends on triangles and topology alone, and is shared by meshes that have the same (TriMesh).
struct AdjacencyLinks {
  /// Outgoing half-edges of each welded vertex: halfEdges[first[v]] .. halfEdges[first[v + 1] - 1], ascending. Empty
  /// for vertices that are welded to a smaller one.
  SharedArray<std::uint32_t> first, halfEdges;
  /// The welded vertex at the other end of each of `halfEdges`, and its edge.
  struct Spoke {
    std::uint32_t vertex, edge;
  };
  SharedArray<Spoke> spokes;
  /// One half-edge of each edge.
  SharedArray<std::uint32_t> halfEdgeOf;
  /// Small sets of vertices that hang together through edges; each used welded vertex is in one. What holds for all of
  /// a set is found out once. One more ends the last.
  struct ClusterLists {
    std::uint32_t first;           ///< its vertices: clusterVertices[first] .. up to the next one's first
    std::uint32_t firstNeighbour;  ///< likewise in clusterNeighbours: the clusters that its vertices have edges to
  };
  static constexpr std::uint32_t kClusterSize = 16;
  SharedArray<ClusterLists> clusterLists;
  SharedArray<std::uint32_t> clusterOf;  ///< by vertex; kNone for vertices without a half-edge
  SharedArray<std::uint32_t> clusterVertices, clusterNeighbours;
  /// One vertex (welded) of each component, and the component's triangles: triangles[componentFirst[c]] ..
  SharedArray<std::uint32_t> componentVertex, componentFirst, componentTriangles;
};

AdjacencyLinks buildAdjacencyLinks(std::span<const Triangle> triangles, const Topology& topology);

}  // namespace otg
