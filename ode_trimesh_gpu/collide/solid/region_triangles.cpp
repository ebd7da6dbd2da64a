// SPDX-License-Identifier: BSD-3-Clause
#include "collide/solid/region_triangles.h"

#include <algorithm>
#include <limits>

#include "base/vectors.h"

namespace otg {

double RegionTriangle::beside(const Vec3d& p) const {
  double most = -std::numeric_limits<double>::infinity();
  for (int k = 0; k < 3; ++k) most = std::max(most, edge[k] - otgDot(inward[k], p));
  return most;
}

void RegionTriangles::collect(const PlacedMeshes& meshes, const OverlapRegions& all, const Region& region) {
  triangles_.clear();
  triangles_.reserve(region.pieceEnd - region.pieceBegin);
  for (std::uint32_t i = region.pieceBegin; i < region.pieceEnd; ++i) {
    const Piece& p = all.pieces[i];
    RegionTriangle t;
    t.normal = p.normal;
    t.offset = p.offset;
    t.mesh = p.mesh;
    Vec3d corner[3];
    for (int k = 0; k < 3; ++k) {
      corner[k] = otgSub(meshes.vertex(p.mesh, meshes.mesh(p.mesh).triangles()[p.triangle].v[k]), all.origin);
    }
    for (int k = 0; k < 3; ++k) {
      t.inward[k] = unit(otgCross(p.normal, otgSub(corner[(k + 1) % 3], corner[k])));
      t.edge[k] = otgDot(t.inward[k], corner[k]);
    }
    triangles_.push_back(t);
  }
}

double RegionTriangles::wayOut(int m, const Vec3d& from, const Vec3d& direction, double slack) const {
  double nearest = std::numeric_limits<double>::infinity();
  for (const RegionTriangle& t : triangles_) {
    const double cosine = otgDot(t.normal, direction);
    if (t.mesh != m || !(cosine > 0.05)) continue;
    const double way = std::max(0.0, (t.offset - otgDot(t.normal, from)) / cosine);
    if (way < nearest && t.beside(otgAdd(from, otgScale(direction, way))) <= slack) nearest = way;
  }
  return nearest;
}

}  // namespace otg
