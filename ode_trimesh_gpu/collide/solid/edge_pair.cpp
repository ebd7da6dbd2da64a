// SPDX-License-Identifier: BSD-3-Clause
#include "collide/solid/edge_pair.h"

#include <algorithm>
#include <cmath>

#include "base/vectors.h"

namespace otg {
namespace {

/// A stretch of a sharp convex edge inside the other mesh, in A's frame.
struct Stretch {
  Vec3d middle, along;
  double reach;
  Vec3d faces[2];  ///< outward normals
};

/// The stretches of one mesh, or none if there are too many or they do not make up its side.
std::pmr::vector<Stretch> stretchesOf(int m, const PlacedMeshes& meshes, const OverlapRegions& all,
                                      const Region& region) {
  std::pmr::vector<Stretch> found(all.memory);
  const Adjacency& adjacency = meshes.adjacency(m);
  const Topology& topology = meshes.mesh(m).topology();
  for (std::uint32_t i = region.pointBegin; i < region.pointEnd; ++i) {
    const SupportPoint& p = all.points[i];
    if (p.mesh != m || p.kind < PointKind::kMiddle) continue;
    const std::uint32_t half = adjacency.halfEdgeOf[p.feature], twin = topology.twin[half];
    if (twin == kNone) continue;
    const Vec3d n0 = meshes.normal(m, half / 3), n1 = meshes.normal(m, twin / 3);
    const Topology::Edge& edge = topology.edges[p.feature];
    const Vec3d ends = meshes.vertex(m, edge.b) - meshes.vertex(m, edge.a);
    // The face of `half` lies to its left: the edge is convex if the other face turns away from it.
    const bool forward = topology.weld[meshes.mesh(m).triangles()[half / 3].v[half % 3]] == edge.a;
    if (!otgIsSharpConvex(n0, n1, forward ? ends : ends * -1.0)) continue;
    if (found.size() == OTG_SOLID_MOST_STRETCHES) {
      found.clear();
      return found;
    }
    found.push_back({p.position, p.along, p.reach, {n0, n1}});
  }
  return found;
}

/// Whether the two faces of the edge are all that the region has of its mesh.
bool isAll(const Stretch& s, int m, const OverlapRegions& all, const Region& region) {
  double own = 0;
  for (std::uint32_t i = region.pieceBegin; i < region.pieceEnd; ++i) {
    const Piece& p = all.pieces[i];
    if (p.mesh != m) continue;
    if (otgDot(p.normal, s.faces[0]) >= OTG_SOLID_SAME_FACE || otgDot(p.normal, s.faces[1]) >= OTG_SOLID_SAME_FACE)
      own += p.area;
  }
  return own >= OTG_SOLID_FACE_SHARE * (m == 0 ? region.areaA : region.areaB);
}

}  // namespace

std::pmr::vector<Vec3d> directionsAcross(const PlacedMeshes& meshes, const OverlapRegions& all, const Region& region) {
  std::pmr::vector<Vec3d> found(all.memory);
  if (region.contained || region.coherence >= OTG_SOLID_ONE_FACE || region.cellEnd > region.cellBegin) return found;
  const std::pmr::vector<Stretch> a = stretchesOf(0, meshes, all, region);
  if (a.empty()) return found;
  const bool isLump = region.thickness > OTG_SOLID_DEEP * region.diagonal;
  const std::pmr::vector<Stretch> b = stretchesOf(1, meshes, all, region);
  for (const Stretch& s : a) {
    if (b.empty() || (!isLump && !isAll(s, 0, all, region))) continue;
    for (const Stretch& r : b) {
      const Vec3d across = otgCross(s.along, r.along);
      const double sine = norm(across);
      if (sine < OTG_SOLID_LEAST_SINE || (!isLump && !isAll(r, 1, all, region))) continue;
      Vec3d d = across * (1 / sine);
      if (otgDot(d, region.push) < 0) d = d * -1.0;
      if (!otgIsBetween(s.faces[0], s.faces[1], d * -1.0) || !otgIsBetween(r.faces[0], r.faces[1], d)) continue;
      // Nearest points of the two lines, within the stretches.
      const Vec3d apart = r.middle - s.middle;
      const double u = otgDot(otgCross(apart, r.along), across) / (sine * sine);
      const double v = otgDot(otgCross(apart, s.along), across) / (sine * sine);
      if (std::fabs(u) > s.reach || std::fabs(v) > r.reach) continue;
      found.push_back(d);
    }
  }
  return found;
}

}  // namespace otg
