// SPDX-License-Identifier: BSD-3-Clause
// What the object-level contact model needs of a mesh beyond its topology; made once per mesh.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "mesh/tri_mesh.h"

namespace otg {

/// The part that depends on triangles and topology alone, and is shared by meshes that have the same (TriMesh).
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

struct Adjacency : AdjacencyLinks {
  /// Unit normal of each triangle; zero for degenerate ones.
  std::vector<Vec3d> normal;
  /// Area of each triangle; zero for degenerate ones.
  std::vector<double> area;
  /// A third of the area around each welded vertex, as vector and as number: summed over all vertices of a closed patch
  /// it gives the patch's without a look at its triangles.
  struct Star {
    Vec3d vector;
    double area;
  };
  std::vector<Star> star;
  /// What holds for all vertices of a cluster.
  struct Cluster {
    Vec3f lo, hi;                         ///< bounds of its vertices
    std::uint32_t first, firstNeighbour;  ///< as in clusterLists
    Star sum;                             ///< of its vertices' stars
    double moment;                        ///< sum of star . vertex
    bool anyFlat, anyCorner;              ///< whether any of its vertices has flatVertex, and whether any has not
  };
  std::vector<Cluster> clusters;  ///< and one more that ends the last
  /// 1 for edges whose two triangles lie in one plane to within kFlatDegrees: nothing can rest on them.
  std::vector<std::uint8_t> flatEdge;
  static constexpr double kFlatDegrees = 0.1;
  /// 1 for welded vertices in the middle of a flat face or of a straight edge (to within kFlatDegrees): they are there
  /// only because of the tessellation.
  std::vector<std::uint8_t> flatVertex;
};

Adjacency buildAdjacency(const TriMesh& mesh);

/// After vertices have moved and topology() has stayed: the same bytes as buildAdjacency() would make, at a cost that
/// follows the number of `triangles`, which are all those with a moved corner, each once. Throws std::bad_alloc; the
/// adjacency is then to be built anew.
void updateAdjacency(Adjacency& adjacency, const TriMesh& mesh, std::span<const std::uint32_t> triangles);

}  // namespace otg
