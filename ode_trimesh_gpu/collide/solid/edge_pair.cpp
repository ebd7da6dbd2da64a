// SPDX-License-Identifier: BSD-3-Clause
#include "collide/solid/edge_pair.h"

#include <algorithm>

#include "base/vectors.h"
#include "shared/contacts/edge_pair.h"

namespace otg {
namespace {

/// The convex edges of one mesh, or none if there are too many.
std::pmr::vector<EdgeOfPair<double>> edgesOf(int m, const PlacedMeshes& meshes, const OverlapRegions& all,
                                             const Region& region) {
  std::pmr::vector<EdgeOfPair<double>> found(all.memory);
  const Adjacency& adjacency = meshes.adjacency(m);
  const Topology& topology = meshes.mesh(m).topology();
  for (std::uint32_t i = region.pointBegin; i < region.pointEnd; ++i) {
    const SupportPoint& p = all.points[i];
    if (p.mesh != m || p.kind < PointKind::kMiddle) continue;
    const std::uint32_t half = adjacency.halfEdgeOf[p.feature], twin = topology.twin[half];
    if (twin == kNone) continue;
    const Vec3d n0 = meshes.normal(m, half / 3), n1 = meshes.normal(m, twin / 3);
    const Topology::Edge& edge = topology.edges[p.feature];
    const Vec3d a = meshes.vertex(m, edge.a), b = meshes.vertex(m, edge.b), ends = b - a;
    // The face of `half` lies to its left: the edge is convex if the other face turns away from it.
    const bool forward = topology.weld[meshes.mesh(m).triangles()[half / 3].v[half % 3]] == edge.a;
    if (!otgIsConvex(n0, n1, forward ? ends : ends * -1.0)) continue;
    if (found.size() == OTG_SOLID_MOST_STRETCHES) {
      found.clear();
      return found;
    }
    const double atA = otgDot(p.along, a - all.origin - p.position), atB = otgDot(p.along, b - all.origin - p.position);
    found.push_back({p.position, p.along, std::min(atA, atB), std::max(atA, atB), {n0, n1}});
  }
  return found;
}

/// Whether the two faces of the edge are all that the region has of its mesh.
bool isAll(const EdgeOfPair<double>& e, int m, const OverlapRegions& all, const Region& region) {
  const auto first = all.pieces.begin() + region.pieceBegin, last = all.pieces.begin() + region.pieceEnd;
  return std::all_of(first, last, [&](const Piece& p) {
    return p.mesh != m || otgDot(p.normal, e.faces[0]) >= OTG_SOLID_SAME_FACE ||
           otgDot(p.normal, e.faces[1]) >= OTG_SOLID_SAME_FACE;
  });
}

}  // namespace

std::pmr::vector<EdgePair> edgePairsOf(const PlacedMeshes& meshes, const OverlapRegions& all, const Region& region) {
  std::pmr::vector<EdgePair> pairs(all.memory);
  if (region.contained || region.coherence >= OTG_SOLID_ONE_FACE || region.cellEnd > region.cellBegin) return pairs;
  const std::pmr::vector<EdgeOfPair<double>> a = edgesOf(0, meshes, all, region);
  if (a.empty()) return pairs;
  const std::pmr::vector<EdgeOfPair<double>> b = edgesOf(1, meshes, all, region);
  const bool isLump = otgIsThick(region.thickness, region.diagonal);
  for (const EdgeOfPair<double>& e : a) {
    for (const EdgeOfPair<double>& f : b) {
      EdgePair pair{};
      if (!otgAreAcross(&e, &f, &pair.direction, &pair.depth)) continue;
      pair.isAll = isAll(e, 0, all, region) && isAll(f, 1, all, region);
      if (isLump || pair.isAll) pairs.push_back(pair);
    }
  }
  return pairs;
}

const EdgePair* wholePair(const std::pmr::vector<EdgePair>& pairs) {
  const EdgePair* best = nullptr;
  for (const EdgePair& pair : pairs) {
    if (pair.isAll && (best == nullptr || pair.depth < best->depth)) best = &pair;
  }
  return best;
}

}  // namespace otg
