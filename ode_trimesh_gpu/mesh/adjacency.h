// SPDX-License-Identifier: BSD-3-Clause
// What the object-level contact model needs of a mesh beyond its topology; made once per mesh.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "mesh/adjacency_links.h"
#include "mesh/tri_mesh.h"
#include "shared/layout/solid_layout.h"

namespace otg {

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
  /// OTG_EDGE_FLAT for edges whose two triangles lie in one plane to within kFlatDegrees: nothing can rest on them.
  /// OTG_EDGE_INNER for those of inner corners: concave, with normals more than kInnerDegrees apart. OTG_EDGE_HOLLOW
  /// for other concave edges with normals more than kHollowDegrees apart. Else 0.
  std::vector<std::uint8_t> edgeKind;
  std::size_t hollowEdges = 0;  ///< how many are OTG_EDGE_INNER or OTG_EDGE_HOLLOW
  std::size_t flatEdges = 0;    ///< how many are OTG_EDGE_FLAT
  static constexpr double kFlatDegrees = 0.1, kInnerDegrees = 60, kHollowDegrees = 30;
  bool isFlatEdge(std::uint32_t edge) const { return edgeKind[edge] == OTG_EDGE_FLAT; }
  /// 1 for welded vertices in the middle of a flat face or of a straight edge (to within kFlatDegrees): they are there
  /// only because of the tessellation.
  std::vector<std::uint8_t> flatVertex;
};

Adjacency buildAdjacency(const TriMesh& mesh);

/// After vertices have moved and topology() has stayed: the same bytes as buildAdjacency() would make, at a cost that
/// follows the number of `triangles`. These are all those with a moved corner, each once. Throws std::bad_alloc; the
/// adjacency is then to be built anew.
void updateAdjacency(Adjacency& adjacency, const TriMesh& mesh, std::span<const std::uint32_t> triangles);

}  // namespace otg
