// SPDX-License-Identifier: BSD-3-Clause
#include "collide/solid/edge_pair.h"

#include <algorithm>
#include <cmath>

#include "collide/solid/vectors.h"

namespace otg {
namespace {

// From this coherence on a face says where out is.
constexpr double kOneFace = 0.99;
// Edges of less than 20 degrees are those of a tessellated curve; a region with more sharp ones is more than a
// crossing.
constexpr double kSharpCosine = 0.94;
constexpr std::size_t kMostStretches = 4;
// Edges within 3 degrees of parallel have no stable direction across.
constexpr double kLeastSine = 0.05;
// Part of a side's area that the two faces of its edge must have.
constexpr double kFaceShare = 0.98, kFaceCosine = 0.9999;

/// A stretch of a sharp convex edge inside the other mesh, in A's frame.
struct Stretch {
  std::uint32_t point;
  Vec3d middle, along;
  double reach;
  Vec3d faces[2];  ///< outward normals
};

/// The stretches of one mesh, or none if there are too many or they do not make up its side.
std::vector<Stretch> stretchesOf(int m, const PlacedMeshes& meshes, const OverlapRegions& all, const Region& region) {
  std::vector<Stretch> found;
  const Adjacency& adjacency = meshes.adjacency(m);
  const Topology& topology = meshes.mesh(m).topology();
  for (std::uint32_t i = region.pointBegin; i < region.pointEnd; ++i) {
    const SupportPoint& p = all.points[i];
    if (p.mesh != m || p.kind < PointKind::kMiddle) continue;
    const std::uint32_t half = adjacency.halfEdgeOf[p.feature], twin = topology.twin[half];
    if (twin == kNone) continue;
    const Vec3d n0 = meshes.normal(m, half / 3), n1 = meshes.normal(m, twin / 3);
    if (otgDot(n0, n1) > kSharpCosine) continue;
    const Topology::Edge& edge = topology.edges[p.feature];
    const Vec3d ends = otgSub(meshes.vertex(m, edge.b), meshes.vertex(m, edge.a));
    // The face of `half` lies to its left: the edge is convex if the other face turns away from it.
    const bool forward = topology.weld[meshes.mesh(m).triangles()[half / 3].v[half % 3]] == edge.a;
    if (otgDot(otgCross(n0, n1), ends) * (forward ? 1 : -1) <= 0) continue;
    if (found.size() == kMostStretches) return {};
    found.push_back({i, p.position, p.along, p.reach, {n0, n1}});
  }
  return found;
}

/// Whether the two faces of the edge are all that the region has of its mesh.
bool isAll(const Stretch& s, int m, const OverlapRegions& all, const Region& region) {
  double own = 0;
  for (std::uint32_t i = region.pieceBegin; i < region.pieceEnd; ++i) {
    const Piece& p = all.pieces[i];
    if (p.mesh != m) continue;
    if (otgDot(p.normal, s.faces[0]) >= kFaceCosine || otgDot(p.normal, s.faces[1]) >= kFaceCosine) own += p.area;
  }
  return own >= kFaceShare * (m == 0 ? region.areaA : region.areaB);
}

/// Whether d, which is perpendicular to the edge, lies between the outward normals of its faces.
bool isBetween(const Stretch& s, const Vec3d& d) {
  const double cosine = otgDot(s.faces[0], s.faces[1]);
  const double x = otgDot(d, s.faces[0]), y = otgDot(d, s.faces[1]);
  return x >= cosine * y && y >= cosine * x;
}

}  // namespace

std::vector<EdgePair> edgePairs(const PlacedMeshes& meshes, const OverlapRegions& all, const Region& region) {
  std::vector<EdgePair> pairs;
  if (region.contained || region.coherence >= kOneFace || region.cellEnd > region.cellBegin) return pairs;
  const std::vector<Stretch> a = stretchesOf(0, meshes, all, region);
  if (a.empty()) return pairs;
  const bool isLump = region.thickness > 0.06 * region.diagonal;
  const std::vector<Stretch> b = stretchesOf(1, meshes, all, region);
  for (const Stretch& s : a) {
    if (b.empty() || (!isLump && !isAll(s, 0, all, region))) continue;
    for (const Stretch& r : b) {
      const Vec3d across = otgCross(s.along, r.along);
      const double sine = norm(across);
      if (sine < kLeastSine || (!isLump && !isAll(r, 1, all, region))) continue;
      Vec3d d = otgScale(across, 1 / sine);
      if (otgDot(d, region.push) < 0) d = otgScale(d, -1.0);
      if (!isBetween(s, otgScale(d, -1.0)) || !isBetween(r, d)) continue;
      // Nearest points of the two lines, within the stretches.
      const Vec3d apart = otgSub(r.middle, s.middle);
      const double u = otgDot(otgCross(apart, r.along), across) / (sine * sine);
      const double v = otgDot(otgCross(apart, s.along), across) / (sine * sine);
      if (std::fabs(u) > s.reach || std::fabs(v) > r.reach) continue;
      pairs.push_back(
          {d, s.point, r.point, otgAdd(s.middle, otgScale(s.along, u)), otgAdd(r.middle, otgScale(r.along, v))});
    }
  }
  return pairs;
}

}  // namespace otg
