// SPDX-License-Identifier: BSD-3-Clause
#include "queries/surface_side.h"

#include <algorithm>
#include <cmath>

#include "base/vectors.h"
#include "collide/inside_test.h"

namespace otg {
namespace {

int edgeOfPart(TrianglePart part) {
  return static_cast<int>(part) - static_cast<int>(TrianglePart::kEdge0);
}
int cornerOfPart(TrianglePart part) {
  return static_cast<int>(part) - static_cast<int>(TrianglePart::kCorner0);
}

bool isOnRim(const TriMesh& mesh, const Adjacency& adjacency, const SurfacePoint& at) {
  const SharedArray<std::uint32_t>& twin = mesh.topology().twin;
  if (at.part == TrianglePart::kFace) return false;
  if (at.part <= TrianglePart::kEdge2) return twin[3 * at.triangle + edgeOfPart(at.part)] == kNone;
  const std::uint32_t v = mesh.topology().weld[mesh.triangles()[at.triangle].v[cornerOfPart(at.part)]];
  for (std::uint32_t i = adjacency.first[v]; i < adjacency.first[v + 1]; ++i) {
    const std::uint32_t out = adjacency.halfEdges[i];
    // A fan that is open ends with an edge that leaves the corner or with one that arrives at it.
    if (twin[out] == kNone || twin[3 * (out / 3) + (out % 3 + 2) % 3] == kNone) return true;
  }
  return false;
}

}  // namespace

SurfaceKind surfaceKind(const TriMesh& mesh) {
  if (mesh.meshClass() == MeshClass::kSolid) return SurfaceKind::kSolid;
  const ValidationReport& report = mesh.report();
  return report.inconsistentEdges == 0 && report.nonManifoldEdges == 0 ? SurfaceKind::kSheet : SurfaceKind::kShell;
}

Vec3d outwardNormal(const CollisionMesh& tree, const SurfacePoint& at) {
  const TriMesh& mesh = tree.mesh();
  const Adjacency& adjacency = tree.adjacency();
  const Vec3d& face = adjacency.normal[at.triangle];  // faceNormal() to the last bit
  if (at.part == TrianglePart::kFace) return face;
  if (at.part <= TrianglePart::kEdge2) {
    const std::uint32_t other = mesh.topology().twin[3 * at.triangle + edgeOfPart(at.part)];
    const Vec3d sum = other == kNone ? face : unit(face + adjacency.normal[other / 3]);
    return otgDot(sum, sum) > 0 ? sum : face;
  }
  const std::uint32_t v = mesh.topology().weld[mesh.triangles()[at.triangle].v[cornerOfPart(at.part)]];
  Vec3d sum{0, 0, 0};
  for (std::uint32_t i = adjacency.first[v]; i < adjacency.first[v + 1]; ++i) {
    const std::uint32_t half = adjacency.halfEdges[i], k = half % 3;
    Vec3d p[3];
    cornersOf(mesh, half / 3, p);
    const Vec3d a = unit(p[(k + 1) % 3] - p[k]), b = unit(p[(k + 2) % 3] - p[k]);
    const double angle = std::acos(std::clamp(otgDot(a, b), -1.0, 1.0));
    sum = sum + adjacency.normal[half / 3] * angle;
  }
  sum = unit(sum);
  return otgDot(sum, sum) > 0 ? sum : face;
}

bool isInside(const CollisionMesh& tree, const Vec3d& point, const SurfacePoint& nearest) {
  if (nearest.triangle == kNone) return false;
  const TriMesh& mesh = tree.mesh();
  switch (surfaceKind(mesh)) {
    case SurfaceKind::kSolid: {
      const Vec3f &low = mesh.boundsMin(), &high = mesh.boundsMax();
      const bool inBounds = point.x >= low.x && point.y >= low.y && point.z >= low.z && point.x <= high.x &&
                            point.y <= high.y && point.z <= high.z;
      return inBounds && pointInMesh(tree, point);
    }
    case SurfaceKind::kSheet:
      return !isOnRim(mesh, tree.adjacency(), nearest) &&
             otgDot(point - nearest.point, outwardNormal(tree, nearest)) < 0;
    case SurfaceKind::kShell:
      break;
  }
  return false;
}

}  // namespace otg
