// SPDX-License-Identifier: BSD-3-Clause
#include "queries/ray_cast.h"

#include <algorithm>

#include "queries/closest_point.h"

namespace otg {
namespace {

bool shareACorner(const TriMesh& mesh, std::uint32_t s, std::uint32_t t) {
  const SharedArray<std::uint32_t>& weld = mesh.topology().weld;
  for (const std::uint32_t v : mesh.triangles()[s].v) {
    for (const std::uint32_t w : mesh.triangles()[t].v) {
      if (weld[v] == weld[w]) return true;
    }
  }
  return false;
}

/// Neighbours that are hit at one point are one hit.
void mergeHits(const TriMesh& mesh, std::vector<RayHit>& hits) {
  const double same = 1e-9 * static_cast<double>(mesh.radius());
  std::size_t kept = 0;
  for (const RayHit& hit : hits) {
    bool isNew = true;
    for (std::size_t i = kept; i-- > 0 && isNew && hit.distance - hits[i].distance <= same;) {
      if (hits[i].back == hit.back && shareACorner(mesh, hits[i].triangle, hit.triangle)) {
        hits[i].triangle = std::min(hits[i].triangle, hit.triangle);
        isNew = false;
      }
    }
    if (isNew) hits[kept++] = hit;
  }
  hits.resize(kept);
}

}  // namespace

namespace {

bool passes(const CollisionMesh& mesh, const RayCast& cast, std::uint32_t triangle, double distance) {
  if (!cast.filter) return false;
  Vec3d p[3];
  cornersOf(mesh.mesh(), triangle, p);
  const Vec3d e1 = otgSub(p[1], p[0]), e2 = otgSub(p[2], p[0]), n = otgCross(e1, e2);
  const Vec3d at = otgSub(otgAdd(cast.ray.origin, otgScale(cast.ray.direction, distance)), p[0]);
  const double nn = otgDot(n, n);
  return !cast.filter(triangle, otgDot(otgCross(at, e2), n) / nn, otgDot(otgCross(e1, at), n) / nn);
}

}  // namespace

void castRay(const CollisionMesh& mesh, const RayCast& cast, std::vector<RayHit>& hits) {
  hits.clear();
  double limit = cast.length;
  if (cast.mode == RayMode::kAll) {
    forEachRayHit(mesh, cast.ray, limit, [&](std::uint32_t t, double distance, bool leaving) {
      if (leaving && cast.cullBack) return;
      if (!passes(mesh, cast, t, distance)) hits.push_back({distance, t, leaving});
    });
    std::sort(hits.begin(), hits.end(), [](const RayHit& x, const RayHit& y) {
      return x.distance != y.distance ? x.distance < y.distance : x.triangle < y.triangle;
    });
    mergeHits(mesh.mesh(), hits);
    return;
  }
  RayHit best;
  forEachRayHit(mesh, cast.ray, limit, [&](std::uint32_t t, double distance, bool leaving) {
    if (leaving && cast.cullBack) return;
    if (best.triangle != kNone && distance == best.distance && t > best.triangle) return;
    if (passes(mesh, cast, t, distance)) return;
    best = {distance, t, leaving};
    limit = cast.mode == RayMode::kAny ? -1.0 : distance;  // nothing more is wanted
  });
  if (best.triangle != kNone) hits.push_back(best);
}

}  // namespace otg
